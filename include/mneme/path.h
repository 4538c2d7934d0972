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
/// A sequence of configurations joined by straight motions; continuous joints lie in [-pi, pi) and
/// take the shorter way round between neighbours.
using Path = std::vector<Configuration>;

/// Length of a path: the sum of L2 joint distances, radians (metres of prismatic joints count as
/// such).
[[nodiscard]] double path_length(const Robot& robot, const Path& path);

/// The proof that the motions of a path must pass before it is returned.
enum class Verification {
  none,
  states,   ///< states at kVerificationRefinement times the resolution
  motions,  ///< all of the motion: CollisionChecker::is_sweep_valid
};

/// A margin of kVerificationMargin lets a path survive a check at other states, too, whoever makes
/// it. The path's own ends may lie closer to contact.
inline constexpr double kVerificationMargin = 1e-4;  ///< metres
inline constexpr double kVerificationRefinement = 10;

/// Which ends of its path a motion touches.
struct MotionEnds {
  bool is_first = false, is_last = false;
};

/// The check of motions of a final path. Const and parallel-safe.
class MotionVerifier {
 public:
  /// Refers to the checker. With Verification::none every motion passes.
  explicit MotionVerifier(const CollisionChecker& checker,
                          Verification verification = Verification::motions)
      : checker_(checker), verification_(verification) {}

  /// True if the motion passes the verification. One that turns a continuous joint by half a turn
  /// does not: rounding would decide which way round whoever follows the path goes. Where links are
  /// known to keep apart, Verification::motions does not look at them.
  [[nodiscard]] bool is_free(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends, CheckCounters& counters,
                             bool are_links_apart = false) const;

  /// The same of a curve inside of a path, given as states on it, row by row. Between two of them
  /// no joint is farther from the straight motion than `bow` says, which adds to the margin that
  /// it needs everywhere.
  [[nodiscard]] bool is_curve_free(std::span<const float> states, std::span<const float> bow,
                                   CheckCounters& counters) const;

  /// The first motion of `path` that does not pass, or -1.
  [[nodiscard]] int find_invalid_motion(const Path& path, CheckCounters& counters) const;

 private:
  [[nodiscard]] bool has_one_way(std::span<const float> from, std::span<const float> to) const;

  const CollisionChecker& checker_;
  Verification verification_;
};

/// MotionVerifier::find_invalid_motion for one path.
[[nodiscard]] int find_invalid_motion(const CollisionChecker& checker, const Path& path,
                                      CheckCounters& counters,
                                      Verification verification = Verification::motions);

/// How much shortening may cost.
struct ShortenEffort {
  /// Ends once so many vectors of 16 states were looked at in vain, one after the other; 0 only
  /// drops waypoints.
  double patience = 40;
  double least_gain = 0.007;  ///< of the path's length; less is in vain
};

/// Shortens `path`: drops waypoints, then relaxes them and lets random joints,
/// or all, go straight over random stretches (after Geraerts and Overmars,
/// DOI 10.1177/0278364907079280). Keeps both ends, and new motions 1 mm away from contact, less
/// where an end of the path is closer. They also pass `verifier`, unless that is null. Leaves the
/// rest undone once `must_stop`, which may be empty, says so; it is asked before each step.
void shorten(const CollisionChecker& checker, Path& path, std::uint64_t seed,
             const ShortenEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
             const std::function<bool()>& must_stop = {});

/// How a path is shortened and verified before it is returned.
struct FinishSettings {
  bool simplify = true;
  Verification verification = Verification::motions;
  std::uint64_t seed = 1;
  double timeout_s = 10;  ///< from construction; half of what is left of it is for shortening
  const std::atomic<bool>* cancel = nullptr;  ///< may be null
  int patience = 40;                          ///< ShortenEffort::patience
};

/// Shortens and verifies what a planner has found: the planner offers paths, and goes on planning
/// if one is refused. A motion that fails is led round what it touches, if a little way is enough.
/// The same work leads to the same answers, whatever the time it takes, but for the timeout. Not
/// thread-safe.
class PathFinisher {
 public:
  /// Refers to the checker.
  PathFinisher(const CollisionChecker& checker, const FinishSettings& settings);
  PathFinisher(const PathFinisher&) = delete;
  PathFinisher& operator=(const PathFinisher&) = delete;

  /// Shortens and verifies `path`: -1, or the number of the first motion of the path as it was
  /// given that fails; then the path is unchanged. Work is added to `counters`, which has all of
  /// planning's: a planner whose paths cost more to refuse than to find has them verified first.
  [[nodiscard]] int operator()(Path& path, CheckCounters& counters);

  /// True once so many paths were refused that the planner should check motions as verification
  /// does.
  [[nodiscard]] bool has_refused_often() const { return refused_count_ >= kOften; }
  /// Every motion of a path passes it.
  [[nodiscard]] const MotionVerifier& verifier() const { return verifier_; }
  /// How the message of a plan without path ends: how many paths were refused, if any.
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
  int refused_count_ = 0;
  std::uint64_t states_ = 0;  ///< looked at until now
  double simplification_time_s_ = 0;
  double verification_time_s_ = 0;
};

}  // namespace mneme
