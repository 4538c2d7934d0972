// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

namespace mneme::test {
namespace {

using Json = nlohmann::json;

TEST_SUITE("flow") {
  TEST_CASE("info tells whose experience a database holds and how much") {
    const PlanarFiles files;
    const Json json = run_json({"db", "info", files.database()});
    CHECK(json["samplers"] == 1);
    CHECK(json["components"] > 0);
    CHECK(json["robot_hash"] == planar8().hash());
    CHECK(json["kinematics_hash"] == planar8().kinematics_hash());
    CHECK(json["spaces"][0]["joint_count"] == 8);
    REQUIRE(json["kinds"].size() == 1);
    CHECK(json["kinds"][0]["kind"] == "pairs/1");
    CHECK(json["kinds"][0]["key_size"] == 6);
    CHECK(json["kinds"][0]["samplers"] == 1);
    CHECK(json["spaces"][0]["kinds"] == json["kinds"]);
    CHECK(json["bytes"] == std::filesystem::file_size(files.database()));
    CHECK(json["schema_version"] >= 1);
    const ProgramRun words = run_program({"db", "info", files.database()});
    CHECK(contains(words.out, planar8().hash()));
    CHECK(contains(words.out, "pairs/1, keys of 6 numbers, 1 row"));
  }

  TEST_CASE("info of an empty file says that nobody's experience is in it") {
    const TemporaryDirectory directory;
    write_file(directory / "new.db", "");
    const ProgramRun words = require_run({"db", "info", directory / "new.db"});
    CHECK(contains(words.out, "the database is empty"));
    CHECK_FALSE(contains(words.out, "older"));
    CHECK(run_json({"db", "info", directory / "new.db"})["schema_version"] == 0);
  }

  TEST_CASE("info tells how a robot differs, and what only its shapes change still applies") {
    const PlanarFiles files;
    const auto difference = [&](const std::string& robot) {
      return run_json({"db", "info", files.database(), "--robot", robot})["difference"];
    };
    std::string urdf = read_file(source_file("robots/planar8.urdf"));
    const auto write = [&](const std::string& name, const std::string& from,
                           const std::string& to) {
      std::string text = urdf;
      for (std::size_t at = text.find(from); at != std::string::npos;
           at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
      }
      REQUIRE(text != urdf);
      write_file(files / name, text);
      return files / name;
    };
    CHECK(difference("planar8") == "none");
    const std::string thick = write("thick.urdf", "radius=\"0.0005\"", "radius=\"0.0006\"");
    const std::string limited = write("limited.urdf", "upper=\"3.14", "upper=\"3.04");
    CHECK(difference(thick) == "shapes");
    CHECK(difference(limited) == "limits");
    CHECK(difference("ur5") == "frames");
    const auto plan = [&](const std::string& robot) {
      return run_program({"plan", files.problem(), "--robot", robot, "--db", files.database()});
    };
    const ProgramRun thicker = plan(thick);
    CHECK(thicker.exit_code == 0);
    CHECK(contains(thicker.err, "another collision model"));
    CHECK(plan(limited).exit_code == 5);
    CHECK(contains(plan(limited).err, "mneme db adopt"));
    CHECK(run_program({"db", "adopt", files.database(), "--robot", "ur5"}).exit_code == 5);
    CHECK(run_json({"db", "adopt", files.database(), "--robot", limited})["robot_name"] ==
          planar8().name());
    CHECK(plan(limited).exit_code != 5);
    CHECK(difference("planar8") == "limits");
  }

  TEST_CASE("list shows rows up to a limit") {
    const PlanarFiles files;
    const Json json = run_json({"db", "list", files.database()});
    REQUIRE(json["rows"].size() == 1);
    CHECK(json["rows"][0]["kind"] == "pairs/1");
    CHECK(json["rows"][0]["key"].size() == 6);
    CHECK(json["rows"][0]["components"] > 0);
    CHECK(json["rows"][0]["time"].get<std::string>().ends_with("Z"));
    CHECK(run_json({"db", "list", files.database(), "--limit", "0"})["rows"].empty());
    const ProgramRun words = run_program({"db", "list", files.database(), "--limit", "0"});
    CHECK(contains(words.out, "and 1 more"));
  }

  TEST_CASE("query finds the primitive that was learned, however it is turned or mirrored") {
    const PlanarFiles files;
    const auto& [a, b] = std::tie(kTwoCircles[0], kTwoCircles[1]);
    const auto key = [](double ax, double ay, double ar, double bx, double by, double br) {
      std::string text;
      for (const double value : {ax, ay, ar, bx, by, br}) {
        text += (text.empty() ? "" : ",") + std::to_string(value);
      }
      return text;
    };
    for (const std::string& turned :
         {key(a[0], a[1], a[2], b[0], b[1], b[2]), key(b[0], b[1], b[2], a[0], a[1], a[2]),
          key(-a[0], a[1], a[2], -b[0], b[1], b[2]), key(-a[1], a[0], a[2], -b[1], b[0], b[2])}) {
      const Json json = run_json({"db", "query", files.database(), "--key", turned});
      REQUIRE(json["primitives"].size() == 1);
      REQUIRE(json["primitives"][0]["matches"].size() == 1);
      CHECK(json["primitives"][0]["matches"][0]["similarity_error"] < 1e-9);
      CHECK(json["primitives"][0]["matches"][0]["id"] == 1);
    }
  }

  TEST_CASE("query looks up the primitives of a problem, under a threshold") {
    const PlanarFiles files;
    const Json json = run_json({"db", "query", files.database(), "--problem", files.problem()});
    REQUIRE(json["primitives"].size() == 1);
    CHECK(json["primitives"][0]["matches"].size() == 1);
    const Json far = run_json(
        {"db", "query", files.database(), "--key", "3,1.5,1,3,-1.5,1", "--similarity", "0.001"});
    CHECK(far["primitives"][0]["matches"].empty());
    const ProgramRun words =
        run_program({"db", "query", files.database(), "--problem", files.problem()});
    CHECK(contains(words.out, "id 1, similarity error 0.0000"));
  }

  TEST_CASE("query finds as many as planning does unless more are asked for") {
    const PlanarFiles files;
    {
      Database database =
          Database::open(files.database(), make_signature(planar8()), OpenMode::read_write).value();
      std::vector<Experience> rows(11, database.get(0).value());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].key[0] += 1e-3 * static_cast<double>(i + 1);
      }
      require(database.insert(std::move(rows)));
    }
    const auto matches = [&](const std::vector<std::string>& flags) {
      std::vector<std::string> arguments = {"db", "query", files.database(), "--problem",
                                            files.problem()};
      arguments.insert(arguments.end(), flags.begin(), flags.end());
      return run_json(arguments)["primitives"][0]["matches"].size();
    };
    CHECK(matches({}) == 8);
    CHECK(matches({"--max-matches", "3"}) == 3);
    CHECK(matches({"--max-matches", "1000000"}) == 12);
  }

