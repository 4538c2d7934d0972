// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A region of a Panda over a table with a post, and cells of it.
#pragma once

#include "mneme/cell.h"

#include "support/support.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace mneme::test {

/// A hand that points down over a table. `more` are further lines of the file.
inline std::string region_text(const std::string& region = "{x: 0.1, y: 0.08, yaw: 0.3}",
                               const std::string& more = "", double post = 0.35) {
  return fmt::format(
      R"(robot: panda
scene:
  obstacles:
    - {{name: table, type: box, position: [0.5, 0, 0.1], size: [0.6, 1.2, 0.04]}}
    - {{name: post, type: box, position: [0.5, {}, 0.3], size: [0.04, 0.04, 0.4]}}
start: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
goal: {{link: panda_hand, position: [0.5, 0, 0.35], quat_xyzw: [1, 0, 0, 0]}}
region: {}
{})",
      post, region, more);
}

inline Result<CellRegion> read_region_text(const TemporaryDirectory& directory,
                                           const std::string& text) {
  const std::string path = directory / "region.yaml";
  write_file(path, text);
  return load_region(path);
}

inline CellRegion require_region(const TemporaryDirectory& directory, const std::string& text) {
  return require(read_region_text(directory, text));
}

/// Bounded by boxes, so that it does not depend on time.
inline Cell require_cell(const CellRegion& region, std::uint64_t boxes, int threads = 1) {
  return require(build_cell(region, {.seconds = 1000, .boxes = boxes, .threads = threads}));
}

inline CellTask random_task_of(const CellRegion& region, Rng& rng, bool is_corner = false) {
  CellTask task = {};
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    const double share = rng.uniform(-1, 1);
    task[k] = region.half_extents[k] * (is_corner ? std::copysign(1.0, share) : share);
  }
  return task;
}

/// Checks that two cells of a region give the same answers to random tasks.
inline void check_same_answers(const CellRegion& region, const Cell& one, const Cell& other) {
  Rng rng(1);
  for (int i = 0; i < 50; ++i) {
    const CellTask task = random_task_of(region, rng);
    CellAnswer first, second;
    one.look_up(task, first);
    other.look_up(task, second);
    CHECK(first.tier == second.tier);
    CHECK(first.path == second.path);
  }
}

}  // namespace mneme::test
