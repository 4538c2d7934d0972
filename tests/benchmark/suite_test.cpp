// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/baselines.h"
#include "mneme/benchmark.h"

#include "benchmark/suite_memories.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using test::require;
using test::require_error;

// The files of problems that script/hard, script/repeats, script/enclosed, script/blocked and
// script/growth make.
std::vector<std::string> made_by_scripts() {
  std::vector<std::string> names = {
      "wide.json",   "middle.json",  "narrow.json", "two.json", "three.json", "two_narrow.json",
      "starts.json", "carried.json", "reach",       "starts",   "base",       "meshes",
      "clouds",      "new",          "solids",      "segments"};
  for (const std::string robot : {"panda", "fetch", "ur5"}) {
    for (const char* cell : {"static", "moved", "new", "narrow", "random", "wide", "tight"}) {
      names.push_back(robot + "_" + cell + ".json");
    }
    for (const char* kind : {".json", "_lessons.json", "_foreign.json"}) {
      names.push_back(robot + kind);
    }
  }
  return names;
}

TEST_SUITE("unit") {
  TEST_CASE("Settings are told by what differs from the defaults, in order of declaration") {
    SolveSettings settings;
    CHECK(describe_settings(settings).empty());
    settings.plan.range = 3.55;
    settings.similarity = 3;
    settings.drop_invalid_means = false;
    settings.learn.merge_cliques = true;
    CHECK(describe_settings(settings) ==
          "similarity=3 drop-invalid-means=false range=3.55 merge-cliques=true");
  }

  TEST_CASE("Time limit and seed are no part of the description: they have columns") {
    SolveSettings settings;
    settings.plan.timeout_s = 3;
    settings.plan.seed = 9;
    CHECK(describe_settings(settings).empty());
  }
}

constexpr const char* kHead = "problems: [a.yaml]\nmemories:\n  m: {file: m.db}\n";

Result<Suite> read(const std::string& text) {
  const test::TemporaryDirectory directory;
  test::write_file(directory / "small.yaml", text);
  return load_suite(directory / "small.yaml");
}

std::string failure(const std::string& text) {
  const auto suite = read(text);
  return suite ? "" : suite.error().message.substr(suite.error().message.find("small.yaml"));
}