  TEST_CASE("memory of whole paths is queried by problems, and has keys of its own") {
    const PlanarFiles files;
    const std::string memory = files / "paths.db";
    require_run({"learn", "--problems", files.problem(), "--kind", "paths", "--db", memory,
                 "--paths", "1"});
    const Json json = run_json({"db", "query", memory, "--problem", files.problem()});
    REQUIRE(json["primitives"].size() == 1);
    REQUIRE(json["primitives"][0]["matches"].size() == 1);
    CHECK(json["primitives"][0]["matches"][0]["similarity_error"] < 1e-9);
    const ProgramRun words = run_program({"db", "query", memory, "--problem", files.problem()});
    CHECK(contains(words.out, "query "));
    CHECK(contains(words.out, "id 1, similarity error 0.0000 rad^2"));
    CHECK_FALSE(contains(words.out, "gap"));
    CHECK_FALSE(contains(words.out, "turned"));
    const ProgramRun list = run_program({"db", "list", memory});
    CHECK_FALSE(contains(list.out, "(x y r"));
    CHECK(contains(run_program({"db", "list", files.database()}).out, "key (x y r x y r)"));
    const Json scene = run_json({"scene", "info", files.problem(), "--kind", "paths"});
    CHECK(scene["primitives"].size() == 1);
    CHECK(contains(run_program({"scene", "info", files.problem(), "--kind", "paths"}).out,
                   "  query to goal 1: key "));
    std::string start = read_file(files.problem());
    start.replace(start.find("start: [") + 8, 0, "1, ");
    write_file(files / "nine.yaml", start);
    check_bad_inputs({
        {{"db", "query", memory, "--key", "3,1,1.2,3,-1.5,1"},
         1,
         {"paths.db", "paths/1", "--key is two circles", "expected --problem"}},
        {{"db", "query", memory, "--problem", files / "nine.yaml"}, 1, {"start"}},
    });
  }

