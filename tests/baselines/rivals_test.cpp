// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/arm_cell.h"
#include "baselines/small_cvae.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("rivals are no planners: nobody gets one by accident") {
    REQUIRE_FALSE(rivals().empty());
    for (const Rival& rival : rivals()) {
      CHECK(find_rival(rival.name) == &rival);
      CHECK_FALSE(find_planner(rival.name).has_value());
      CHECK_FALSE(rival.summary.empty());
    }
    CHECK(find_rival("rrt_connect") == nullptr);
  }

  TEST_CASE("baselines stand in the table of samplers once they were added, and only once") {
    add_baseline_samplers();
    add_baseline_samplers();
    CHECK(sampler_names() ==
          std::vector<std::string>{"gl", "uniform", "halton", "pooled", "nearest_scenes", "cvae"});
  }

  TEST_CASE("every planner solves with every baseline, and its path starts and ends as asked") {
    add_baseline_samplers();
    Problem problem = planar_problem("threaded_b0");
    problem.scene = make_circle_scene("", {{4, 4, 1.5}, {-2, 4.5, 1}});
    problem.start = Configuration(8, 0.1);
    problem.goals = {Configuration(8, 0.1)};
    problem.goals[0][0] = -2.5;
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    learn_into(database, problem.robot, {near_pair()});
    REQUIRE(internal::save_cvae(directory / "a.db.cvae", random_weights(problem.robot, 1)));
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    for (const PlannerEntry& planner : planners()) {
      for (const std::string sampler : {"pooled", "nearest_scenes", "cvae"}) {
        INFO(planner.name, " with ", sampler);
        settings.planner = planner.name;
        settings.sampler = sampler;
        const SolveResult result = require_solved(problem, &database, settings);
        CHECK(result.sampler == sampler);
        CHECK(result.plan.path.front() == problem.robot.normalized(problem.start));
        CHECK(result.plan.path.back() == problem.robot.normalized(problem.goals[0]));
      }
    }
  }
}

}  // namespace mneme::test
