// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/ompl_run.h"

#include <set>

#include "ompl/silence.h"
#include "ompl/small_problems.h"

namespace mneme::test {
namespace {

PlanResult run(const Problem& problem, const std::string& planner, const SolveSettings& settings,
               const OmplSettings& ompl = {}) {
  const mneme::ompl::Silence silence;
  const CollisionChecker checker = checker_of(problem);
  const auto* entry = mneme::ompl::find_ompl_planner(planner);
  REQUIRE(entry != nullptr);
  auto planned = mneme::ompl::OmplRun(problem, checker, settings, ompl, *entry, {}).plan(0);
  REQUIRE_MESSAGE(planned.has_value(), (planned ? "" : planned.error().message));
  return std::move(*planned);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a run ends at its limits, and says which") {
    const Problem problem = locked_problem();
    SolveSettings settings;
    settings.plan.timeout_s = 0.3;
    for (const char* planner : {"RRTConnect", "PRM", "BITstar", "BKPIECE1"}) {
      const PlanResult late = run(problem, planner, settings);
      CHECK_MESSAGE(late.status == PlanStatus::timeout, planner);
      CHECK(!late.message.empty());
      CHECK(late.path.empty());
      CHECK(late.planning_time_s >= 0.3);
      CHECK(late.iterations > 0);
    }
    settings.plan.timeout_s = 60;
    settings.plan.max_iterations = 500;
    const PlanResult drawn = run(problem, "RRTConnect", settings);
    CHECK(drawn.status == PlanStatus::iteration_limit);
    CHECK(drawn.iterations >= 500);
    CHECK(drawn.iterations <= 502);
    settings.plan.max_nodes = 300;
    settings.plan.max_iterations.reset();
    for (const char* planner : {"RRTConnect", "PRM", "BKPIECE1"}) {
      const PlanResult full = run(problem, planner, settings);
      CHECK_MESSAGE(full.status == PlanStatus::node_limit, planner);
      CHECK(full.message == "no path within 300 nodes");
    }
    const std::atomic<bool> cancel{true};
    settings.plan.cancel = &cancel;
    CHECK(run(problem, "RRTConnect", settings).status == PlanStatus::cancelled);
  }

  TEST_CASE("memory reaches the planners that docs/ompl.md says, and no others") {
    const mneme::ompl::Silence silence;
    const Problem problem = locked_problem();
    const CollisionChecker checker = checker_of(problem);
    const std::set<std::string_view> near_only = {"EST",      "BiEST",     "ProjEST", "KPIECE1",
                                                  "BKPIECE1", "LBKPIECE1", "SBL",     "STRIDE"};
    SolveSettings settings;
    settings.plan.timeout_s = 10;  // only for a planner that stops drawing
    settings.plan.max_iterations = 300;
    for (const std::string_view name : ompl_planner_names()) {
      CAPTURE(name);
      const auto sampler = std::make_shared<ConstantSampler>(std::vector<float>{-3.1f, 0.2f});
      const OmplSettings ompl;
      const auto planned = mneme::ompl::OmplRun(problem, checker, settings, ompl,
                                                *mneme::ompl::find_ompl_planner(name),
                                                mneme::ompl::sampler_allocator(sampler))
                               .plan(0);
      REQUIRE(planned.has_value());
      CHECK((sampler->drawn() == 0) == (near_only.count(name) == 1));
    }
  }

  TEST_CASE("no time at all is a time-out") {
    SolveSettings settings;
    settings.plan.timeout_s = 0;
    CHECK(run(gap_problem(), "RRTConnect", settings).status == PlanStatus::timeout);
  }

  TEST_CASE("simplification shortens paths, between the same ends") {
    const Problem problem = gap_problem();
    // Roadmaps differ from run to run.
    double planned_length = 0, shortened_length = 0;
    for (int i = 0; i < 5; ++i) {
      SolveSettings settings;
      settings.plan.seed = static_cast<std::uint64_t>(i + 1);
      settings.plan.simplify = false;
      const PlanResult planned = run(problem, "PRM", settings);
      settings.plan.simplify = true;
      const PlanResult shortened = run(problem, "PRM", settings);
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
    const PlanResult result = run(problem, "RRTConnect", {});
    REQUIRE(result.is_solved());
    CHECK((result.path.back() == problem.robot.normalized(problem.goals[0]) ||
           result.path.back() == problem.robot.normalized(problem.goals[1])));
  }
}

}  // namespace mneme::test
