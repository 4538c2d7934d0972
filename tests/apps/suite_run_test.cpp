// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"
#include "support/planar_memory.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

/// A suite of two settings: one with a memory of three primitives, one without memory.
std::string write_suite(const PlanarFiles& files, const std::string& more = "") {
  const std::string path = files / "small.yaml";
  write_file(path,
             "problems:\n  - {set: pair, file: problem.yaml}\nseeds: 3\ntimeout: 5\n"
             "memories:\n  few: {robot: planar8, primitives: " +
                 source_file("scenes/planar/grid.yaml") +
                 ", count: 3, starts-per-link: 1, paths-per-start: 1}\n"
                 "settings:\n  with: {memory: few, similarity: 1000, retrieve-after: 0}\n"
                 "  without: {planners: [prm, rrt], samplers: [uniform], max-iterations: 2000" +
                 more + "}\n");
  return path;
}

std::vector<BenchmarkRow> rows_of_suite(const std::string& path) {
  return require(parse_csv(read_file(path), path)).rows;
}

/// Names that tell runs apart.
std::set<std::string> names_of(const std::vector<BenchmarkRow>& rows) {
  std::set<std::string> names;
  for (const BenchmarkRow& row : rows) {
    names.insert(row.planner + row.sampler + row.setting + std::to_string(row.seed));
  }
  return names;
}

TEST_SUITE("flow") {
  TEST_CASE("A suite learns its memory, runs all settings and leaves rows, report and databases") {
    const PlanarFiles files;
    const std::string out = files / "out";
    const ProgramRun run =
        require_run({"bench", "run", write_suite(files), "--out", out, "--json", "--jobs", "2"});
    CHECK(Json::parse(run.out)["runs"] == 12);
    const auto rows = rows_of_suite(out + "/runs.csv");
    REQUIRE(rows.size() == 12);
    CHECK(names_of(rows).size() == 12);
    for (const BenchmarkRow& row : rows) {
      CHECK(row.set == "pair");
      CHECK(row.timeout_s == 5);
      CHECK_FALSE(row.machine.empty());
      const bool has_memory = row.setting == "with";
      CHECK(row.settings == (has_memory ? "similarity=1000 retrieve-after=0 replay=0 memory=few"
                                        : "max-iterations=2000"));
    }
    CHECK(std::ranges::any_of(rows, [](const BenchmarkRow& row) { return row.components > 0; }));
    const auto memories =
        require(parse_memory_csv(read_file(out + "/memories.csv"), "memories.csv"));
    REQUIRE(memories.size() == 1);
    CHECK(memories[0].primitives == 3);
    for (const char* name :
         {"report.html", "memories/few.db", "ompl/pair_two.log", "report_1_pair_solved.svg"}) {
      CAPTURE(name);
      CHECK(std::filesystem::file_size(out + "/" + name) > 0);
    }
  }

  TEST_CASE("One setting alone learns no memory of others; rows come in order with several jobs") {
    const PlanarFiles files;
    const std::string out = files / "out";
    require_run(
        {"bench", "run", write_suite(files), "--out", out, "--setting", "without", "--jobs", "3"});
    std::string order;
    for (const BenchmarkRow& row : rows_of_suite(out + "/runs.csv")) {
      order += row.planner + std::to_string(row.seed) + " ";
    }
    CHECK(order == "prm1 rrt1 rrt2 prm2 rrt3 prm3 ");
    CHECK_FALSE(std::filesystem::exists(out + "/memories/few.db"));
  }

  TEST_CASE("Planners of OMPL repeat themselves with several jobs, next to native ones") {
    const PlanarFiles files;
    write_file(files / "ompl.yaml",
               "problems: [problem.yaml]\nseeds: 4\ntimeout: 20\n"
               "settings: {a: {planners: [\"ompl:RRTConnect\", rrt_connect, \"ompl:RRT\"],\n"
               "               samplers: [uniform], max-iterations: 3000}}\n");
    const auto iterations = [&](const std::string& jobs) {
      require_run({"bench", "run", files / "ompl.yaml", "--out", files / jobs, "--jobs", jobs});
      std::set<std::string> names;
      for (const BenchmarkRow& row : rows_of_suite(files / jobs + "/runs.csv")) {
        names.insert(row.planner + std::to_string(row.seed) + " " + std::to_string(row.iterations));
      }
      return names;
    };
    const auto one = iterations("1");
    CHECK((one.size() == 12 || one.size() == 4));  // 4 without OMPL
    CHECK(iterations("3") == one);
  }

  TEST_CASE("Lightning and Thunder know the paths that their memory is learned from") {
    const PlanarFiles files;
    const std::string out = files / "out";
    const auto write = [&](const std::string& memory) {
      write_file(files / "old.yaml",
                 "problems: [problem.yaml]\nseeds: 1\ntimeout: 20\n"
                 "memories: {m: {" +
                     memory +
                     "}}\nsettings: {a: {memory: m, samplers: [uniform],\n"
                     "  planners: [\"ompl:Lightning\", \"ompl:Thunder\"]}}\n");
    };
    write("problems: [problem.yaml], paths: 2");
    const ProgramRun run = require_run({"bench", "run", files / "old.yaml", "--out", out});
    if (contains(run.err, "skipped: ompl:Lightning")) {
      MESSAGE("skipped: mneme was built without OMPL");
      return;
    }
    CHECK(contains(run.err, "experience of ompl:Lightning from the problems of memory m"));
    CHECK(std::filesystem::file_size(out + "/memories/m.Lightning") > 1000);
    CHECK(std::filesystem::file_size(out + "/memories/m.Thunder") > 1000);
    CHECK(rows_of_suite(out + "/runs.csv").size() == 2);
    write("robot: planar8, count: 1, starts-per-link: 1, paths-per-start: 1, primitives: " +
          source_file("scenes/planar/grid.yaml"));
    check_bad_inputs({{{"bench", "run", files / "old.yaml", "--out", files / "other"},
                       1,
                       {"setting a", "ompl:Lightning", "learned from problems"}}});
  }

  TEST_CASE("A memory is of the robot that the problems it learns from are given") {
    const PlanarFiles files;
    const auto thin = require(planar_arm_urdf("planar8", planar8_lengths(), 0.02));
    write_file(files / "thin.urdf", thin);
    write_file(files / "given.yaml",
               "problems: [{file: problem.yaml, robot: thin.urdf}]\nseeds: 1\nsamplers: [gl]\n"
               "memories: {m: {problems: [{file: " +
                   source_file("scenes/planar/threaded_b2.yaml") +
                   ", robot: thin.urdf}], paths: 1}}\n"
                   "settings: {a: {memory: m}}\n");
    require_run({"bench", "run", files / "given.yaml", "--out", files / "out"});
    const auto memory = require(Database::inspect(files / "out/memories/m.db"));
    CHECK(memory.signature().model_hash == load_robot(files / "thin.urdf")->hash());
  }

  TEST_CASE("A suite that was killed goes on where it was") {
    const PlanarFiles files;
    const std::string out = files / "out", csv = out + "/runs.csv";
    const std::string suite = write_suite(files);
    {
      RunningProgram program(
          {"bench", "run", suite, "--out", out, "--seeds", "100000", "--timeout", "1"});
      while (!std::filesystem::exists(csv) || read_file(csv).size() < 2 * csv_header().size()) {
      }
      program.send(SIGKILL);
      CHECK(program.wait().exit_code == 128 + SIGKILL);
    }
    const auto before = rows_of_suite(csv);
    REQUIRE_FALSE(before.empty());
    const std::uint64_t seeds = before.back().seed + 1;
    require_run({"bench", "run", suite, "--out", out, "--resume", "--seeds", std::to_string(seeds),
                 "--timeout", "1"});
    const auto after = rows_of_suite(csv);
    CHECK(after.size() == 4 * seeds);
    CHECK(names_of(after).size() == after.size());
    CHECK(to_csv(std::span(after).first(before.size())) == to_csv(before));
  }

  TEST_CASE("Runs of other settings are not mixed") {
    const PlanarFiles files;
    const std::string out = files / "out";
    REQUIRE(
        run_program({"bench", "run", write_suite(files), "--out", out, "--seeds", "1"}).exit_code ==
        0);
    check_bad_inputs({
        {{"bench", "run", write_suite(files), "--out", out, "--seeds", "1", "--resume", "--timeout",
          "6"},
         1,
         {"cannot resume", "5 s, not 6 s"}},
        {{"bench", "run", write_suite(files, ", range: 0.2"), "--out", out, "--seeds", "1",
          "--resume"},
         1,
         {"cannot resume", "range=0.2"}},
    });
  }
}

