// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

namespace mneme::ompl {

::ompl::geometric::PathGeometric to_ompl(const Path& path,
                                         const ::ompl::base::SpaceInformationPtr& information) {
  ::ompl::geometric::PathGeometric result(information);
  const ::ompl::base::StateSpacePtr& space = information->getStateSpace();
  for (const Configuration& q : path) {
    ::ompl::base::State* state = space->allocState();
    space->copyFromReals(state, q);
    space->enforceBounds(state);
    result.getStates().push_back(state);
  }
  return result;
}

Path from_ompl(const ::ompl::geometric::PathGeometric& path, const Robot& robot) {
  const ::ompl::base::StateSpacePtr& space = path.getSpaceInformation()->getStateSpace();
  Path result;
  std::vector<double> q;
  for (std::size_t i = 0; i < path.getStateCount(); ++i) {
    space->copyToReals(q, path.getState(static_cast<unsigned>(i)));
    result.push_back(robot.normalized(q));
  }
  return result;
}

}  // namespace mneme::ompl
