// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A scene for planar8 in which planners never come to an end by themselves.
#pragma once

#include "mneme/scene.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace mneme::test {

/// Around the base: the first link has two windows, at 0 and at a quarter turn, and there is no way
/// from one to the other.
inline Scene ring_with_two_windows() {
  std::vector<std::array<double, 3>> circles;
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * std::numbers::pi * i / 24;
    if (i != 0 && i != 6) circles.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.1});
  }
  return make_circle_scene("ring", circles);
}

}  // namespace mneme::test
