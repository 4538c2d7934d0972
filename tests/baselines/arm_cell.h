// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// An arm of two links, and a memory of ways of its own.
#pragma once

#include "mneme/baselines.h"

#include "support/planar_memory.h"

namespace mneme::test {

struct ArmCell {
  Problem problem{"cell", limited_arm({1, 1}, -0.5, 2.5), "", {}, {0, 0.5}, {{2, 0.5}}, {}};
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", problem.robot);
  SolveSettings settings;

  ArmCell() {
    settings.memory.kind = "paths";
    settings.replay = 0.5;
  }
  void remember(const Path& path) {
    auto rows = learn_from_paths(memory_query(problem), std::vector<Path>{path}, {"paths", {}});
    REQUIRE(rows.has_value());
    REQUIRE(database.insert(*std::move(rows)).has_value());
  }
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
    const auto result = find_rival(rival)->solve(problem, &database, settings);
    REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
    return *result;
  }
  [[nodiscard]] bool is_free(const Path& path) const {
    return is_path_free(problem.robot, problem.scene, path, 0.002);
  }
};

}  // namespace mneme::test
