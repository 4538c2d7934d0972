// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions that this process has proven to be free.
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
/// octrees, which are edited in place while nothing else holds them.
///
/// Where obstacles have moved, links keep apart on the same motions all the same: that part of a
/// proof depends on the robot alone, and where an arm is folded it is most of the work.
/// Thread-safe.
class ProvenMotions {
 public:
  /// Of the cell of `checker`: one of the few that were asked for last, or a new one. Null for a
  /// cell that has none.
  [[nodiscard]] static std::shared_ptr<ProvenMotions> of(const CollisionChecker& checker,
                                                         Verification verification);
  /// Motions on which the links of the robot keep apart, whatever is around it; likewise. Null
  /// unless whole motions are verified, and where anything is checked by solid.
  [[nodiscard]] static std::shared_ptr<ProvenMotions> of_links(const CollisionChecker& checker,
                                                               Verification verification);

  /// So many are kept.
  explicit ProvenMotions(std::size_t most) : most_(most) {}

  [[nodiscard]] bool contain(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends) const;
  /// Where there are as many as are kept, all are forgotten first.
  void add(std::span<const float> from, std::span<const float> to, MotionEnds ends);

 private:
  std::size_t most_;
  mutable std::mutex mutex_;
  std::unordered_set<std::string> motions_;  ///< their bytes
};

}  // namespace mneme::internal