  TEST_CASE("a database of several kinds is queried for each of them") {
    const PlanarFiles files;
    require_run({"learn", "--problems", files.problem(), "--kind", "paths", "--db",
                 files.database(), "--paths", "1"});
    CHECK(run_json({"db", "info", files.database()})["kinds"].size() == 2);
    const Json json = run_json({"db", "query", files.database(), "--problem", files.problem()});
    REQUIRE(json["primitives"].size() == 2);
    CHECK(json["primitives"][0]["kind"] == "pairs/1");
    CHECK(json["primitives"][1]["kind"] == "paths/1");
    for (const Json& primitive : json["primitives"]) CHECK(primitive["matches"].size() == 1);
    CHECK(contains(run_program({"db", "list", files.database()}).out, "paths/1"));
  }

  TEST_CASE("query takes another robot than the problem's, and refuses one that does not fit") {
    const PlanarFiles files;
    const Json json = run_json(
        {"db", "query", files.database(), "--problem", files.problem(), "--robot", "planar8"});
    CHECK(json["primitives"][0]["matches"].size() == 1);
    CHECK(run_program({"db", "query", files.database(), "--problem", files.problem(), "--robot",
                       files / "none.urdf"})
              .exit_code == 1);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("wrong questions to a database end with a message and an exit code") {
    const PlanarFiles files;
    write_file(files / "text.db", std::string(5000, 'x'));
    const std::string database = files.database();
    check_bad_inputs({
        {{"db", "info"}, 2, {"URL is required"}},
        {{"db", "query", database}, 2, {"either --key or --problem"}},
        {{"db", "query", database, "--key", "1,2,3"}, 2, {"--key", "3 numbers"}},
        {{"db", "query", database, "--key", "1,2,3,4,5,z"}, 2, {"--key", "'z'"}},
        {{"db", "query", database, "--key", "1,2,3,4,nan,6"}, 2, {"--key", "nan"}},
        {{"db", "query", database, "--key", "1,2,-3,4,5,6"}, 2, {"--key", "-3 is no radius"}},
        {{"db", "query", database, "--key", "1,2,3,4,5,0"}, 2, {"--key", "0 is no radius"}},
        {{"db", "query", database, "--key", "1,2,1,4,5,1", "--similarity", "-1"},
         2,
         {"--similarity", "'-1'"}},
        {{"db", "list", database, "--limit", "-1"}, 2, {"--limit"}},
        {{"db", "info", files / "missing.db"}, 1, {"missing.db"}},
        {{"db", "info", files / "text.db", "--json"}, 5, {"mneme db verify"}},
        {{"db", "info", files / ""}, 1, {"directory"}},
        {{"db", "info", files / "text.db"}, 5, {"text.db"}},
        {{"db", "query", database, "--problem", files / "none.yaml"}, 1, {"none.yaml"}},
        {{"db", "query", database, "--problem", files.short_arm_problem()}, 5, {"short"}},
        {{"db", "info", "mysql://me:secret@host/x"}, 1, {"unknown scheme 'mysql'"}},
        {{"db", "info", "postgresql://127.0.0.1:1/x"}, 1, {"postgresql://127.0.0.1:1/x"}},
    });
    CHECK_FALSE(std::filesystem::exists(files / "missing.db"));
  }
}

}  // namespace
}  // namespace mneme::test
