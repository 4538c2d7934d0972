// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// An arm of two links with a memory of paths, planned for by the rivals.
#pragma once

#include "mneme/baselines.h"

#include "support/path_cell.h"

namespace mneme::test {

struct ArmCell : PathCell {
  /// Circles that the tip of the arm touches at `angle` of its first joint, out to `reach`.
  void block(double angle, double reach) {
    std::vector<std::array<double, 3>> circles;
    for (double r = 1.8; r < reach; r += 0.1) {
      circles.push_back({r * std::cos(angle), r * std::sin(angle), 0.06});
    }
    problem.scene = make_circle_scene("cell", circles);
  }
  SolveResult solve(std::string_view rival) {
    settings.planner = rival;
    return require(find_rival(rival)->solve(problem, &database, settings));
  }
  [[nodiscard]] bool is_free(const Path& path) const {
    return is_path_free(problem.robot, problem.scene, path, 0.002);
  }
};

}  // namespace mneme::test
