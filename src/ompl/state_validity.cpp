// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/states.h"

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

constexpr double kMostClearance = 1;         ///< metres
constexpr double kClearanceAccuracy = 1e-3;  ///< metres

class StateValidity final : public ob::StateValidityChecker {
 public:
  StateValidity(const ob::SpaceInformationPtr& information, const CollisionChecker& checker,
                std::shared_ptr<WorkCounters> counters)
      : StateValidityChecker(information),
        checker_(checker),
        values_(information->getStateSpace().get()),
        counters_(std::move(counters)) {
    specs_.clearanceComputationType = ob::StateValidityCheckerSpecs::BOUNDED_APPROXIMATE;
  }

  bool isValid(const ob::State* state) const override {
    if (!si_->satisfiesBounds(state)) return false;
    const std::span<const float> q = read(state);
    count_states(counters_, 1);
    return checker_.is_valid(q);
  }

  /// The largest margin at which the state is free, by bisection.
  double clearance(const ob::State* state) const override {
    const std::span<const float> q = read(state);
    CheckCounters work;
    const auto is_free = [&](double margin) {
      return checker_.is_motion_valid(q, q, work, {1, margin});
    };
    double free = 0, most = kMostClearance;
    if (is_free(most)) {
      free = most;
    } else {
      while (most - free > kClearanceAccuracy) {
        const double middle = 0.5 * (free + most);
        (is_free(middle) ? free : most) = middle;
      }
    }
    count_states(counters_, work.states);
    return free;
  }

 private:
  std::span<const float> read(const ob::State* state) const {
    const std::span<float> q = scratch<0>(checker_.robot());
    values_.read(state, q);
    return q;
  }

  CollisionChecker checker_;
  JointValues values_;
  std::shared_ptr<WorkCounters> counters_;
};

}  // namespace

ob::StateValidityCheckerPtr make_state_validity(const ob::SpaceInformationPtr& information,
                                                const CollisionChecker& checker,
                                                std::shared_ptr<WorkCounters> counters) {
  return std::make_shared<StateValidity>(information, checker, std::move(counters));
}

}  // namespace mneme::ompl
