// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Access to joint values of states, counters and scratch memory.
#pragma once

#include "mneme/ompl.h"

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <memory>
#include <span>
#include <vector>

namespace mneme::ompl {

/// Joint values in states of any space with one real per joint. Const functions are parallel-safe.
class JointValues {
 public:
  /// Keeps a reference to `space`.
  explicit JointValues(const ::ompl::base::StateSpace* space)
      : space_(space),
        is_vector_(dynamic_cast<const ::ompl::base::RealVectorStateSpace*>(space) != nullptr) {}

  void read(const ::ompl::base::State* state, std::span<float> q) const {
    if (is_vector_) return copy(vector(state), q);
    std::vector<double> reals;
    space_->copyToReals(reals, state);
    copy(reals.data(), q);
  }

  void write(std::span<const float> q, ::ompl::base::State* state) const {
    if (is_vector_) {
      for (std::size_t i = 0; i < q.size(); ++i) vector(state)[i] = q[i];
    } else {
      space_->copyFromReals(state, {q.begin(), q.end()});
    }
  }

 private:
  static double* vector(const ::ompl::base::State* state) {
    return state->as<::ompl::base::RealVectorStateSpace::StateType>()->values;
  }
  static void copy(const double* values, std::span<float> q) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = static_cast<float>(values[i]);
  }

  const ::ompl::base::StateSpace* space_;
  bool is_vector_;
};

inline void count_states(const std::shared_ptr<WorkCounters>& counters, std::uint64_t states) {
  if (counters) counters->states.fetch_add(states, std::memory_order_relaxed);
}
inline void count_motion(const std::shared_ptr<WorkCounters>& counters, std::uint64_t states) {
  if (!counters) return;
  counters->states.fetch_add(states, std::memory_order_relaxed);
  counters->motions.fetch_add(1, std::memory_order_relaxed);
}

/// A buffer for a configuration, one per thread and slot. OMPL's threads share validity checkers,
/// and an allocation costs as much as checking a state.
template <int slot>
std::span<float> scratch(const Robot& robot) {
  thread_local std::vector<float> values;
  values.resize(static_cast<std::size_t>(robot.joint_count()));
  return values;
}

/// An allocator that counts samples. It wraps the samplers of `allocator`, or the space's own if
/// that is empty.
[[nodiscard]] ::ompl::base::StateSamplerAllocator count_samples(
    ::ompl::base::StateSamplerAllocator allocator, std::shared_ptr<WorkCounters> counters);

/// Motions are valid if they pass the verification of final paths. Keeps a reference to `verifier`.
[[nodiscard]] ::ompl::base::MotionValidatorPtr make_verified_motion_validity(
    const ::ompl::base::SpaceInformationPtr& information, const CollisionChecker& checker,
    std::shared_ptr<WorkCounters> counters, const MotionVerifier& verifier);

}  // namespace mneme::ompl