TEST_SUITE("unit") {
  TEST_CASE("A suite is problems, memories and settings; paths are relative to its file") {
    const auto suite = require(read(R"(
problems:
  - one.yaml
  - {file: more/many.json, set: many, part: 2/2}
planners: [rrt_connect, prm]
samplers: [gl, uniform]
seeds: 5
first-seed: 11
timeout: 4
memories:
  grid: {robot: planar8, primitives: grid.yaml, count: 25, merge-cliques: true, seed: 3}
  seen: {problems: [{file: more/many.json, part: 1/2}], paths: 2, path-timeout: 1.5}
settings:
  tuned: {memory: grid}
  paper: {memory: seen, similarity: 3, max-matches: 1000000, drop-invalid-means: false, timeout: 20,
          planners: rrt_connect, samplers: [gl], sets: [many]}
)"));
    CHECK(suite.name == "small");
    CHECK(suite.seed_count == 5);
    CHECK(suite.first_seed == 11);
    REQUIRE(suite.problems.size() == 2);
    CHECK(suite.problems[0].where.ends_with("/one.yaml"));
    CHECK(suite.problems[1].where.ends_with("/more/many.json"));
    CHECK(suite.problems[1].set == "many");
    CHECK(suite.problems[1].part == "2/2");
    REQUIRE(suite.memories.size() == 2);
    CHECK(suite.memories[0].count == 25);
    CHECK(suite.memories[0].learn.merge_cliques);
    CHECK(suite.memories[0].seed == 3);
    CHECK(suite.memories[1].paths == 2);
    CHECK(suite.memories[1].path_timeout_s == 1.5);
    REQUIRE(suite.settings.size() == 2);
    CHECK(suite.settings[0].solve.plan.timeout_s == 4);
    CHECK(suite.settings[0].planners.size() == 2);
    CHECK(suite.settings[1].solve.plan.timeout_s == 20);
    CHECK(suite.settings[1].solve.similarity == 3);
    CHECK(suite.settings[1].solve.max_matches == 1000000);
    CHECK(suite.settings[1].solve.drop_invalid_means == false);
    CHECK(suite.settings[1].planners == std::vector<std::string>{"rrt_connect"});
    CHECK(suite.settings[1].sets == std::vector<std::string>{"many"});
  }

  TEST_CASE("Without settings there is one, with the defaults and without a name") {
    const auto suite = require(read("problems: [a.yaml]\nsamplers: [uniform]\n"));
    REQUIRE(suite.settings.size() == 1);
    CHECK(suite.settings[0].name.empty());
    CHECK(suite.settings[0].planners == std::vector<std::string>{"rrt_connect"});
  }

  TEST_CASE("Unknown keys and names are refused with their line") {
    CHECK(failure("problems: [a.yaml]\nplaners: [prm]\n")
              .find("small.yaml:2: key planers: unknown key, expected one of problems, planners") ==
          0);
    CHECK(failure("problems: [a.yaml]\nplanners: [best]\n")
              .find("small.yaml:2: key planners: unknown planner 'best': expected one of "
                    "rrt_connect") == 0);
    CHECK(contains(failure("problems: [a.yaml]\nsamplers: [halt]\n"), "unknown sampler 'halt'"));
    CHECK(failure(std::string(kHead) + "settings:\n  s: {memory: m, sigmoid: 1}\n")
              .find("small.yaml:5: key settings.s.sigmoid: unknown key") == 0);
    CHECK(contains(failure(std::string(kHead) + "settings:\n  s: {memory: m, seed: 1}\n"),
                   "unknown key"));
    CHECK(contains(failure("problems: [{file: a.yaml, sett: b}]\n"), "sett: unknown key"));
  }

  TEST_CASE("A suite may name every setting but the seed, each once") {
    const std::string message = failure(std::string(kHead) + "settings:\n  s: {sigmoid: 1}\n");
    const std::string begin = "expected one of ";
    REQUIRE(contains(message, begin));
    std::istringstream list(message.substr(message.find(begin) + begin.size()));
    std::vector<std::string> names;
    for (std::string name; std::getline(list >> std::ws, name, ',');) names.push_back(name);
    for (const char* name : {"sigma", "range", "max-gap", "merge-cliques", "timeout"}) {
      CAPTURE(name);
      CHECK(std::ranges::count(names, name) == 1);
    }
    CHECK(std::ranges::count(names, "seed") == 0);
    std::ranges::sort(names);
    CHECK(std::ranges::adjacent_find(names) == names.end());
  }

  TEST_CASE("Values of a wrong kind or out of range are refused with their line") {
    const auto setting = [](const std::string& text) {
      return failure(std::string(kHead) + "settings:\n  s: {memory: m, " + text + "}\n");
    };
    CHECK(
        setting("goal-bias: 2")
            .find("small.yaml:5: key settings.s.goal-bias: expected a number from 0 to 1, got 2") ==
        0);
    CHECK(contains(setting("goal-bias: .nan"), "expected a number from 0 to 1"));
    CHECK(contains(setting("neighbours: 1.5"), "expected a whole number from 1"));
    CHECK(contains(setting("verify: 1"), "expected true or false"));
    CHECK(contains(setting("timeout: -1"), "expected a number from 0"));
    CHECK(contains(failure("problems: [a.yaml]\nseeds: 0\n"), "expected a whole number from 1"));
    CHECK(contains(failure("problems: []\n"), "expected at least one file"));
    CHECK(contains(failure("planners: [prm]\n"), "expected the key problems"));
    CHECK(failure("problems: [a.yaml]\nproblems: [b.yaml]\n").find("small.yaml:2") == 0);
  }

  TEST_CASE("Names of memories are names of files in their directory") {
    for (const char* name : {"../../escaped", "/tmp/m", "a/b", "..", ".", ""}) {
      CAPTURE(name);
      const std::string text =
          failure(std::string("problems: [a.yaml]\nmemories:\n  \"") + name + "\": {file: m.db}\n");
      CHECK(text.find("small.yaml:3: key memories.") == 0);
      CHECK(contains(text, "expected a name that a file can have"));
    }
  }

  TEST_CASE("The sampler gl needs a memory that the suite declares") {
    CHECK(contains(failure("problems: [a.yaml]\n"), "the sampler gl needs the key memory"));
    CHECK(failure(std::string(kHead) + "settings:\n  s: {memory: n}\n")
              .find("small.yaml:5: key settings.s: key memory: there is no memory \"n\"") == 0);
    CHECK(contains(failure("problems: [a.yaml]\nmemories: {m: {count: 3}}\n"),
                   "expected one of the keys file, primitives and problems"));
  }

  TEST_CASE("Environment variables stand for parts of paths, and must be set") {
    setenv("MNEME_SUITE_TEST", "/there", 1);
    const auto suite =
        require(read("problems: ['${MNEME_SUITE_TEST}/a.yaml']\nsamplers: [uniform]\n"));
    CHECK(suite.problems[0].where == "/there/a.yaml");
    setenv("MNEME_SUITE_PART", "2/3", 1);
    const auto both =
        require(read("problems: [{file: '${MNEME_SUITE_TEST}/${MNEME_SUITE_TEST}.yaml', part: "
                     "'${MNEME_SUITE_PART}'}]\nsamplers: [uniform]\n"));
    CHECK(both.problems[0].where == "/there/there.yaml");
    CHECK(both.problems[0].part == "2/3");
    unsetenv("MNEME_SUITE_PART");
    unsetenv("MNEME_SUITE_TEST");
    CHECK(contains(failure("problems: ['${MNEME_SUITE_TEST}/a.yaml']\n"),
                   "the environment variable MNEME_SUITE_TEST is not set"));
  }

  TEST_CASE("The suites that come with mneme are sound, and their files are there") {
    // Planners of OMPL are accepted in builds without it.
    const std::set<std::string> foreign = {"ompl:RRT",       "ompl:RRTConnect", "ompl:PRM",
                                           "ompl:BKPIECE1",  "ompl:KPIECE1",    "ompl:BiEST",
                                           "ompl:STRIDE",    "ompl:SBL",        "ompl:BITstar",
                                           "ompl:Lightning", "ompl:Thunder"};
    add_baseline_samplers();
    const test::TemporaryDirectory made;
    for (const std::string& name : made_by_scripts()) test::write_file(made / name, "");
    for (const char* directory : {"GROWTH", "ENCLOSED", "BLOCKED", "REPEATS", "HARD", "TRANSFER",
                                  "ABLATIONS", "PROBLEMS", "WORLDS", "COMPOSED"}) {
      setenv(directory, (made / ".").c_str(), 1);
    }
    for (const char* memory : {"MEMORY", "SHELVES"}) setenv(memory, "memory.db", 1);
    setenv("ROBOT", "panda", 1);
    setenv("MODEL", "panda", 1);
    setenv("PART", "1/2", 1);
    setenv("THREADED", test::source_file("README.md").c_str(), 1);
    int count = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(test::source_file("bench/suites"))) {
      const bool needs_data = contains(test::read_file(entry.path().string()), "MNEME_DATA");
      if (needs_data && std::getenv("MNEME_DATA") == nullptr) {
        MESSAGE("skipped ", entry.path().filename().string(), ": MNEME_DATA is not set");
        continue;
      }
      const auto suite = require(load_suite(entry.path().string()));
      for (const SuiteProblems& problems : suite.problems) {
        CHECK_MESSAGE(std::filesystem::exists(problems.where), problems.where);
      }
      for (const SuiteSetting& setting : suite.settings) {
        for (const std::string& planner : setting.planners) {
          if (planner.starts_with("ompl:")) CHECK_MESSAGE(foreign.contains(planner), planner);
        }
      }
      for (const SuiteMemory& memory : suite.memories) {
        for (const SuiteProblems& lesson : memory.problems) {
          CHECK_MESSAGE(std::filesystem::exists(lesson.where), lesson.where);
        }
        if (!memory.primitives.empty()) CHECK(std::filesystem::exists(memory.primitives));
      }
      ++count;
    }
    CHECK(count >= 6);
  }

  TEST_CASE("Planners that are not built in may be named, and are left out with a note") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "small.yaml",
                     "problems: [" + test::source_file("scenes/planar/scenario1.yaml") +
                         "]\nplanners: [\"ompl:RRT\", prm]\nsamplers: [uniform]\n");
    const auto suite = require(load_suite(directory / "small.yaml"));
    std::vector<std::string> notes;
    SuiteHooks hooks;
    hooks.on_note = [&](const std::string& note) { notes.push_back(note); };
    const auto ready =
        require(internal::prepare_suite(suite, directory / "memories", {}, 1, hooks));
    REQUIRE(ready.plan.cases.size() == 1);
    CHECK(ready.plan.cases[0].settings.planner == "prm");
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].starts_with("skipped: ompl:RRT"));
  }

  TEST_CASE("Rivals take the place of planners, and their rows have their names") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "m.db", "");
    test::write_file(directory / "small.yaml",
                     "problems: [" + test::source_file("scenes/planar/scenario1.yaml") +
                         "]\nplanners: [cache, ert_connect]\nsamplers: [gl]\ntimeout: 0.2\n"
                         "memories: {m: {file: m.db}}\nsettings: {s: {memory: m, replay: 0.5}}\n");
    const auto suite = require(load_suite(directory / "small.yaml"));
    auto ready = require(internal::prepare_suite(suite, directory / "memories", {}, 1, {}));
    std::vector<std::string> names;
    ready.plan.seed_count = 1;
    require(run_bench(ready.plan, {}, [&](const BenchmarkRow& row, const SolveResult&) {
      names.push_back(row.planner + " " + row.sampler);
      return Result<void>();
    }));
    CHECK(names == std::vector<std::string>{"cache gl", "ert_connect gl"});
  }

  TEST_CASE("A memory that grows while its suite runs may begin as an empty file") {
    const test::TemporaryDirectory directory;
    const std::string problem = test::source_file("scenes/planar/scenario1.yaml");
    test::write_file(directory / "m.db", "");
    test::write_file(directory / "small.yaml",
                     "problems: [" + problem + "]\nmemories:\n  m: {file: " + (directory / "m.db") +
                         "}\nsettings:\n  grows: {memory: m, remember-after: 0}\n");
    const auto suite = require(load_suite(directory / "small.yaml"));
    auto ready = require(internal::prepare_suite(suite, directory / "memories", {}, 1, {}));
    REQUIRE(ready.plan.memories.size() == 1);
    const Problem& scenario = ready.plan.problems.at(0).problem;
    SolveSettings settings = ready.plan.cases.at(0).settings;
    settings.memory.kind = "paths";
    const auto solved =
        require(solve(scenario, ready.plan.memories.begin()->second.get(), settings));
    CHECK(solved.remembered.is_queued);
  }

  TEST_CASE("A memory that is learned from problems may name its kind") {
    const std::string head = "problems: [a.yaml]\nmemories:\n  m: {problems: [b.yaml], ";
    const auto suite = require(read(head + "kind: paths}\nsettings:\n  s: {memory: m}\n"));
    CHECK(suite.memories.at(0).kind == "paths");
    CHECK(failure(head + "kind: nope}\n").find("small.yaml:3: key memories.m.kind: ") == 0);
    CHECK(contains(failure(head + "decomposer: pairs}\n"), "unknown key"));
  }

  TEST_CASE("A device is no suite, and is not read") {
    const test::TemporaryDirectory directory;
    std::filesystem::create_symlink("/dev/zero", directory / "zero.yaml");
    CHECK_FALSE(is_suite_file(directory / "zero.yaml"));
  }

  TEST_CASE("A suite that is not there is an error that names it") {
    CHECK(contains(require_error(load_suite("no/such.yaml")).message, "no/such.yaml"));
  }
}

}  // namespace

}  // namespace mneme
