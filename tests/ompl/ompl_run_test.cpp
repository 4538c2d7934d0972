// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

#include <set>

namespace mneme::test {
namespace {

PlanResult run_with(const Sampler& sampler, const Problem& problem, const std::string& planner,
                    const PlanSettings& settings) {
  const CollisionChecker checker = checker_of(problem);
  const PlanQuery query{problem.start, problem.goals};
  PathFinisher shorten_and_verify(checker, settings.finish());
  auto planned =
      ompl_planner(planner).plan({checker, query, sampler, settings, shorten_and_verify});
  REQUIRE_MESSAGE(planned.has_value(), (planned ? "" : planned.error().message));
  return std::move(*planned);
}

PlanResult run_uniform(const Problem& problem, const std::string& planner,
                       const PlanSettings& settings) {
  return run_with(*make_uniform_sampler(problem.robot), problem, planner, settings);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a run ends at its limits, and says which") {
    const Problem problem = locked_problem();
    PlanSettings settings;
    settings.timeout_s = 0.3;
    for (const char* planner : {"RRTConnect", "PRM", "BITstar", "BKPIECE1"}) {
      const PlanResult late = run_uniform(problem, planner, settings);
      CHECK_MESSAGE(late.status == PlanStatus::timeout, planner);
      CHECK(!late.message.empty());
      CHECK(late.path.empty());
      CHECK(late.planning_time_s >= 0.3);
      CHECK(late.iterations > 0);
    }
    settings.timeout_s = 60;
    settings.max_iterations = 500;
    const PlanResult drawn = run_uniform(problem, "RRTConnect", settings);
    CHECK(drawn.status == PlanStatus::iteration_limit);
    CHECK(drawn.iterations >= 500);
    CHECK(drawn.iterations <= 502);
    settings.max_nodes = 300;
    settings.max_iterations.reset();
    for (const char* planner : {"RRTConnect", "PRM", "BKPIECE1"}) {
      const PlanResult full = run_uniform(problem, planner, settings);
      CHECK_MESSAGE(full.status == PlanStatus::node_limit, planner);
      CHECK(full.message == "no path within 300 nodes");
    }
    const std::atomic<bool> cancel{true};
    settings.cancel = &cancel;
    CHECK(run_uniform(problem, "RRTConnect", settings).status == PlanStatus::cancelled);
  }

  TEST_CASE("memory reaches the planners that docs/design/ompl.md says, and no others") {
    const Problem problem = locked_problem();
    const std::set<std::string> near_only = {"EST",      "BiEST",     "ProjEST", "KPIECE1",
                                             "BKPIECE1", "LBKPIECE1", "SBL",     "STRIDE"};
    PlanSettings settings;
    settings.timeout_s = 10;  // only for a planner that stops drawing
    settings.max_iterations = 300;
    for (const std::string& name : ompl_names()) {
      CAPTURE(name);
      const ConstantSampler sampler({-3.1f, 0.2f});
      static_cast<void>(run_with(sampler, problem, name, settings));
      CHECK((sampler.drawn() == 0) == (near_only.count(name) == 1));
    }
  }

  TEST_CASE("no time at all is a time-out") {
    PlanSettings settings;
    settings.timeout_s = 0;
    CHECK(run_uniform(gap_problem(), "RRTConnect", settings).status == PlanStatus::timeout);
  }

  TEST_CASE("simplification shortens paths, between the same ends") {
    const Problem problem = gap_problem();
    // Roadmaps differ from run to run.
    double planned_length = 0, shortened_length = 0;
    for (int i = 0; i < 5; ++i) {
      PlanSettings settings;
      settings.seed = static_cast<std::uint64_t>(i + 1);
      settings.simplify = false;
      const PlanResult planned = run_uniform(problem, "PRM", settings);
      settings.simplify = true;
      const PlanResult shortened = run_uniform(problem, "PRM", settings);
      REQUIRE(planned.is_solved());
      REQUIRE(shortened.is_solved());
      CHECK(planned.simplification_time_s == 0);
      CHECK(shortened.simplification_time_s > 0);
      planned_length += path_length(problem.robot, planned.path);
      shortened_length += path_length(problem.robot, shortened.path);
      for (const Path& path : {planned.path, shortened.path}) {
        CHECK(path.front() == problem.robot.normalized(problem.start));
        CHECK(path.back() == problem.robot.normalized(problem.goals[0]));
      }
    }
    CHECK(shortened_length < planned_length);
  }

  TEST_CASE("the path ends at the goal that it reached") {
    Problem problem = gap_problem();
    problem.goals.insert(problem.goals.begin(), {0.2, 0.1, 0.1});
    const PlanResult result = run_uniform(problem, "RRTConnect", {});
    REQUIRE(result.is_solved());
    CHECK((result.path.back() == problem.robot.normalized(problem.goals[0]) ||
           result.path.back() == problem.robot.normalized(problem.goals[1])));
  }
}

}  // namespace mneme::test
