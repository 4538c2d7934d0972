// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions that this process has proven to be free among the very same obstacles.
#pragma once

#include "mneme/path.h"

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <unordered_set>

namespace mneme::internal {

/// In a static cell the same motions are replayed again and again, and to prove them takes most of
/// a query. Why that may be left out, and nothing unproven comes back all the same: the proof is a
/// function of the robot, of what the checker was made with, of the verification and of the
/// motion's two rows of floats, so that what passed once passes always. All of these are compared,
/// no hash stands for any. What a database says of its rows counts for nothing: only a proof of
/// this process does. Cells with constraints have none, nor have those with points, meshes or
/// octrees, which are edited in place while nothing else holds them. Thread-safe.
class ProvenMotions {
 public:
  /// Of the cell of `checker`: one of the few that were asked for last, or a new one. Null for a
  /// cell that has none.
  [[nodiscard]] static std::shared_ptr<ProvenMotions> of(const CollisionChecker& checker,
                                                         Verification verification);

  [[nodiscard]] bool contain(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends) const;
  /// Of a cell that has many, all are forgotten first.
  void add(std::span<const float> from, std::span<const float> to, MotionEnds ends);

 private:
  mutable std::mutex mutex_;
  std::unordered_set<std::string> motions_;  ///< their bytes
};

}  // namespace mneme::internal