TEST_SUITE("unit") {
  TEST_CASE("Wrong suites and flags end with a message and an exit code") {
    const PlanarFiles files;
    const std::string suite = write_suite(files);
    write_file(files / "typo.yaml", "problems: [problem.yaml]\nplaners: [rrt]\n");
    write_file(files / "set.yaml",
               "problems: [problem.yaml]\nsettings: {a: {samplers: uniform, sets: [b]}}\n");
    write_file(files / "online.yaml",
               "problems: [problem.yaml]\nmemories: {m: {file: m.db}}\n"
               "settings: {a: {memory: m, learn-budget: 1}}\n");
    write_file(files / "missing.yaml",
               "problems: [problem.yaml]\nmemories: {m: {file: absent.db}}\n"
               "settings: {a: {memory: m, samplers: [gl]}}\n");
    check_bad_inputs({
        {{"bench", "run", files / "typo.yaml"}, 1, {"typo.yaml:2", "planers", "unknown key"}},
        {{"bench", "run", files / "set.yaml", "--out", files / "o"}, 1, {"no set 'b'"}},
        {{"bench", "run", files / "online.yaml", "--jobs", "2"}, 1, {"--jobs must be 1"}},
        {{"bench", "run", files / "missing.yaml", "--out", files / "o"},
         1,
         {"absent.db", "cannot be read"}},
        {{"bench", "run", suite, "--lambda", "0.1"},
         2,
         {"--lambda", "cannot be combined with a suite"}},
        {{"bench", "run", suite, "--csv", "a.csv"},
         2,
         {"--csv", "cannot be combined with a suite"}},
        {{"bench", "run", suite, "--setting", "wit"}, 1, {"small", "no setting 'wit'"}},
        {{"bench", "run", files.problem(), "--out", "a"}, 2, {"--out", "needs a suite"}},
        {{"bench", "run", files.problem(), "--setting", "a"}, 2, {"--setting", "needs a suite"}},
        {{"bench", "run", files.problem(), "--jobs", "2", "--learn-budget", "1"}, 2, {"--jobs"}},
    });
  }
}

}  // namespace
}  // namespace mneme::test
