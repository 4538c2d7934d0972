// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions of a certified cell's answers: a box is timed once, and its motion bends with the task.
#pragma once

#include "mneme/cell.h"
#include "mneme/trajectory.h"

#include <memory>

namespace mneme {

struct CellMotion {
  Trajectory motion;
  /// True: the box's motion, bent. False: the answer's own path was timed.
  bool is_of_box = false;
};

/// Times answers of a cell, as it is when this is made. Copies share what they have timed. Const
/// functions are parallel-safe.
class CellMotions {
 public:
  explicit CellMotions(const Cell& cell);

  /// Returns a motion to the goal of an answer of this cell, proven free, within `limits`, which
  /// are scaled already. Uses the path tolerance and time rounds of `settings`.
  /// - The first certified answer of a box times the box: tens of milliseconds. Later ones bend
  ///   this motion to their task: some tens of microseconds. All take equally long and keep the
  ///   cell's margin. Keeps boxes for the last four limits.
  /// - Boxes whose motions are not proven, and tasks whose motion may leave the joint limits: as
  ///   parameterize() times the answer's path. Corners are cut only where the motion keeps the
  ///   cell's margin from obstacles; between links cut corners are free of contact.
  /// - Answers of other tiers: as parameterize() times the path, free of contact.
  ///
  /// Errors: an answer without a path; one of another cell, also of this one before extend() or in
  /// another world; those of parameterize().
  [[nodiscard]] Result<CellMotion> time(const CellAnswer& answer, const RateLimits& limits,
                                        const TrajectorySettings& settings = {}) const;

 private:
  struct Kept;
  std::shared_ptr<Kept> kept_;
};

}  // namespace mneme
