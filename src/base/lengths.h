// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Lengths of short vectors of floats, with the same bits on all platforms: std::hypot rounds
/// differently in each library.
#pragma once

#include <algorithm>
#include <cmath>

namespace mneme::internal {

[[nodiscard]] inline float length_of(float x, float y) {
  return static_cast<float>(std::sqrt(double{x} * x + double{y} * y));
}

[[nodiscard]] inline float length_of(float x, float y, float z) {
  const float most = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (most == 0) return 0;
  x /= most;
  y /= most;
  z /= most;
  return most * std::sqrt(x * x + y * y + z * z);
}

}  // namespace mneme::internal
