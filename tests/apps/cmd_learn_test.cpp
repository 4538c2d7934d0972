// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"
#include "support/exported.h"
#include "support/posts.h"
#ifdef MNEME_HAS_POSTGRESQL
#include "engines/postgres_server.h"
#endif

#include <nlohmann/json.hpp>

#include <sys/stat.h>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kCoarseGrid =
    "radius: [1, 1.2]\ngap: [0.5, 0.7]\ndistance: [4, 4.5]\nmax_similarity_error: 3\ncount: 3\n";

/// `mneme learn` of a small grid with few paths.
std::vector<std::string> small_learn(const PlanarFiles& files, const std::string& database,
                                     const std::vector<std::string>& more = {}) {
  write_file(files / "grid.yaml", kCoarseGrid);
  std::vector<std::string> command = {"learn",
                                      "--robot",
                                      "planar8",
                                      "--primitives",
                                      files / "grid.yaml",
                                      "--db",
                                      database,
                                      "--starts-per-link",
                                      "1",
                                      "--paths-per-start",
                                      "1"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

void read_err_until(RunningProgram& program, const std::string& word) {
  std::string text;
  while (!contains(text, word)) {
    const std::string piece = program.read_err();
    REQUIRE_MESSAGE(!piece.empty(), text);
    text += piece;
  }
}

std::vector<std::string> listed_keys(const std::string& database) {
  const ProgramRun run = require_run({"db", "list", database, "--json"});
  std::vector<std::string> keys;
  const Json json = Json::parse(run.out);
  for (const Json& row : json["rows"]) {
    keys.push_back(row["key"].dump() + " " + row["components"].dump());
  }
  return keys;
}

std::vector<std::string> with_bender(const Posts& posts, std::vector<std::string> command) {
  command.insert(command.end(), {"--robot", posts.robot(), "--json"});
  return command;
}

ProgramRun learn_posts(const Posts& posts, const std::string& part, const std::string& database) {
  return run_program(with_bender(posts, {"learn", "--problems", posts.problems(), "--part", part,
                                         "--paths", "2", "--db", database}));
}

TEST_SUITE("flow") {
  TEST_CASE("a grid is learned into a database, and the summary tells its coverage") {
    const PlanarFiles files;
    const ProgramRun run = require_run(small_learn(files, files / "new.db", {"--json"}));
    const Json json = Json::parse(run.out);
    CHECK(json["learned"] >= 3);
    CHECK(json["skipped"] == 0);
    CHECK(json["samplers"] == json["learned"]);
    CHECK(json["coverage"]["threshold"] == 3.0);
    CHECK(json["coverage"]["max"] < 3.0);
    CHECK(json["is_cancelled"] == false);
  }

  TEST_CASE("what many scenes warn of is said once") {
    const PlanarFiles files;
    const std::string scene = files / "far.yaml", other = files / "other.yaml";
    write_file(scene,
               "robot: planar8\nscene: {circles: [[700, 0, 1]]}\nstart: [0, 0, 0, 0, 0, 0, 0, 0]\n"
               "goal: [1, 0, 0, 0, 0, 0, 0, 0]\n");
    write_file(other, read_file(scene));
    for (const std::string from : {"--scenes", "--problems"}) {
      const std::string err = run_program({"learn", "--robot", "planar8", from, scene, from, other,
                                           "--db", files / "far.db"})
                                  .err;
      const std::size_t first = err.find("is 699 m away");
      CHECK_MESSAGE(first != std::string::npos, err);
      CHECK_MESSAGE(err.find("is 699 m away", first + 1) == std::string::npos, err);
    }
  }

  TEST_CASE("learning the same again adds nothing, and another seed adds") {
    const PlanarFiles files;
    const std::string database = files / "new.db";
    require_run(small_learn(files, database));
    const std::vector<std::string> before = listed_keys(database);
    const ProgramRun again = require_run(small_learn(files, database, {"--json"}));
    CHECK(Json::parse(again.out)["learned"] == 0);
    CHECK(listed_keys(database) == before);

    require_run(small_learn(files, database, {"--seed", "2"}));
    const std::vector<std::string> both = listed_keys(database);
    CHECK(both.size() > before.size());
    require_run(small_learn(files, database));
    CHECK(listed_keys(database) == both);
  }

  TEST_CASE("the number of threads does not change what is learned") {
    const PlanarFiles files;
    require_run(small_learn(files, files / "one.db", {"--jobs", "1"}));
    require_run(small_learn(files, files / "two.db", {"--jobs", "3"}));
    CHECK(listed_keys(files / "one.db") == listed_keys(files / "two.db"));
  }

  TEST_CASE("shards that are merged are what one process learns, however many there are") {
    const PlanarFiles files;
    const std::vector<std::string> grid = {"--count", "11"};
    require_run(small_learn(files, files / "whole.db", grid));
    const std::string whole = exported(files / "whole.db");
    for (const auto& shards :
         {std::vector<std::string>{"1/2", "2/2"}, std::vector<std::string>{"2/3", "0/3", "1/3"}}) {
      const std::string merged = files / ("merged" + shards[0].substr(2));
      std::size_t learned = 0;
      for (std::size_t i = 0; i < shards.size(); ++i) {
        const std::string part = merged + "_" + std::to_string(i);
        const ProgramRun run = require_run(
            small_learn(files, part, {"--count", "11", "--shard", shards[i], "--json"}));
        const Json json = Json::parse(run.out);
        CHECK(json["learned"] >= 11 / shards.size());
        CHECK(json["coverage"].is_null());
        learned += json["learned"].get<std::size_t>();
        require_run({"db", "merge", merged, part});
      }
      CHECK(learned == listed_keys(files / "whole.db").size());
      CHECK(exported(merged) == whole);
    }
  }

#ifdef MNEME_HAS_POSTGRESQL
  TEST_CASE("workers with the same command line learn between them what one process does") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const PlanarFiles files;
    const std::string url = server->new_url();
    require_run(small_learn(files, files / "whole.db"));
    const auto command = small_learn(files, url, {"--worker", "--lease", "5", "--json"});
    RunningProgram first(command);
    RunningProgram second(command);
    std::int64_t learned = 0;
    for (RunningProgram* program : {&first, &second}) {
      const ProgramRun run = program->wait();
      REQUIRE_MESSAGE(run.exit_code == 0, run.err);
      const Json json = Json::parse(run.out);
      CHECK(json["coverage"]["max"] < 3.0);
      learned += json["learned"].get<std::int64_t>();
      CHECK(json["learned"].get<std::int64_t>() + json["skipped"].get<std::int64_t>() ==
            json["samplers"].get<std::int64_t>());
    }
    CHECK(exported(url) == exported(files / "whole.db"));
    CHECK(static_cast<std::size_t>(learned) == listed_keys(url).size());
  }
#endif

  TEST_CASE("the primitives of scenes are learned once each") {
    const PlanarFiles files;
    std::filesystem::copy_file(files.problem(), files / "problem2.yaml");
    const ProgramRun run =
        require_run({"learn", "--robot", "planar8", "--scenes", files / "problem*.yaml", "--db",
                     files / "new.db", "--starts-per-link", "1", "--json"});
    CHECK(Json::parse(run.out)["learned"] == 1);
    CHECK(Json::parse(run.out)["coverage"].is_null());
  }

  TEST_CASE("scenes without primitives are learned from with a note") {
    const PlanarFiles files;
    write_file(files / "far.yaml", "circles: {a: [-5, 0, 1], b: [5, 0, 1]}\n");
    const ProgramRun run = require_run(
        {"learn", "--robot", "planar8", "--scenes", files / "far.yaml", "--db", files / "new.db"});
    CHECK(contains(run.err, "no primitives"));
    CHECK(contains(run.err, "--max-gap"));
  }

  TEST_CASE("an interrupt leaves a sound database, and the same command goes on") {
    const PlanarFiles files;
    const std::string database = files / "new.db";
    const auto command = small_learn(files, database, {"--count", "1000"});
    RunningProgram program(command);
    read_err_until(program, "learning");
    program.send(SIGINT);
    const ProgramRun run = program.wait();
    CHECK_MESSAGE(run.exit_code == 130, run.err);
    CHECK(contains(run.err, "continue with the same command"));
    // Without a row there is no file.
    const bool has_rows = std::filesystem::exists(database);
    CHECK((!has_rows || run_program({"db", "verify", database}).exit_code == 0));
    require_run(small_learn(files, database));
  }

  TEST_CASE("an interrupt while primitives are chosen ends the command with nothing learned") {
    const PlanarFiles files;
    for (const bool is_json : {true, false}) {
      auto command = small_learn(files, files / "new.db", {"--count", "1000000"});
      if (is_json) command.push_back("--json");
      RunningProgram program(command);
      read_err_until(program, "choosing");
      program.send(SIGINT);
      const ProgramRun run = program.wait();
      CHECK_MESSAGE(run.exit_code == 130, run.err);
      CHECK(!contains(run.err, "learning 1000"));
      CHECK(contains(run.err, "continue with the same command"));
      if (is_json) {
        const Json json = Json::parse(run.out);
        CHECK(json["learned"] == 0);
        CHECK(json["is_cancelled"] == true);
        CHECK(json["coverage"]["max"].is_null());
      } else {
        CHECK(contains(run.out, "coverage: none, because the database is empty"));
      }
    }
  }

  TEST_CASE("half of the problems teach, the other half is planned from memory") {
    const Posts posts;
    const std::string database = posts.directory / "bender.db";
    const ProgramRun learned = learn_posts(posts, "1/2", database);
    REQUIRE_MESSAGE(learned.exit_code == 0, learned.err);
    const Json summary = Json::parse(learned.out);
    CHECK(summary["learned"] == 2);
    CHECK(summary["rows"] == 4);
    CHECK(summary["components"] > 0);

    const ProgramRun bench = require_run(
        with_bender(posts, {"bench", "run", posts.problems(), "--part", "2/2", "--db", database,
                            "--samplers", "gl", "--retrieve-after", "0", "--seeds", "2"}));
    CHECK(contains(bench.out, "\"solved\": 4"));
  }

  TEST_CASE("problems without a path are counted and named") {
    const Posts posts;
    const ProgramRun run = require_run(
        with_bender(posts, {"learn", "--problems", posts.directory / "posts.json#0", "--db",
                            posts.directory / "bender.db", "--path-timeout", "0"}));
    CHECK(Json::parse(run.out)["unsolved"] == 1);
    CHECK(contains(run.err, "0: not solved: no path within the time limit"));
  }

  TEST_CASE("wrong parts and patterns are refused") {
    const Posts posts;
    const std::string database = posts.directory / "bender.db";
    for (const char* part : {"0/2", "3/2", "1", "1/", "/2", "1/2x", "-1/2", "a/b"}) {
      INFO(part);
      const ProgramRun run = learn_posts(posts, part, database);
      CHECK(run.exit_code == 2);
      CHECK(contains(run.err, "--part: '" + std::string(part) + "' is no part; expected I/N"));
    }
    check_bad_inputs({
        {{"learn", "--problems", posts.directory / "none.json", "--db", database},
         1,
         {"none.json"}},
        {{"learn", "--problems", posts.problems(), "--primitives", "grid.yaml", "--db", database},
         2,
         {"--problems"}},
        {{"learn", "--primitives", "grid.yaml", "--db", database}, 2, {"--robot"}},
    });
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a wrong command line of learn is a usage error") {
    check_bad_inputs({
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml"}, 2, {"--db is required"}},
        {{"learn", "--robot", "planar8", "--db", "x.db"}, 2, {"--primitives or --scenes"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--jobs", "0"},
         2,
         {"--jobs", "'0'"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--kind",
          "paths"},
         2,
         {"--kind", "'pairs'"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--count", "a"},
         2,
         {"--count", "'a'"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--shard",
          "5/4"},
         2,
         {"--shard", "'5/4'", "0 <= I <= N"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--shard",
          "0/0"},
         2,
         {"--shard", "'0/0'"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--shard", "1"},
         2,
         {"--shard", "'1'"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db", "--worker"},
         2,
         {"--worker", "postgresql://"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "postgresql://h/x",
          "--worker", "--shard", "1/2"},
         2,
         {"--worker", "--shard"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "postgresql://h/x",
          "--worker", "--lease", "0"},
         2,
         {"--lease", "'0'"}},
        {{"learn", "--problems", "x", "--db", "postgresql://h/x", "--worker"},
         2,
         {"--worker", "--problems"}},
        {{"learn", "--problems", "x", "--db", "x.db", "--shard", "1/2"},
         2,
         {"--shard", "--problems", "--part"}},
        {{"learn", "--robot", "planar8", "--primitives", "g.yaml", "--db", "x.db",
          "--similarity-error", "0"},
         2,
         {"--similarity-error"}},
    });
  }

  TEST_CASE("flags of another source of lessons are refused, and not ignored") {
    const std::vector<std::string> primitives = {"learn",  "--robot", "planar8", "--primitives",
                                                 "g.yaml", "--db",    "x.db"};
    const std::vector<std::string> scenes = {"learn",  "--robot", "planar8", "--scenes",
                                             "s.yaml", "--db",    "x.db"};
    const std::vector<std::string> problems = {"learn", "--problems", "x", "--db", "x.db"};
    struct Misplaced {
      const std::vector<std::string>& command;
      std::string flag, value, source;
    };
    for (const auto& [command, flag, value, source] : std::vector<Misplaced>{
             {primitives, "--part", "1/2", "--problems"},
             {scenes, "--part", "1/2", "--problems"},
             {scenes, "--paths", "2", "--problems"},
             {scenes, "--path-timeout", "2", "--problems"},
             {scenes, "--count", "3", "--primitives"},
             {scenes, "--lease", "3", "--worker"},
             {problems, "--count", "3", "--primitives"},
             {problems, "--similarity-error", "2", "--primitives"},
             {problems, "--starts-per-link", "2", "--problems"},
         }) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), {flag, value});
      check_bad_inputs({{arguments, 2, {flag, source}}});
    }
  }

  TEST_CASE("files that learn cannot use are failures that name the file") {
    const PlanarFiles files;
    write_file(files / "broken_grid.yaml", "radius: [2, 1\n");
    write_file(files / "reversed_grid.yaml", "radius: [2, 1]\n");
    write_file(files / "good.yaml", kCoarseGrid);
    const auto learn = [](const std::string& grid, const std::string& database) {
      return std::vector<std::string>{"learn", "--robot", "planar8", "--primitives",
                                      grid,    "--db",    database};
    };
    const std::string database = files / "new.db";
    check_bad_inputs({
        {learn(files / "missing.yaml", database), 1, {"missing.yaml"}},
        {learn(files / "broken_grid.yaml", database), 1, {"broken_grid.yaml"}},
        {learn(files / "reversed_grid.yaml", database), 1, {"reversed_grid.yaml", "radius"}},
        {{"learn", "--robot", "panda", "--primitives", files / "good.yaml", "--db", database},
         1,
         {"--primitives is for planar arms"}},
        {learn(files / "good.yaml", files / "no/directory/new.db"), 1, {"no/directory/new.db"}},
        {{"learn", "--robot", "nobody", "--scenes", files.problem(), "--db", database},
         1,
         {"nobody"}},
        {{"learn", "--robot", "planar8", "--scenes", files / "none*.yaml", "--db", database},
         1,
         {"none*.yaml"}},
        {{"learn", "--robot", "planar8", "--scenes", files / "broken_grid.yaml", "--db", database},
         1,
         {"broken_grid.yaml"}},
    });
    CHECK_FALSE(std::filesystem::exists(database));
  }

  TEST_CASE("a database of another robot is not added to") {
    const PlanarFiles files;
    const std::string database = files.database();
    const std::string before = read_file(database);
    static_cast<void>(files.short_arm_problem());
    auto command = small_learn(files, database);
    command[2] = files / "short.urdf";
    check_bad_inputs({{command, 5, {"short", "planar8"}}});
    CHECK(read_file(database) == before);
  }

  TEST_CASE("a database that may only be read is not added to, but plans") {
    const PlanarFiles files;
    const std::string database = files.database();
    chmod((files / "").c_str(), 0555);
    chmod(database.c_str(), 0444);
    const ProcessChanges powerless{{}, true};
    auto command = small_learn(files, database);
    const ProgramRun learned = run_program(command, powerless);
    const ProgramRun planned = run_program({"plan", files.problem(), "--db", database}, powerless);
    chmod((files / "").c_str(), 0755);
    CHECK_MESSAGE(learned.exit_code == 1, learned.err);
    CHECK(contains(learned.err, database));
    CHECK_MESSAGE(planned.exit_code == 0, planned.err);
  }
}

}  // namespace
}  // namespace mneme::test
