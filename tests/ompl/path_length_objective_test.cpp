// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"
#include "ompl/small_problems.h"

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/samplers/InformedStateSampler.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>

namespace mneme::test {
namespace {

struct Informed {
  Problem problem;
  ob::SpaceInformationPtr information = mneme::ompl::make_space_information(checker_of(problem));
  ob::ProblemDefinitionPtr definition = std::make_shared<ob::ProblemDefinition>(information);
  ob::OptimizationObjectivePtr objective = mneme::ompl::make_path_length_objective(information);

  explicit Informed(Problem posed = gap_problem()) : problem(std::move(posed)) {
    definition->setStartAndGoalStates(state_of(information, problem.start),
                                      state_of(information, problem.goals[0]));
    definition->setOptimizationObjective(objective);
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the cost of a motion is its length") {
    const Informed informed;
    const auto from = state_of(informed.information, {3, 0, 0});
    const auto to = state_of(informed.information, {-3, 0, 0.5});
    CHECK(informed.objective->motionCost(from.get(), to.get()).value() ==
          doctest::Approx(std::hypot(2 * kPi - 6, 0.5)));
  }

  TEST_CASE("informed samples are those of the allocator that can shorten the path") {
    Informed informed;
    informed.information->getStateSpace()->setStateSamplerAllocator(mneme::ompl::sampler_allocator(
        std::shared_ptr<const Sampler>(make_uniform_sampler(informed.problem.robot))));
    const auto sampler = informed.objective->allocInformedStateSampler(informed.definition, 100000);
    const Robot& robot = informed.problem.robot;
    const double shortest = robot.distance(informed.problem.start, informed.problem.goals[0]);
    ob::ScopedState<> state(informed.information);
    for (int i = 0; i < 50; ++i) {
      REQUIRE(sampler->sampleUniform(state.get(), ob::Cost(1.5 * shortest)));
      const Configuration q = values_of(state.get(), 3);
      CHECK(robot.distance(informed.problem.start, q) +
                robot.distance(q, informed.problem.goals[0]) <=
            1.5 * shortest + 1e-9);
    }
    CHECK(!sampler->sampleUniform(state.get(), ob::Cost(0.5 * shortest)));
  }
}

TEST_SUITE("flow") {
  TEST_CASE("BIT* draws from the sampler through it") {
    const mneme::ompl::Silence silence;
    Informed informed(locked_problem());
    const auto constant = std::make_shared<ConstantSampler>(std::vector<float>{-3.1f, 0.2f});
    informed.information->getStateSpace()->setStateSamplerAllocator(
        mneme::ompl::sampler_allocator(constant));
    og::BITstar planner(informed.information);
    planner.setProblemDefinition(informed.definition);
    planner.setup();
    planner.solve(ob::PlannerTerminationCondition([&] { return constant->drawn() >= 20; }));
    CHECK(constant->drawn() >= 20);
  }
}

}  // namespace mneme::test
