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
#include <span>
#include <string>
#include <vector>

namespace mneme {
/// Configurations joined by straight motions. Continuous joints take the shorter direction between
/// neighbours.
using Path = std::vector<Configuration>;

/// Returns `path` with continuous joints shifted by whole turns: the first waypoint to the turn of
/// `start`, each other one to where it is nearest to the waypoint before. Linear interpolation
/// between waypoints then gives the path's motions.
[[nodiscard]] Path unwrapped(const Robot& robot, Path path, const Configuration& start);

/// Returns the sum of L2 joint distances, radians; a metre of a prismatic joint counts as a radian.
[[nodiscard]] double path_length(const Robot& robot, const Path& path);

/// Rate limits of the joints of a planning group, in the order of a configuration. All are above 0;
/// velocity and acceleration are finite.
struct RateLimits {
  std::vector<double> velocity;      ///< rad/s, or m/s for prismatic joints
  std::vector<double> acceleration;  ///< rad/s^2 or m/s^2
  std::vector<double> jerk = {};     ///< rad/s^3 or m/s^3; infinite: no limit; empty: none has one
  std::vector<std::string> warnings = {};  ///< Keys and joints of the file that were ignored.
};

/// Returns about the seconds that `path` takes without stopping at waypoints: the sum of
/// MotionCost. A straight motion of one joint takes exactly as long. A joint weighs by how far it
/// could go from rest to rest in the time of the straight motion between both ends of the path.
/// Null `limits`: the velocity limits of the URDF, and no others.
[[nodiscard]] double path_time(const Robot& robot, const Path& path,
                               const RateLimits* limits = nullptr);

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

  /// Returns true if the motion passes the verification. Rejects motions that turn a continuous
  /// joint by pi: rounding would choose the direction. If `are_links_apart`, Verification::motions
  /// does not check links against each other.
  [[nodiscard]] bool is_free(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends, CheckCounters& counters,
                             bool are_links_apart = false) const;
  /// Returns true if the motions between consecutive rows of `states` pass the verification; `ends`
  /// are those of the first and the last motion. Faster than is_free() where motions are short;
  /// near an end in contact it may refuse what is_free() takes.
  [[nodiscard]] bool are_free(std::span<const float> states, MotionEnds ends,
                              CheckCounters& counters) const;

  /// Returns true if a curve that replaces a part of a path, without its ends, passes the
  /// verification. `states` are points on the curve, row by row. `bow` bounds, per joint, how far
  /// the curve is from the straight motion between two points, and increases the required margin.
  [[nodiscard]] bool is_curve_free(std::span<const float> states, std::span<const float> bow,
                                   CheckCounters& counters) const;

  [[nodiscard]] const CollisionChecker& checker() const { return checker_; }
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
  /// Shortening ends after this number of consecutive checks, of 16 states each, without a gain,
  /// and after fewer if the path is little longer than straight. 0: only drops waypoints.
  double patience = 28;
  double least_gain = 0.007;   ///< smallest gain that counts, as a share of the path's length
  double refinement = 1;       ///< MotionDetail::refinement of new motions
  double margin = 1e-3;        ///< metres that new motions keep from contact, if the path's ends do
  bool minimize_time = false;  ///< of path_time(), instead of path_length()
  const RateLimits* limits = nullptr;  ///< for path_time()
};

/// Shortens `path`, or its time: drops waypoints, then relaxes them and straightens random joints,
/// or all, over random stretches. Keeps both ends. New motions keep the effort's margin from
/// contact, or the distance of the nearer end of the path if that is less. They pass `verifier`
/// unless it is null. Stops once `must_stop`, called before each step, returns true; `must_stop`
/// may be empty. After Geraerts and Overmars, DOI 10.1177/0278364907079280.
void shorten(const CollisionChecker& checker, Path& path, std::uint64_t seed,
             const ShortenEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
             const std::function<bool()>& must_stop = {});

/// Settings for shortening and verifying a path before it is returned.
struct FinishSettings {
  bool simplify = true;
  Verification verification = Verification::motions;
  std::uint64_t seed = 1;
  double timeout_s = 10;  ///< from construction on; shortening takes at most half of the remaining
                          ///< time
  const std::atomic<bool>* cancel = nullptr;           ///< may be null
  int patience = 28;                                   ///< ShortenEffort::patience
  bool minimize_time = false;                          ///< ShortenEffort::minimize_time
  std::shared_ptr<const RateLimits> limits = nullptr;  ///< ShortenEffort::limits
};

/// Shortens and verifies paths that a planner offers. The planner continues if a path is refused. A
/// motion that fails verification is repaired by a nearby waypoint if one is found. Results depend
/// on time only through the timeout. Not thread-safe.
class PathFinisher {
 public:
  /// Refers to the checker.
  PathFinisher(const CollisionChecker& checker, const FinishSettings& settings);
  PathFinisher(const PathFinisher&) = delete;
  PathFinisher& operator=(const PathFinisher&) = delete;

  /// Shortens and verifies `path`. Returns -1 if the path passes. Otherwise returns the index of
  /// its first motion that fails, and does not change the path. Adds its work to `counters`, which
  /// must hold all work of the planner: if refusing paths costs more than finding them, paths are
  /// verified before they are shortened.
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
