// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"
#include "support/support.h"

#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

/// An arm that turns about z and bends, between two posts; four problems in one compact file.
struct Posts {
  Posts() {
    write_file(directory / "bender.urdf", R"(<robot name="bender">
  <link name="base"/>
  <link name="upper"><collision><origin xyz="0.25 0 0" rpy="0 1.5708 0"/>
    <geometry><capsule radius="0.03" length="0.4"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0.2 0 0" rpy="0 1.5708 0"/>
    <geometry><capsule radius="0.03" length="0.3"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <origin xyz="0 0 0.3"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/>
    <origin xyz="0.5 0 0"/><limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>
</robot>
)");
    std::string problems;
    for (int i = 0; i < 4; ++i) {
      const std::string q = std::to_string(0.02 * i);
      problems +=
          std::string(i == 0 ? "" : ",") + R"({"index":)" + std::to_string(i) + R"(,"start":[)" +
          q + R"(,0],"goal":[1.6,0.1],"obstacles":[)" +
          R"({"name":"left","type":"box","p":[0.8,0.15,0.3],"q":[1,0,0,0],"size":[0.1,0.1,0.6]},)" +
          R"({"name":"right","type":"box","p":[0.8,-0.15,0.3],"q":[1,0,0,0],"size":[0.1,0.1,0.6]}]})";
    }
    write_file(directory / "posts.json",
               R"({"robot":"bender","frame":"base","joints":["turn","bend"],"problems":[)" +
                   problems + "]}");
  }
  [[nodiscard]] std::vector<std::string> with_robot(std::vector<std::string> command) const {
    command.insert(command.end(), {"--robot", directory / "bender.urdf", "--json"});
    return command;
  }
  [[nodiscard]] ProgramRun learn(const std::string& part, const std::string& database) const {
    return run_program(with_robot({"learn", "--problems", directory / "posts.json", "--part", part,
                                   "--paths", "2", "--db", database}));
  }

  TemporaryDirectory directory;
};

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("half of the problems teach, the other half is planned from memory") {
    const Posts posts;
    const std::string database = posts.directory / "bender.db";
    const ProgramRun learned = posts.learn("1/2", database);
    REQUIRE_MESSAGE(learned.exit_code == 0, learned.err);
    const Json summary = Json::parse(learned.out);
    CHECK(summary["learned"] == 2);
    CHECK(summary["rows"] == 4);
    CHECK(summary["components"] > 0);

    const ProgramRun bench = run_program(
        posts.with_robot({"bench", "run", posts.directory / "posts.json", "--part", "2/2", "--db",
                          database, "--samplers", "gl", "--retrieve-after", "0", "--seeds", "2"}));
    REQUIRE_MESSAGE(bench.exit_code == 0, bench.err);
    CHECK(has_text(bench.out, "\"solved\": 4"));
  }

  TEST_CASE("what was learned before is skipped, another seed adds to it") {
    const Posts posts;
    const std::string database = posts.directory / "bender.db";
    REQUIRE(posts.learn("1/2", database).exit_code == 0);
    const Json again = Json::parse(posts.learn("1/1", database).out);
    CHECK(again["skipped"] == 2);
    CHECK(again["learned"] == 2);
    CHECK(again["samplers"] == 8);
  }

  TEST_CASE("problems without a path are counted and named") {
    const Posts posts;
    const ProgramRun run = run_program(
        posts.with_robot({"learn", "--problems", posts.directory / "posts.json#0", "--db",
                          posts.directory / "bender.db", "--path-timeout", "0"}));
    CHECK(run.exit_code == 0);
    CHECK(Json::parse(run.out)["unsolved"] == 1);
    CHECK(has_text(run.err, "0: not solved: no path within the time limit"));
  }

  TEST_CASE("wrong parts and patterns are refused") {
    const Posts posts;
    const std::string database = posts.directory / "bender.db";
    for (const char* part : {"0/2", "3/2", "1", "1/", "/2", "1/2x", "-1/2", "a/b"}) {
      INFO(part);
      const ProgramRun run = posts.learn(part, database);
      CHECK(run.exit_code == 1);
      CHECK(has_text(run.err, "expected I/N"));
    }
    check_bad_inputs({
        {{"learn", "--problems", posts.directory / "none.json", "--db", database},
         1,
         {"none.json"}},
        {{"learn", "--problems", posts.directory / "posts.json", "--primitives", "grid.yaml",
          "--db", database},
         2,
         {"--problems"}},
        {{"learn", "--primitives", "grid.yaml", "--db", database}, 2, {"--robot"}},
    });
  }
}

}  // namespace mneme::test
