// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// An OMPL program whose state space draws from memory. Its three lines for mneme are marked.
#include "mneme/ompl.h"

#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <cstdlib>
#include <iostream>

namespace {

/// The value, or the end of the program with what is wrong.
template <class T>
T value_or_exit(mneme::Result<T> result) {
  if (result) return *std::move(result);
  std::cerr << result.error().message << '\n';
  std::exit(1);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return std::cerr << "usage: 04_with_ompl PROBLEM.yaml MEMORY.db\n", 2;
  const auto problem = value_or_exit(mneme::load_problem(arguments[1]));
  const auto checker = value_or_exit(mneme::CollisionChecker::make(problem.robot, problem.scene));
  const auto space = mneme::make_signature(problem.robot);
  auto memory =
      value_or_exit(mneme::Database::open(arguments[2], space, mneme::OpenMode::read_only));
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
