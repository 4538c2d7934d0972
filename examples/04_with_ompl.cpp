// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// An OMPL program whose state space draws from memory. Its three lines for mneme are marked.
#include "mneme/ompl.h"

#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <iostream>

int main(int count, char** arguments) {
  if (count != 3) return std::cerr << "usage: 04_with_ompl PROBLEM.yaml MEMORY.db\n", 2;
  const auto problem = mneme::load_problem(arguments[1]).value();
  const auto checker = mneme::CollisionChecker::make(problem.robot, problem.scene).value();
  const auto space = mneme::make_space(problem.robot);
  auto memory = mneme::Database::open(arguments[2], space, mneme::OpenMode::read_only).value();
  ompl::geometric::SimpleSetup setup(mneme::ompl::make_space_information(checker));  // mneme
  setup.getStateSpace()->setStateSamplerAllocator(                                   // mneme
      mneme::ompl::gl_sampler_allocator(problem, memory).value());                   // mneme
  ompl::base::ScopedState<> start(setup.getStateSpace()), goal(setup.getStateSpace());
  start = problem.start;
  goal = problem.goals.front();
  setup.setStartAndGoalStates(start, goal);
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.getSpaceInformation()));
  setup.getPlanner()->params().setParam("range", "0.4");
  if (setup.solve(20.0) != ompl::base::PlannerStatus::EXACT_SOLUTION) return 1;
  setup.getSolutionPath().printAsMatrix(std::cout);
}
