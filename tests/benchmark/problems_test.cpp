// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include "support/support.h"

namespace mneme {
namespace {

using test::contains;
using test::require;

TEST_SUITE("unit") {
  TEST_CASE("Parts are every N-th problem, and together all of them") {
    const std::vector<std::string> all = {"a.yaml", "b.yaml", "c.yaml"};
    const auto odd = find_bench_problems(all, "1/2").value();
    REQUIRE(odd.size() == 2);
    CHECK(odd[1].where == "c.yaml");
    CHECK(find_bench_problems(all, "2/2").value().front().where == "b.yaml");
    CHECK(find_bench_problems(all).value().size() == 3);
    for (const char* text : {"0/2", "3/2", "1/0", "1", "1/2x", "/2"}) {
      CAPTURE(text);
      CHECK(contains(find_bench_problems(all, text).error().message, "is no part; expected I/N"));
    }
    CHECK(parse_part("0/4").value().holds(3));
    CHECK(parse_part("4/4").value().holds(3));
    CHECK_FALSE(parse_part("0/4").value().holds(0));
  }

  TEST_CASE("Directories stand for the problems in them, without scenes and grids") {
    const std::vector<std::string> where = {test::source_file("scenes/planar")};
    const auto found = require(find_bench_problems(where));
    CHECK(found.size() >= 6);
    for (const SuiteProblems& problem : found) {
      const bool is_compact = contains(problem.where, ".json#");
      CHECK(problem.set == (is_compact ? "scenario3_narrow" : "planar"));
      CHECK(!contains(problem.where, "grid"));
    }
    const test::TemporaryDirectory empty;
    CHECK_FALSE(find_bench_problems({empty / ""}).has_value());
  }

  TEST_CASE("Problems of one name, of several files that are one set, are told apart") {
    const test::TemporaryDirectory made;
    const std::string text =
        R"({"robot": "planar8", "problems": [{"name": "a", "start": [0, 0, 0, 0, 0, 0, 0, 0],
            "goal": [1, 0, 0, 0, 0, 0, 0, 0], "circles": []}]})";
    for (const char* file : {"cage.json", "box.json"}) test::write_file(made / file, text);
    const auto ignore = [](const std::string&) {};
    const auto names_of = [&](const std::string& set) {
      const auto loaded = require(load_bench_problems({{made / "", set, ""}}, {}, ignore));
      std::vector<std::string> names;
      for (const LoadedProblem& problem : loaded) names.push_back(problem.problem.name);
      return names;
    };
    CHECK(names_of("hard") == std::vector<std::string>{"box#a", "cage#a"});
    CHECK(names_of("") == std::vector<std::string>{"a", "a"});
  }
}

}  // namespace
}  // namespace mneme
