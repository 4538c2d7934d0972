// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

/// A compact file of two problems: one that any planner solves, and one that starts in contact.
std::string write_problems(const PlanarFiles& files) {
  const std::string path = files / "pairs.json";
  const Json circles = kTwoCircles;
  const Json near = {{0.5, 0.0, 0.3}};
  const Json easy = {{"name", "easy"}, {"start", kStart}, {"goal", kStart}, {"circles", circles}};
  Json moved = easy;
  moved["goal"][7] = kStart[7] - 0.5;
  Json blocked = {
      {"name", "blocked"}, {"start", Configuration(8, 0.0)}, {"goal", kGoal}, {"circles", near}};
  write_file(path, Json{{"robot", "planar8"}, {"problems", {moved, blocked}}}.dump());
  return path;
}

std::vector<BenchmarkRow> rows_of(const std::string& path) {
  return require(parse_csv(read_file(path), path)).rows;
}

TEST_SUITE("flow") {
  TEST_CASE("a file of problems is run with planners, samplers and seeds") {
    const PlanarFiles files;
    const std::string csv = files / "runs.csv";
    const ProgramRun run =
        require_run({"bench", "run", write_problems(files), "--planners", "rrt_connect,prm",
                     "--samplers", "uniform,halton", "--seeds", "2", "--csv", csv, "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["runs"] == 16);
    CHECK(json["invalid"] == Json{"pairs#blocked"});
    REQUIRE(json["sets"].size() == 4);
    for (const Json& set : json["sets"]) {
      CHECK(set["set"] == "pairs");
      CHECK(set["solved"] == 2);
      CHECK(set["valid"] == 2);
      CHECK(set["total"] == 4);
      CHECK(set["invalid_paths"] == 0);
    }
    const auto rows = rows_of(csv);
    REQUIRE(rows.size() == 16);
    CHECK(rows[0].problem == "easy");
    CHECK(rows[0].planner == "rrt_connect");
    CHECK(rows[0].seed == 1);
    CHECK(rows[15].seed == 2);
    CHECK(rows[15].status == PlanStatus::invalid_start);
    CHECK(rows[0].planning_time_s <= rows[0].total_time_s);
  }

  TEST_CASE("a run that was cut short goes on where it was") {
    const PlanarFiles files;
    const std::string csv = files / "runs.csv";
    const std::vector<std::string> command = {"bench", "run", write_problems(files), "--seeds", "2",
                                              "--csv", csv};
    require_run(command);
    const std::string whole = read_file(csv);
    const std::size_t third = whole.find('\n', whole.find("\nblocked") + 1) + 1;
    write_file(csv, whole.substr(0, third + 7));
    std::vector<std::string> resumed = command;
    resumed.push_back("--resume");
    const ProgramRun run = require_run(resumed);
    CHECK(rows_of(csv).size() == 4);
    CHECK(read_file(csv).substr(0, third) == whole.substr(0, third));
    CHECK(contains(run.out, "1/1/2") == false);
    CHECK(contains(run.out, "2/2/4"));
    std::vector<std::string> other = resumed;
    other.insert(other.end(), {"--timeout", "3"});
    check_bad_inputs({{other, 1, {"cannot resume", "3 s"}}});
  }

  TEST_CASE("a directory stands for the problems below it") {
    const PlanarFiles files;
    write_problems(files);
    write_file(files / "scene.yaml", "circles: {a: [1, 2, 3]}\n");
    const ProgramRun run = require_run(
        {"bench", "run", files / "", "--max-iterations", "1", "--timeout", "1", "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["runs"] == 3);
    REQUIRE(json["sets"].size() == 3);
    CHECK(json["sets"][0]["set"] == "pairs");
    CHECK(json["sets"][2]["set"] == "all");
  }

  TEST_CASE("names of files cannot steer a terminal") {
    const PlanarFiles files;
    std::filesystem::rename(write_problems(files), files / "p\x1b[31mq.json");
    const ProgramRun run = require_run(
        {"bench", "run", files / "p\x1b[31mq.json", "--max-iterations", "1", "--timeout", "1"});
    CHECK(contains(run.out, "p\\x1b[31mq "));
    CHECK(contains(run.out, "p\\x1b[31mq#blocked"));
    CHECK_FALSE(contains(run.out + run.err, "\x1b"));
  }

  TEST_CASE("memory is drawn from where there is one") {
    const PlanarFiles files;
    const ProgramRun run =
        require_run({"bench", "run", files.problem(), "--db", files.database(), "--json"});
    const Json json = Json::parse(run.out);
    REQUIRE(json["sets"].size() == 2);
    CHECK(json["sets"][0]["sampler"] == "gl");
  }

  TEST_CASE("the parts of a run's time are no more than the whole, whenever memory is asked") {
    const PlanarFiles files;
    const std::string csv = files / "runs.csv";
    for (const char* after : {"0", "1"}) {
      CAPTURE(after);
      require_run({"bench", "run", files.problem(), "--db", files.database(), "--csv", csv,
                   "--seeds", "5", "--walk", "0", "--retrieve-after", after});
      for (const BenchmarkRow& row : rows_of(csv)) {
        CHECK((row.retrieval_time_s > 0) == (row.sampler == "gl"));
        CHECK(row.retrieval_time_s <= row.planning_time_s);
        CHECK(row.planning_time_s + row.simplification_time_s + row.verification_time_s <=
              row.total_time_s);
      }
    }
  }

  TEST_CASE("an interrupt leaves whole rows") {
    const PlanarFiles files;
    const std::string csv = files / "runs.csv";
    RunningProgram program({"bench", "run", files.problem(), "--seeds", "1000000", "--csv", csv,
                            "--range", "0.001", "--timeout", "100"});
    while (!std::filesystem::exists(csv) || read_file(csv).empty()) {
    }
    program.send(SIGINT);
    const ProgramRun run = program.wait();
    CHECK(run.exit_code == 130);
    CHECK(contains(run.err, "--resume"));
    CHECK(parse_csv(read_file(csv), csv).value().complete_bytes == read_file(csv).size());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("wrong benchmarks end with a message and an exit code") {
    const PlanarFiles files;
    std::filesystem::create_directory(files / "empty");
    write_file(files / "other.csv", "a,b\n1,2\n");
    check_bad_inputs({
        {{"bench", "run"}, 2, {"PROBLEMS is required"}},
        {{"bench", "run", files / "none.json"}, 1, {"none.json"}},
        {{"bench", "run", files / "none.yaml"}, 1, {"none.yaml"}},
        {{"bench", "run", files / "empty"}, 1, {"there are no problems in", "empty"}},
        {{"bench", "run", files.problem(), "--planners", "rrt,best"}, 2, {"--planners", "best"}},
        {{"bench", "run", files.problem(), "--samplers", "gl"}, 2, {"--samplers", "--db"}},
        {{"bench", "run", files.problem(), "--replay", "0.5"}, 2, {"--replay", "--db"}},
        {{"bench", "run", files.problem(), "--remember-after", "0"},
         2,
         {"--remember-after", "--db"}},
        {{"bench", "run", files.problem(), "--db", "x.db", "--samplers", "uniform", "--replay",
          "0.5"},
         2,
         {"--replay", "needs a sampler that uses the memory"}},
        {{"bench", "run", files.problem(), "--samplers", ","}, 2, {"--samplers"}},
        {{"bench", "run", files.problem(), "--samplers", "gaussian"},
         1,
         {"sample valid states", "ompl:PRM"}},
        {{"bench", "run", files.problem(), "--db-memory", "1"}, 2, {"--db-memory", "--db"}},
        {{"bench", "run", files.problem(), "--seeds", "0"}, 2, {"--seeds"}},
        {{"bench", "run", files.problem(), "--resume"}, 2, {"--csv"}},
        {{"bench", "run", files.problem(), "--resume", "--csv", files / "other.csv"},
         1,
         {"other.csv:1", "expected the columns"}},
        {{"bench", "run", files.problem(), "--csv", files / "no/runs.csv"}, 1, {"no/runs.csv"}},
        {{"bench", "run", files.problem(), "--robot", "nobody"}, 1, {"nobody"}},
    });
  }
}

}  // namespace
}  // namespace mneme::test
