// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kernel of a Newton step of TimeBarrier. Tables are rows of one value per joint.
#pragma once

#include "mneme/base.h"

#include <array>
#include <cstddef>

namespace mneme::internal {

/// Rows are padded to a multiple of this number of joints.
inline constexpr std::size_t kJointLanes = 8;
/// Control points at each end of a spline that do not move.
inline constexpr std::size_t kFixedPoints = 3;
/// Values of a joint at a control point that a Newton step works in.
inline constexpr std::size_t kBarrierArrays = 14;

struct BarrierTables {
  std::size_t count = 0;   ///< of control points
  std::size_t stride = 0;  ///< values per row
  double* points = nullptr;
  const double *lower = nullptr, *upper = nullptr;  ///< boxes around the points
  /// Limits of velocity, acceleration and jerk, one row each, and 1 where a joint has this limit,
  /// otherwise 0.
  std::array<const double*, 3> limits, weights;
  double* scratch = nullptr;  ///< kBarrierArrays * count rows
};

struct BarrierKernels {
  /// Changes the points and the step by a Newton step for the barriers and `weight` times the step.
  /// Returns the share of it that was taken, at most 1; nothing changes if it is not finite.
  double (*newton_step)(const BarrierTables& tables, double weight, double& step_s) = nullptr;
};

/// The kernels of an instruction set that this machine has.
[[nodiscard]] const BarrierKernels& barrier_kernels(Isa isa);

}  // namespace mneme::internal
