// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

struct Growing {
  Problem problem = planar_problem("threaded_b4");
  TemporaryDirectory directory;
  SolveSettings settings;

  Growing() { settings.memory.kind = "paths"; }
  Database open(OpenMode mode) {
    return Database::open(directory / "m.db", make_signature(problem.robot), mode).value();
  }
  SolveResult solve_with(Database& database) {
    SolveResult result = require_solved(problem, &database, settings);
    REQUIRE(database.flush());
    return result;
  }
};

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("what took long enough is remembered, and found the next time") {
    Growing growing;
    Database database = growing.open(OpenMode::create);
    growing.settings.remember_after = 0;
    const SolveResult first = growing.solve_with(database);
    CHECK(first.remembered.is_queued);
    CHECK(first.remembered.failure.empty());
    CHECK(first.remembered.time_s > 0);
    CHECK(first.planning_time_s + first.remembered.time_s <= first.total_time_s);
    REQUIRE(database.size() == 1);
    CHECK(contains(database.get(0)->provenance.settings, "threaded_b4"));
    CHECK(static_cast<std::size_t>(database.get(0)->component_count()) == first.plan.path.size());

    growing.settings.remember_after = 1000000000;
    growing.settings.retrieve_after = 0;
    growing.settings.plan.seed = 2;
    const SolveResult second = growing.solve_with(database);
    CHECK(!second.remembered.is_queued);
    CHECK(database.size() == 1);
    CHECK(second.gl.mixture->component_count() > 0);
  }

  TEST_CASE("a database of schema 3 is replayed from as the mneme that wrote it did") {
    const TemporaryDirectory directory;
    std::filesystem::copy_file(source_file("tests/engines/schema3_planar.db"), directory / "m.db");
    Problem problem = planar_problem("scenario1");
    SolveSettings settings;
    settings.memory.kind = "paths";
    settings.replay = 0.5;
    auto database =
        Database::open(directory / "m.db", make_signature(problem.robot), OpenMode::read_only);
    REQUIRE(database.has_value());
    const auto replayed_row = [&](double angle) {
      problem.constraints = {{"link_8", Vec3::UnitZ(), Vec3::UnitZ(), angle}};
      if (angle == 0) problem.constraints.clear();
      const SolveResult result = solve(problem, &*database, settings).value();
      if (result.replay.is_hit()) {
        CHECK(result.plan.path.size() == 11);
        CHECK(path_length(problem.robot, result.plan.path) == doctest::Approx(10.521183514462283));
      }
      return result.replay.row;
    };
    CHECK(replayed_row(0) == 3);
    CHECK(replayed_row(0.2) == 8);
    CHECK(replayed_row(0.3) == 0);
  }

  TEST_CASE("what is easy is remembered once enough of it came together") {
    Growing growing;
    growing.settings.retrieve_after = 1000000000;
    Database database = growing.open(OpenMode::create);
    const std::uint64_t iterations = growing.solve_with(database).plan.iterations;
    REQUIRE(iterations > 0);
    growing.settings.remember_after = static_cast<int>(2 * iterations + 1);
    CHECK(!growing.solve_with(database).remembered.is_queued);
    CHECK(!growing.solve_with(database).remembered.is_queued);
    CHECK(growing.solve_with(database).remembered.is_queued);
    CHECK(!growing.solve_with(database).remembered.is_queued);
    CHECK(database.size() == 1);
  }

  TEST_CASE("a path that memory has already is not remembered again") {
    Growing growing;
    Database database = growing.open(OpenMode::create);
    growing.settings.remember_after = 0;
    growing.settings.retrieve_after = 1000000000;
    growing.solve_with(database);
    CHECK(database.queued_rows().stored == 1);
    growing.solve_with(database);
    CHECK(database.queued_rows().stored == 1);
    CHECK(database.size() == 1);
  }

  TEST_CASE("a path that planning finds again is one row, whatever planning it cost") {
    Growing growing;
    Database database = growing.open(OpenMode::create);
    growing.settings.remember_after = 0;
    const SolveResult first = growing.solve_with(database);
    Experience again = *database.get(0);
    CHECK(again.path().planning_states == first.plan.states_checked);
    again.path().planning_states = 7;
    again.provenance = {"another mneme", "solved problem of another name", 9, "2020"};
    std::vector<bool> is_new;
    CHECK(database.insert({again}, &is_new) == std::vector<std::int64_t>{1});
    CHECK(is_new == std::vector<bool>{false});
    CHECK(database.size() == 1);
  }

  TEST_CASE("nothing is remembered unless it is asked for") {
    Growing growing;
    Database database = growing.open(OpenMode::create);
    CHECK(!growing.solve_with(database).remembered.is_queued);
    CHECK(database.size() == 0);
  }

  TEST_CASE("a path is found even if it cannot be remembered, and the result says why") {
    Growing growing;
    write_file(growing.directory / "m.db", "");
    Database database = growing.open(OpenMode::read_only);
    growing.settings.remember_after = 0;
    const SolveResult result = growing.solve_with(database);
    CHECK(!result.remembered.is_queued);
    CHECK(contains(result.remembered.failure, "m.db"));
  }
}

}  // namespace mneme::test
