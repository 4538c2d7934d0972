// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths: their length, shortening and verification.
#pragma once

#include "mneme/base.h"
#include "mneme/collision.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace mneme {
/// Configurations joined by straight motions. Continuous joints take the shorter direction between
/// neighbours.
using Path = std::vector<Configuration>;

/// Shifts continuous joints by whole turns, so that `path` begins at the turn of `start` and the
/// segments between waypoints, as real numbers, are its motions.
[[nodiscard]] Path unwrapped(const Robot& robot, Path path, const Configuration& start);

/// Returns the sum of L2 joint distances, radians; a metre of a prismatic joint counts as a radian.
[[nodiscard]] double path_length(const Robot& robot, const Path& path);

/// Returns about the seconds that `path` takes at the velocity limits of the URDF without stopping:
/// the sum of MotionCost with these.
[[nodiscard]] double path_time(const Robot& robot, const Path& path);

/// The proof that the motions of a path must pass before it is returned.
enum class Verification {
  none,
  states,   ///< states at kVerificationRefinement times the resolution
  motions,  ///< the whole motion: CollisionChecker::is_sweep_valid
};

/// Extra margin, metres, so that an independent checker that samples other states also finds the
/// path free. Start and goal may lie closer to contact.
inline constexpr double kVerificationMargin = 1e-4;
inline constexpr double kVerificationRefinement = 10;  ///< see Verification::states

/// Tells whether a motion is the first or the last one of its path.
struct MotionEnds {
  bool is_first = false, is_last = false;
};

/// Verifies motions of a final path. Const and parallel-safe.
class MotionVerifier {
 public:
  /// Refers to the checker. With Verification::none every motion passes.
  explicit MotionVerifier(const CollisionChecker& checker,
                          Verification verification = Verification::motions)
      : checker_(checker), verification_(verification) {}

  /// Returns true if the motion passes. Rejects motions that turn a continuous joint by pi:
  /// rounding would choose the direction. `are_links_apart` skips the links' check against each
  /// other in Verification::motions.
  [[nodiscard]] bool is_free(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends, CheckCounters& counters,
                             bool are_links_apart = false) const;

  /// Returns true if a curve inside a path passes. `states` are points on it, row by row. `bow`
  /// bounds, per joint, how far the curve is from the straight motion between two points; it adds
  /// to the required margin.
  [[nodiscard]] bool is_curve_free(std::span<const float> states, std::span<const float> bow,
                                   CheckCounters& counters) const;

  /// Returns the index of the first motion of `path` that does not pass, or -1.
  [[nodiscard]] int find_invalid_motion(const Path& path, CheckCounters& counters) const;

 private:
  [[nodiscard]] bool has_unique_direction(std::span<const float> from,
                                          std::span<const float> to) const;

  const CollisionChecker& checker_;
  Verification verification_;
};

/// Calls MotionVerifier::find_invalid_motion for one path.
[[nodiscard]] int find_invalid_motion(const CollisionChecker& checker, const Path& path,
                                      CheckCounters& counters,
                                      Verification verification = Verification::motions);

/// Limits the cost of shortening.
struct ShortenEffort {
  /// Shortening ends after this number of consecutive checks, of 16 states each, without a gain.
  /// 0: only drops waypoints.
  double patience = 40;
  double least_gain = 0.007;   ///< smallest gain that counts, as a share of the path's length
  double refinement = 1;       ///< MotionDetail::refinement of new motions
  double margin = 1e-3;        ///< metres that new motions keep from contact, if their ends do
  bool minimize_time = false;  ///< of path_time(), instead of path_length()
};

/// Shortens `path`, or its time: drops waypoints, then relaxes them and straightens random joints,
/// or all, over random stretches. Keeps both ends. New motions stay the effort's margin from
/// contact, or as far as the nearer end of the path, and pass `verifier` unless it is null. Stops
/// once `must_stop` returns true; it is called before each step and may be empty. After Geraerts
/// and Overmars, DOI 10.1177/0278364907079280.
void shorten(const CollisionChecker& checker, Path& path, std::uint64_t seed,
             const ShortenEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
             const std::function<bool()>& must_stop = {});

/// Settings for shortening and verifying a path before it is returned.
struct FinishSettings {
  bool simplify = true;
  Verification verification = Verification::motions;
  std::uint64_t seed = 1;
  double timeout_s = 10;  ///< from construction; shortening takes at most half of the rest
  const std::atomic<bool>* cancel = nullptr;  ///< may be null
  int patience = 40;                          ///< ShortenEffort::patience
  bool minimize_time = false;                 ///< ShortenEffort::minimize_time
};

/// Shortens and verifies paths that a planner offers; the planner continues if one is refused. A
/// motion that fails is repaired by a waypoint nearby where one exists. Results depend on time only
/// through the timeout. Not thread-safe.
class PathFinisher {
 public:
  /// Refers to the checker.
  PathFinisher(const CollisionChecker& checker, const FinishSettings& settings);
  PathFinisher(const PathFinisher&) = delete;
  PathFinisher& operator=(const PathFinisher&) = delete;

  /// Shortens and verifies `path`. Returns -1, or the index of the first motion of the given path
  /// that fails; the path is then unchanged. Adds its work to `counters`, which must hold all work
  /// of the planner: where refusing paths costs more than finding them, verification comes first.
  [[nodiscard]] int operator()(Path& path, CheckCounters& counters);

  /// Returns true once at least 3 paths were refused: the planner should then check motions as
  /// verification does.
  [[nodiscard]] bool has_refused_often() const { return refused_count_ >= kOften; }
  /// The check that every motion of a path must pass.
  [[nodiscard]] const MotionVerifier& verifier() const { return verifier_; }
  /// Returns the number of refused paths as the end of a message; empty if there are none.
  [[nodiscard]] std::string describe_refused() const;
  [[nodiscard]] double simplification_time_s() const { return simplification_time_s_; }
  [[nodiscard]] double verification_time_s() const { return verification_time_s_; }

 private:
  static constexpr int kOften = 3;

  [[nodiscard]] int finish(Path& path, bool is_verified_first, CheckCounters& counters);
  [[nodiscard]] Path shorten(Path path, int patience, const MotionVerifier* verifier,
                             CheckCounters& counters);
  [[nodiscard]] int verify_or_mend(Path& path, CheckCounters& counters);
  [[nodiscard]] int mend(Path& path, int invalid, CheckCounters& counters);
  [[nodiscard]] bool must_stop_at(double end_s) const;

  const CollisionChecker& checker_;
  FinishSettings settings_;
  Stopwatch stopwatch_;
  MotionVerifier verifier_;
  bool is_coarse_;  ///< while shortening
  int refused_count_ = 0;
  std::uint64_t states_ = 0;  ///< checked so far
  double simplification_time_s_ = 0;
  double verification_time_s_ = 0;
};

}  // namespace mneme
