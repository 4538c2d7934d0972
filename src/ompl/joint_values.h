// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <span>
#include <vector>

namespace mneme::ompl {

/// Joint values in states of any space with one real per joint. Const is parallel-safe.
class JointValues {
 public:
  /// Refers to `space`.
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

}  // namespace mneme::ompl
