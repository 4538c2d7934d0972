// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What this process has proven of motions, and the cells that it has proven it in.
#pragma once

#include "mneme/planning.h"

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

  /// The cell that is kept for this robot, scene and settings; null if there is none.
  [[nodiscard]] static std::shared_ptr<StaticCell> find(const Robot& robot, const Scene& scene,
                                                        const CheckerSettings& settings);
  /// The checker's cell, kept from now on with the few others that were used last. Null for a
  /// checker with constraints, and for one with points, meshes or octrees, which are edited in
  /// place while nothing else holds them.
  [[nodiscard]] static std::shared_ptr<StaticCell> keep(const CollisionChecker& checker);

  [[nodiscard]] const CollisionChecker& checker() const { return checker_; }
  /// That have passed a verification, which is not `none`.
  [[nodiscard]] ProvenMotions& motions(Verification verification) {
    return verification == Verification::states ? by_states_ : by_motions_;
  }
  /// True if start and goals are known to be configurations that touch nothing.
  [[nodiscard]] bool are_clear(const PlanQuery& ends) const;
  void add_clear(const PlanQuery& ends);

 private:
  CollisionChecker checker_;
  ProvenMotions by_states_, by_motions_;
  ProvenMotions clear_;  ///< from a state to itself
};

/// A checker for the motions between `ends`, and its cell.
struct CellChecker {
  QueryChecker checked;
  std::shared_ptr<StaticCell> cell;  ///< null if nothing is kept
};
/// make_query_checker(), or the checker of the kept cell in which both ends are known to be clear.
[[nodiscard]] Result<CellChecker> find_or_make_checker(const Robot& robot, const Scene& scene,
                                                       const CheckerSettings& settings,
                                                       const PlanQuery& ends);

}  // namespace mneme::internal
