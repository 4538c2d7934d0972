// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions that this process has proven free, kept per cell: robot, obstacles and settings of the
/// checker.
#pragma once

#include "mneme/planning.h"

#include "memory/local_motions.h"

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <unordered_set>

namespace mneme::internal {

/// Motions that have passed a proof. The proof is a function of the motion's bits and ends and of
/// nothing else that changes, so that it stays valid. Compares bits, not hashes. Thread-safe.
class ProvenMotions {
 public:
  /// Keeps at most `most` motions.
  explicit ProvenMotions(std::size_t most) : most_(most) {}

  /// Returns the motions on which the robot's links keep apart. This part of a proof stays valid
  /// where only obstacles change, and is most of the work for a folded arm. Null if `verification`
  /// is not of whole motions, or if any pair is checked by exact geometry.
  [[nodiscard]] static std::shared_ptr<ProvenMotions> of_links(const CollisionChecker& checker,
                                                               Verification verification);

  [[nodiscard]] bool contain(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends) const;
  /// Adds a motion. Drops all motions first if `most` are kept.
  void add(std::span<const float> from, std::span<const float> to, MotionEnds ends);

 private:
  std::size_t most_;
  mutable std::mutex mutex_;
  std::unordered_set<std::string> motions_;  ///< bytes of the motions
};

/// Checker and proofs for obstacles that stay in place. Replaying a known task spends most of its
/// time on proofs, and much of the rest on making the checker and checking start and goal. A cell
/// is found by everything that a proof depends on: robot, obstacles and settings of the checker. It
/// holds only proofs of this process, never statements of a database. Thread-safe.
class StaticCell {
 public:
  explicit StaticCell(const CollisionChecker& checker);

  /// Returns the cell of this robot, scene and settings, or null.
  [[nodiscard]] static std::shared_ptr<StaticCell> find(const Robot& robot, const Scene& scene,
                                                        const CheckerSettings& settings);
  /// Returns the checker's cell and keeps it among the few that were used last. Null for a checker
  /// with constraints, and for one with clouds, meshes or octrees, which are edited in place while
  /// nothing else holds them.
  [[nodiscard]] static std::shared_ptr<StaticCell> keep(const CollisionChecker& checker);

  [[nodiscard]] const CollisionChecker& checker() const { return checker_; }
  /// Motions that have passed `verification`, which is not `none`.
  [[nodiscard]] ProvenMotions& motions(Verification verification) {
    return verification == Verification::states ? by_states_ : by_motions_;
  }
  /// True if start and goals are known to be valid and free of contact.
  [[nodiscard]] bool are_clear(const PlanQuery& ends) const;
  void add_clear(const PlanQuery& ends);
  /// Places of remembered motions that are known in this scene.
  [[nodiscard]] KnownPlaces& places() { return places_; }

 private:
  CollisionChecker checker_;
  ProvenMotions by_states_, by_motions_;
  ProvenMotions clear_;  ///< start and goals, as motions from a state to itself
  KnownPlaces places_;
};

/// Returns what make_query_checker() does, from the checker of a kept cell if there is one.
[[nodiscard]] Result<QueryChecker> query_checker_of(const Robot& robot, const Scene& scene,
                                                    const CheckerSettings& settings,
                                                    const PlanQuery& ends);

/// A checker for the motions between `ends`, and its cell.
struct CellChecker {
  QueryChecker checked;
  std::shared_ptr<StaticCell> cell;  ///< null if nothing is kept
};
/// Returns the checker of a kept cell in which start and goals are known to be free, or makes one.
[[nodiscard]] Result<CellChecker> find_or_make_checker(const Robot& robot, const Scene& scene,
                                                       const CheckerSettings& settings,
                                                       const PlanQuery& ends);

}  // namespace mneme::internal
