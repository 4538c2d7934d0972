// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths: their length, shortening and verification.
#pragma once

#include "mneme/base.h"
#include "mneme/collision.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme {
namespace internal {
class Sweep;
}

/// A sequence of configurations joined by straight motions; continuous joints lie in [-pi, pi) and
/// take the shorter way round between neighbours.
using Path = std::vector<Configuration>;

/// Length of a path: the sum of L2 joint distances, radians.
[[nodiscard]] double path_length(const Robot& robot, const Path& path);

/// What the motions of a path must pass before it is returned.
enum class Verification {
  none,
  states,   ///< states at kVerificationRefinement times the resolution; of planar arms, `motions`
  motions,  ///< the same and all that lies between the states, by conservative bounds on how fast
            ///< links approach obstacles and each other (docs/numerics.md)
};

/// A margin of kVerificationMargin lets a path survive a check at other states of the same density,
/// too; only the first and the last motion do without it if their ends lie closer to contact.
inline constexpr double kVerificationMargin = 1e-4;  ///< metres
inline constexpr double kVerificationRefinement = 10;

/// The check of motions of a final path. Const and parallel-safe, if `must_stop` is.
class MotionVerifier {
 public:
  /// Refers to the checker. With Verification::none every motion passes. `must_stop`, which may be
  /// empty, ends the check of what lies between states, which can take long where a link grazes an
  /// obstacle.
  explicit MotionVerifier(const CollisionChecker& checker,
                          Verification verification = Verification::states,
                          std::function<bool()> must_stop = {});

  /// True if the motion passes the verification. `is_at_end`: it touches the start or the goal of
  /// its path, which may lie closer to contact than kVerificationMargin: then it needs no margin.
  /// A motion that turns a continuous joint by half a turn does not pass: rounding would decide
  /// which way round whoever follows the path goes.
  [[nodiscard]] bool is_free(std::span<const float> from, std::span<const float> to, bool is_at_end,
                             CheckCounters& counters) const;

  /// The same of a curve inside of a path, given as states on it, row by row, of which neighbours
  /// are at most step() apart. It needs the margin everywhere.
  [[nodiscard]] bool is_curve_free(std::span<const float> states, CheckCounters& counters) const;
  /// L2 joint distance between two states that are checked, at most.
  [[nodiscard]] double step() const { return checker_.resolution() / kVerificationRefinement; }

  /// The first motion of `path` that does not pass, or -1.
  [[nodiscard]] int find_invalid_motion(const Path& path, CheckCounters& counters) const;

 private:
  [[nodiscard]] bool is_free(std::span<const double> from, std::span<const double> to,
                             bool is_at_end, CheckCounters& counters) const;
  [[nodiscard]] bool has_one_way(std::span<const double> from, std::span<const double> to) const;
  [[nodiscard]] bool are_states_free(std::span<const double> from, std::span<const double> to,
                                     bool is_at_end, CheckCounters& counters) const;

  const CollisionChecker& checker_;
  Verification verification_;
  std::shared_ptr<const internal::Sweep> sweep_;  ///< null if states are enough
  std::function<bool()> must_stop_;
};

/// MotionVerifier::find_invalid_motion for one path.
[[nodiscard]] int find_invalid_motion(const CollisionChecker& checker, const Path& path,
                                      CheckCounters& counters,
                                      Verification verification = Verification::states);

/// How much shortening may cost.
struct ShortcutEffort {
  int attempts = 100;
  int patience = 100;    ///< so many attempts in vain, one after the other, end it
  float least_gain = 0;  ///< of the path's length; motions that gain less are not looked at
};

/// Shortens `path` by replacing stretches between random points of it with straight free motions
/// (Geraerts and Overmars, DOI 10.1177/0278364907079280). Keeps both ends. The new motions pass
/// `verifier`, unless that is null. Leaves the rest undone once `must_stop`, which may be empty,
/// says so; it is asked before each motion.
void shortcut(const CollisionChecker& checker, Path& path, std::uint64_t seed,
              const ShortcutEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
              const std::function<bool()>& must_stop = {});

/// What a path must become and pass before it is returned.
struct FinishSettings {
  bool simplify = true;
  Verification verification = Verification::states;
  std::uint64_t seed = 1;
  double timeout_s = 10;  ///< from construction; half of what is left of it is for shortening
  const std::atomic<bool>* cancel = nullptr;  ///< may be null
};

/// Shortens and verifies what a planner has found: the planner offers paths, and goes on planning
/// if one is refused. Not thread-safe.
class PathFinisher {
 public:
  /// Refers to the checker.
  PathFinisher(const CollisionChecker& checker, const FinishSettings& settings);
  PathFinisher(const PathFinisher&) = delete;
  PathFinisher& operator=(const PathFinisher&) = delete;

  /// Shortens and verifies `path`: -1, or the number of the first motion of the path as it was
  /// given that fails; then the path is unchanged. Work is added to `counters`; the more motions
  /// planning has checked until now, the longer shortening goes on.
  [[nodiscard]] int operator()(Path& path, CheckCounters& counters);

  /// Every motion of a path passes it.
  [[nodiscard]] const MotionVerifier& verifier();
  /// How the message of a plan without path ends: how many paths were refused, if any.
  [[nodiscard]] std::string describe_refused() const;
  [[nodiscard]] double simplification_time_s() const { return simplification_time_s_; }
  [[nodiscard]] double verification_time_s() const { return verification_time_s_; }

 private:
  [[nodiscard]] Path shorten(Path path, const MotionVerifier* verifier, CheckCounters& counters);
  [[nodiscard]] int verify(const Path& path, CheckCounters& counters);
  [[nodiscard]] bool is_over(double end_s) const;

  const CollisionChecker& checker_;
  FinishSettings settings_;
  Stopwatch stopwatch_;
  std::optional<MotionVerifier> verifier_;  ///< made when it is first wanted
  int refused_count_ = 0;
  double simplification_time_s_ = 0;
  double verification_time_s_ = 0;
};

}  // namespace mneme
