// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths that bend with their goal, and the proof that all of them are free.
#pragma once

#include "mneme/collision.h"

#include "goal/link_chain.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mneme::internal {

using JointPath = std::vector<JointVector>;

/// Waypoints behind the start, and shares, are multiples of it: short in files.
inline constexpr double kPathStep = 1.0 / 8192;

/// The multiple of `step` that is nearest to a value.
[[nodiscard]] inline float rounded(double value, double step) {
  return static_cast<float>(step * std::nearbyint(value / step));
}

/// A path that moves each waypoint by a share of the change of its goal.
struct BentPath {
  std::vector<float> rows;    ///< waypoints, row by row; the last is the unchanged goal
  std::vector<float> shares;  ///< by waypoint: 0 at the start, 1 at the goal

  [[nodiscard]] std::size_t size() const { return shares.size(); }
  [[nodiscard]] std::span<const float> row(std::size_t i) const {
    const std::size_t joints = rows.size() / shares.size();
    return {rows.data() + i * joints, joints};
  }
  /// A waypoint of the unchanged path.
  [[nodiscard]] JointVector waypoint(std::size_t i) const {
    const std::span<const float> values = row(i);
    return Eigen::Map<const Eigen::VectorXf>(values.data(), std::ssize(values)).cast<double>();
  }
  [[nodiscard]] JointVector waypoint(std::size_t i, const JointVector& change) const {
    return waypoint(i) + double{shares[i]} * change;
  }
  [[nodiscard]] JointVector goal() const { return waypoint(size() - 1); }
};

/// The value of a family's quadratic at `u`, in double precision.
[[nodiscard]] JointVector evaluate(const GoalShift& shift, const double* u);

/// Returns the length of the path up to each waypoint, radians.
[[nodiscard]] std::vector<double> arc_lengths(const JointPath& path);

/// Drops waypoints that hardly matter, such as those that bend() adds.
[[nodiscard]] JointPath without_straights(const JointPath& path);

/// False if a continuous joint turns so far between two waypoints that its direction is not unique.
[[nodiscard]] bool has_unique_turns(const LinkChain& chain, const JointVector& from,
                                    const JointVector& to);
/// False if the path to `goal` turns a continuous joint much more than half a turn, while that to
/// the unchanged goal does not: another turn of the goal is nearer to the start.
[[nodiscard]] bool takes_nearest_turns(const BentPath& path, const LinkChain& chain,
                                       const JointVector& goal);
/// Halves motions that turn a continuous joint far, so that bent ones have unique turns.
[[nodiscard]] JointPath with_short_turns(const JointPath& path, const LinkChain& chain);

/// Number of ways to spread a bend along a path.
inline constexpr int kBendProfiles = 6;
/// Spreads the bend over the path's last part, and adds waypoints where it begins and ends.
[[nodiscard]] BentPath bend(JointPath path, int profile);

/// Where a proof failed.
struct ProofFailure {
  bool is_over_budget = false;
  JointVector q;     ///< a state that is, or may be, too close to contact
  double along = 0;  ///< its place, as a share of the path's motions
  /// Displacement of what may touch there, by time and by parameter.
  std::array<float, 1 + kMostParameters> displacements = {};
};

struct ProofSettings {
  float margin = 2e-4f;
  std::uint64_t most_states = 20000;
  std::uint64_t seed = 1;
  bool has_links = true;   ///< false: only obstacles count
  bool has_trials = true;  ///< single states first: cheaper where the proof fails
};

/// Returns true if the path, with its goal changed by any value of `shift`, is free. Otherwise
/// `failure` has a place; conservative.
[[nodiscard]] bool prove(const CollisionChecker& checker, const BentPath& path,
                         const GoalShift& shift, const ProofSettings& settings,
                         ProofFailure& failure, CheckCounters& counters);

}  // namespace mneme::internal
