// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sizes and rotations in files that are not right, but whose meaning is clear.
#pragma once

#include <array>
#include <cmath>
#include <string_view>

namespace mneme::internal {

inline constexpr std::string_view kThinFault = "a size of 0 is taken for 0.1 mm";

/// Returns a size in metres; 0.1 mm for 0, so that a plate without thickness is still checked.
[[nodiscard]] inline double thickened(double size) {
  constexpr double kThin = 1e-4;
  return size == 0 ? kThin : size;
}

inline constexpr std::string_view kScaledFault =
    "the quaternion's length is not 1, and the quaternion is scaled";

/// Judgement of a quaternion by its length.
enum class QuaternionLength { unit, tolerated, wrong };

/// Returns `tolerated` for a length that is not 1 but within a factor of 10; `wrong` also for NaN.
[[nodiscard]] inline QuaternionLength judge_length(const std::array<double, 4>& q) {
  constexpr double kUnitTolerance = 1e-3, kMostFactor = 10;
  const double length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (std::abs(length - 1) <= kUnitTolerance) return QuaternionLength::unit;
  const bool is_near = length * kMostFactor >= 1 && length <= kMostFactor;
  return is_near ? QuaternionLength::tolerated : QuaternionLength::wrong;
}

}  // namespace mneme::internal
