// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What this process has proven of motions, and the cells that it has proven it in.
#pragma once

#include "mneme/path.h"

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <unordered_set>

namespace mneme::internal {

/// Motions that have passed a proof which is a function of their two rows of floats, of their ends
/// and of what does not change here: what passed once passes always. No hash stands for any.
/// Thread-safe.
class ProvenMotions {
 public:
  /// So many are kept.
  explicit ProvenMotions(std::size_t most) : most_(most) {}

  /// Those on which the links of the robot keep apart, whatever is around it: where obstacles have
  /// moved that part of a proof stays, and where an arm is folded it is most of the work. Null
  /// unless whole motions are verified, and where anything is checked by exact geometry.
  [[nodiscard]] static std::shared_ptr<ProvenMotions> of_links(const CollisionChecker& checker,
                                                               Verification verification);

  [[nodiscard]] bool contain(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends) const;
  /// Where there are as many as are kept, all are forgotten first.
  void add(std::span<const float> from, std::span<const float> to, MotionEnds ends);

 private:
  std::size_t most_;
  mutable std::mutex mutex_;
  std::unordered_set<std::string> motions_;  ///< their bytes
};

/// Obstacles that stay where they are: the same motions are replayed among them again and again, to
/// prove them takes most of a query, and to make the checker's tables and to look at the ends much
/// of the rest. All that a proof depends on is compared: the robot, the obstacles, what the checker
/// was made with. What a database says of its rows counts for nothing: only a proof of this process
/// does. Thread-safe.
class StaticCell {
 public:
  explicit StaticCell(const CollisionChecker& checker);

  /// That which is kept of the robot, the scene and the settings; may be null.
  [[nodiscard]] static std::shared_ptr<StaticCell> find(const Robot& robot, const Scene& scene,
                                                        const CheckerSettings& settings);
  /// That of the checker, which is kept from now on: the few that were asked for last are. Null for
  /// one with constraints, and for one with points, meshes or octrees, which are edited in place
  /// while nothing else holds them.
  [[nodiscard]] static std::shared_ptr<StaticCell> keep(const CollisionChecker& checker);

  [[nodiscard]] const CollisionChecker& checker() const { return checker_; }
  /// That have passed a verification, which is not `none`.
  [[nodiscard]] ProvenMotions& motions(Verification verification) {
    return verification == Verification::states ? by_states_ : by_motions_;
  }
  /// Whether it is known that a configuration of the robot touches nothing.
  [[nodiscard]] bool is_clear(const Configuration& q) const;
  void add_clear(const Configuration& q);

 private:
  CollisionChecker checker_;
  ProvenMotions by_states_, by_motions_;
  ProvenMotions clear_;  ///< from a state to itself
};

}  // namespace mneme::internal
