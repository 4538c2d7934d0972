// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// An arm of two links, and a memory of paths of its own.
#pragma once

#include "support/planar_memory.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace mneme::test {

struct PathCell {
  Problem problem{.name = "cell",
                  .robot = limited_arm({1, 1}, -0.5, 2.5),
                  .start = {0, 0.5},
                  .goals = {{2, 0.5}}};
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", problem.robot);
  SolveSettings settings;

  PathCell() {
    settings.memory.kind = "paths";
    settings.replay = 0.5;
  }
  void remember(const Path& path, std::optional<std::uint64_t> planning_states = {}) {
    auto rows =
        require(learn_from_paths(memory_query(problem), std::vector<Path>{path}, {"paths", {}}));
    rows.front().path().planning_states = planning_states;
    require(database.insert(std::move(rows)));
  }
};

}  // namespace mneme::test
