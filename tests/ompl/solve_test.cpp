// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

namespace mneme::test {
namespace {

/// Radians: a tenth of a planar arm's default.
constexpr double kExactResolution = 0.002;

void check_refused(const SolveSettings& settings, const std::string& word) {
  const Error error = require_error(solve(gap_problem(), nullptr, settings));
  CHECK(error.code == ErrorCode::invalid);
  CHECK_MESSAGE(contains(error.message, word), error.message);
}

/// A path from start to goal without contact, by exact distances at ten times the resolution.
void check_path(const Problem& problem, const SolveResult& result) {
  REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
  const Path& path = result.plan.path;
  REQUIRE(path.size() >= 2);
  CHECK(path.front() == problem.robot.normalized(problem.start));
  CHECK(problem.robot.distance(path.back(), problem.goals[0]) < 1e-9);
  CHECK(is_path_free(problem.robot, problem.scene, path, kExactResolution));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("wrong settings are errors that say what was expected") {
    check_refused(settings_for("rrt_connect"), "RRTConnect");
    check_refused(settings_for("RRTConnect", "halt"), "gl, uniform");
    check_refused(settings_for("RRTConnect", "gaussian"), "PRM");
    SolveSettings settings = settings_for("RRTConnect");
    settings.lambda = 2;
    check_refused(settings, "'lambda'");
    settings = settings_for("RRTConnect");
    settings.threads = 2;
    check_refused(settings, "'threads'");
  }

  TEST_CASE("a start in contact is a status") {
    Problem problem = gap_problem();
    problem.start = {2.8, 0, 0};
    const SolveResult result = require(solve(problem, nullptr, settings_for("RRTConnect")));
    CHECK(result.plan.status == PlanStatus::invalid_start);
    CHECK(contains(result.plan.message, "touches"));
  }

  TEST_CASE("a database of another robot is refused") {
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", planar8());
    const Error error =
        require_error(solve(gap_problem(), &database, settings_for("RRTConnect", "gl")));
    CHECK(error.code == ErrorCode::wrong_robot);
  }

  TEST_CASE("the same seed gives the same path, another one another") {
    const Problem problem = gap_problem();
    SolveSettings settings = settings_for("RRTConnect");
    const Path path = require(solve(problem, nullptr, settings)).plan.path;
    CHECK(require(solve(problem, nullptr, settings)).plan.path == path);
    settings.plan.seed = 2;
    CHECK(require(solve(problem, nullptr, settings)).plan.path != path);
  }

  TEST_CASE("OMPL's defaults let a planner jump over an obstacle; tuned ones do not") {
    // Two steps of a hundredth of the extent are farther apart than this circle is wide.
    Problem problem{.name = "post", .robot = planar_arm({1}), .start = {-0.5}, .goals = {{0.5}}};
    problem.scene = make_circle_scene("", {{0.95, 0, 0.001}});
    SolveSettings settings = settings_for("RRTConnect");
    SolveSettings careless_settings = settings;
    careless_settings.plan.ompl_defaults = true;
    int tunnels = 0;
    for (settings.plan.seed = 1; settings.plan.seed <= 10; ++settings.plan.seed) {
      careless_settings.plan.seed = settings.plan.seed;
      const SolveResult careless = require(solve(problem, nullptr, careless_settings));
      if (careless.plan.is_solved() &&
          !is_path_free(problem.robot, problem.scene, careless.plan.path, kExactResolution)) {
        ++tunnels;
      }
      check_path(problem, require(solve(problem, nullptr, settings)));
    }
    CHECK(tunnels > 0);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("every planner solves an easy problem with uniform samples") {
    const Problem problem = gap_problem();
    for (const std::string& name : ompl_names()) {
      CAPTURE(name);
      SolveSettings settings = settings_for(name);
      settings.plan.timeout_s = 600;
      settings.plan.seed = 2;  // with which the planners that optimise are quick
      const SolveResult result = require(solve(problem, nullptr, settings));
      check_path(problem, result);
      CHECK(result.planner == "ompl:" + name);
      CHECK(result.total_time_s >= result.planning_time_s);
      CHECK(result.plan.states_checked > 0);
      CHECK(result.plan.motions_checked > 0);
    }
  }

  TEST_CASE("PRM solves it with every sampler of valid states, and with Halton points") {
    const Problem problem = gap_problem();
    for (const std::string& name : valid_sampler_names()) {
      CAPTURE(name);
      check_path(problem, require(solve(problem, nullptr, settings_for("PRM", name))));
    }
    check_path(problem, require(solve(problem, nullptr, settings_for("PRM", "halton"))));
  }

  TEST_CASE("with memory RRTConnect threads the arm out of a gap after fewer samples") {
    const Problem problem = planar_problem("threaded_b4");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", problem.robot);
    const auto primitives = require(decompose(memory_query(problem)));
    LearnSettings learning = cheap_settings();
    learning.starts_per_link = 2;
    learn_into(database, problem.robot, {primitives.at(0).key}, learning);
    std::uint64_t with_memory = 0, uniform = 0;
    SolveSettings settings = settings_for("RRTConnect", "gl");
    settings.plan.max_iterations = 30000;
    settings.plan.timeout_s = 600;
    for (settings.plan.seed = 1; settings.plan.seed <= 2; ++settings.plan.seed) {
      settings.sampler = "gl";
      const SolveResult remembered = require(solve(problem, &database, settings));
      check_path(problem, remembered);
      CHECK(remembered.gl.mixture->component_count() > 0);
      with_memory += remembered.plan.iterations;
      settings.sampler = "uniform";
      uniform += require(solve(problem, nullptr, settings)).plan.iterations;
    }
    CHECK(with_memory < uniform);
  }

  TEST_CASE("what a planner of OMPL solves is remembered if that is asked for") {
    const Problem problem = gap_problem();
    const TemporaryDirectory directory;
    const auto space = make_signature(problem.robot);
    Database database = Database::open(directory / "m.db", space, OpenMode::create).value();
    SolveSettings settings = settings_for("RRTConnect", "gl");
    settings.memory.kind = "paths";
    CHECK(!require(solve(problem, &database, settings)).remembered.is_queued);
    settings.remember_after = 0;
    settings.plan.ompl_defaults = true;
    CHECK(!require(solve(problem, &database, settings)).remembered.is_queued);
    settings.plan.ompl_defaults = false;
    REQUIRE(database.size() == 0);

    const SolveResult result = require(solve(problem, &database, settings));
    check_path(problem, result);
    CHECK(result.remembered.is_queued);
    REQUIRE(database.flush());
    CHECK(result.planning_time_s + result.remembered.time_s <= result.total_time_s);
    REQUIRE(database.size() == 1);
    CHECK(static_cast<std::size_t>(database.get(0)->component_count()) == result.plan.path.size());
  }
}

}  // namespace mneme::test
