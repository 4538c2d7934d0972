// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Trajectories: rate limits, rounded corners, time-optimal motion along a path, and trajectory
/// files.
#pragma once

#include "mneme/base.h"
#include "mneme/path.h"
#include "mneme/robot.h"

#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace mneme {

struct TrajectorySettings {
  double dt = 0.01;
  double velocity_scale = 1;
  double acceleration_scale = 1;
  double acceleration_limit = 1;
  std::optional<double> jerk_limit = {};
  double path_tolerance = 1;
  int time_rounds = 8;
  double blend_tolerance = 0.2;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, TrajectorySettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("dt", s.dt, 1e-4, 1e4,
        "Time between two written points of a trajectory, seconds. The last step takes half to one "
        "and a half of this time.");
  visit("velocity-scale", s.velocity_scale, 0.001, 1.0,
        "Fraction of the velocity limits that a trajectory may use.");
  visit("acceleration-scale", s.acceleration_scale, 0.001, 1.0,
        "Fraction of the acceleration limits that a trajectory may use.");
  visit("acceleration-limit", s.acceleration_limit, 0.001, 1e6,
        "Acceleration limit, rad/s^2 (m/s^2 for prismatic joints), of joints without one in the "
        "URDF or a file of limits.");
  visit("jerk-limit", s.jerk_limit, 0.001, 1e6,
        "Jerk limit, rad/s^3 (m/s^3 for prismatic joints), of joints without one in a file of "
        "limits. Default: none, accelerations jump.");
  visit("path-tolerance", s.path_tolerance, 0.0, 10.0,
        "Largest L2 joint distance between a trajectory and its path. Larger is faster; at 0 a "
        "trajectory stops at each corner.");
  visit("time-rounds", s.time_rounds, 0, 1000,
        "Rounds in which a trajectory becomes faster by leaving its path, within path-tolerance "
        "and as far as it is proven free. More is faster and takes longer to compute. At 0 it "
        "leaves the path at corners only.");
  visit("blend-tolerance", s.blend_tolerance, 0.0, 10.0,
        "Largest L2 joint distance from where two stages of a task join at which their motions may "
        "blend. Larger is faster; at 0 the robot stops there.");
}

/// Returns the robot with its joints' limits of position narrowed to min_position and max_position
/// of `file`, as of find_rate_limits(); the robot itself if none is narrower. Limits of a joint
/// that follows another narrow that one; continuous joints keep theirs. Plan with this robot: its
/// hashes differ. Errors: a file that cannot be read; invalid, if a joint is left without
/// positions.
[[nodiscard]] Result<Robot> narrow_positions(const Robot& robot, const std::string& file);

/// Returns the limits of `file` where it has them, otherwise those of the robot's URDF, otherwise
/// those of the settings; velocity and acceleration are scaled. Joints that follow one of the group
/// may lower its limits. `file`: YAML as MoveIt's joint_limits.yaml; empty: none. A deceleration
/// limit also bounds the acceleration. Other keys and joints, and limits of position that the
/// robot's own exceed (see narrow_positions()), are ignored with a warning, or refused if `strict`.
/// Errors: a file that cannot be read; a joint of the group that cannot move; settings out of
/// range.
[[nodiscard]] Result<RateLimits> find_rate_limits(const Robot& robot,
                                                  const TrajectorySettings& settings = {},
                                                  const std::string& file = "",
                                                  bool strict = false);

/// A motion. Velocity is continuous; so is acceleration if jerk is limited. Limits hold at every
/// time, not only at sampled points. Const and parallel-safe.
class Trajectory {
 public:
  /// Continuous joints do not wrap: they may leave [-pi, pi), so that nothing jumps.
  struct Point {
    double time_s = 0;
    Configuration position;
    std::vector<double> velocity;      ///< rad/s or m/s
    std::vector<double> acceleration;  ///< rad/s^2 or m/s^2; at a jump, the value after the jump
  };
  /// A polynomial in the time t since it began, up to the next stretch: the position of joint j of
  /// n is the sum of coefficients[k n + j] t^k.
  struct Stretch {
    double begin_s = 0;
    std::vector<double> coefficients;
  };

  /// Takes stretches in order of time that reach `end` after `end_s` seconds, with `end_velocity`
  /// (empty: at rest).
  Trajectory(std::vector<Stretch> stretches, Configuration end, double end_s,
             std::vector<double> end_velocity = {});

  /// Returns the duration, rounded up to a multiple of 1 ns.
  [[nodiscard]] double duration_s() const;
  /// Returns the state at any time; at rest before 0 and after the duration.
  [[nodiscard]] Point at(double time_s) const;
  /// Returns the motion between two times, seconds, which it mostly begins and ends moving.
  [[nodiscard]] Trajectory between(double from_s, double to_s) const;
  /// Returns points `dt` seconds apart from 0 on, and the end. The last step takes dt/2 to 3/2 dt,
  /// or the whole duration if that is less. Errors: `dt` is not above 0, or gives more than ten
  /// million points.
  [[nodiscard]] Result<std::vector<Point>> sample(double dt) const;
  /// Returns the motion of one joint, by its index.
  [[nodiscard]] Trajectory of_joint(std::size_t joint) const;
  /// Adds `offset` to all positions, such as whole turns of continuous joints.
  void shift(const Configuration& offset);
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }

 private:
  std::vector<Stretch> stretches_;
  Configuration end_;
  double end_s_;
  std::vector<double> end_velocity_;
};

/// Measures of a motion. Jerk is that within stretches: jumps of acceleration do not count.
struct MotionMeasures {
  double duration_s = 0;
  double jerk_integral = 0;  ///< of the squared L2 norm over time, rad^2/s^5
  /// Greatest values of each joint, rad/s, rad/s^2 and rad/s^3 (metres for prismatic joints).
  std::vector<double> velocity = {}, acceleration = {}, jerk = {};
  /// Shares of the limits, 0 to 1, that these are; 0 where a joint has no limit.
  std::vector<double> velocity_use = {}, acceleration_use = {}, jerk_use = {};
};
/// Returns exact integrals, and greatest values at 9 times of each stretch.
[[nodiscard]] MotionMeasures measure_motion(const Trajectory& motion, const RateLimits& limits);

/// Returns about the duration that parameterize() reaches: that of the motion along `path` whose
/// corners are as fast as `limits` allow. With a `verifier`, states on corners are checked, and
/// corners in contact are slower. Cost: some 10 us, and less than 100 us with a verifier.
[[nodiscard]] double estimate_duration(const Robot& robot, const Path& path,
                                       const RateLimits& limits,
                                       const MotionVerifier* verifier = nullptr);

/// A stop that is shorter, L2 joint distance, counts as none: the robot is at rest.
inline constexpr double kLeastStop = 2e-6;
/// Returns where a robot comes to rest that stops from `velocity` at `start` (a value per joint)
/// as fast as possible without leaving the straight line; `start` if that is nearer than
/// kLeastStop. Errors: another number of values than joints. Naming the joint: a velocity above
/// its limit; a joint that would leave its range; a continuous joint that would turn by pi or more,
/// so that the path would turn it the other way.
[[nodiscard]] Result<Configuration> stopping_point(const Robot& robot, const Configuration& start,
                                                   const std::vector<double>& velocity,
                                                   const RateLimits& limits);

/// Returns where a run-up to `velocity` at `goal` begins, at rest: the stopping point of the motion
/// back in time. Errors: as stopping_point().
[[nodiscard]] Result<Configuration> run_up_point(const Robot& robot, const Configuration& goal,
                                                 const std::vector<double>& velocity,
                                                 const RateLimits& limits);

/// Returns a fast motion near `path`, within the path tolerance and `limits`, that passes
/// `verifier`. `time_rounds` rounds of a barrier method let it leave the path. If they find nothing
/// that passes, it follows the path: time-optimal from stop to stop, with corners as proven.
/// If `verifier` is null it stops at each waypoint. Uses only tolerance and rounds of `settings`:
/// `limits` are scaled already. Deterministic. Without jerk limits and rounds it is that of Pham
/// and Pham, DOI 10.1109/TRO.2018.2819195. `start_velocity` is along the path's first motion and
/// `end_velocity` along its last one, a value per joint each; empty: at rest. With one of them the
/// motion is the faster of two: the path followed from velocity to velocity, and stop and run-up
/// with the motion in between. Errors: an empty path; a waypoint that is no configuration of the
/// robot; `limits` or settings out of range; velocities that stopping_point() or run_up_point()
/// refuses, or for which the first or last motion is too short.
[[nodiscard]] Result<Trajectory> parameterize(const Robot& robot, const Path& path,
                                              const RateLimits& limits,
                                              const TrajectorySettings& settings,
                                              const MotionVerifier* verifier,
                                              const std::vector<double>& start_velocity = {},
                                              const std::vector<double>& end_velocity = {});

/// A motion to be joined with others, which have their own limits and obstacles.
struct MotionPart {
  Trajectory motion;  ///< to rest, from where the part before ends; only the first may begin moving
  RateLimits limits;
  const MotionVerifier* verifier = nullptr;  ///< null: no blends
  bool stops = false;                        ///< true: ends at rest, without a blend
};
/// Several motions in one.
struct JoinedMotion {
  Trajectory trajectory;
  std::vector<double> begins_s;  ///< of each part: when the one before stops, or the middle of the
                                 ///< blend with it
};
/// Returns the parts in one motion. It does not stop where two parts join if a faster blend is
/// found, from the last half of one part to the first half of the next. A blend stays within
/// `tolerance` (L2 joint distance) of where the parts join, passes both verifiers and keeps the
/// limits of both parts. Elsewhere the motion is that of the parts. Precondition: `parts` is not
/// empty. Cost: below 1 ms per blend.
[[nodiscard]] JoinedMotion join_motions(std::span<const MotionPart> parts, double tolerance);

/// Returns CSV: a header and a row per point with time, positions, velocities and accelerations.
[[nodiscard]] std::string to_csv(const Robot& robot, std::span<const Trajectory::Point> points);
/// Returns YAML in the shape of trajectory_msgs/JointTrajectory.
[[nodiscard]] std::string to_yaml(const Robot& robot, std::span<const Trajectory::Point> points);
/// Returns JSON (docs/schema/trajectory.schema.json).
[[nodiscard]] std::string to_json(const Robot& robot, std::span<const Trajectory::Point> points);

/// The motion of a joint outside of the planning group in a gripper stage of a task.
struct FingerMotion {
  std::string joint;
  Trajectory motion;  ///< of this joint, from 0 on
};
/// When a stage of a task begins.
struct StageBegin {
  std::string name;
  double begin_s = 0;
  std::vector<FingerMotion> fingers = {};
};
/// As to_csv() above, with three columns for each joint that gripper stages move, and a last column
/// `stage`: the name of the stage at each time. Without stages, the same text.
[[nodiscard]] std::string to_csv(const Robot& robot, std::span<const Trajectory::Point> points,
                                 std::span<const StageBegin> stages);
/// As to_yaml() above, with a comment line for each stage first. Names that are not printable ASCII
/// are quoted there as in JSON, with escapes.
[[nodiscard]] std::string to_yaml(const Robot& robot, std::span<const Trajectory::Point> points,
                                  std::span<const StageBegin> stages);
/// As to_json() above, with the list `stages` of names and begins.
[[nodiscard]] std::string to_json(const Robot& robot, std::span<const Trajectory::Point> points,
                                  std::span<const StageBegin> stages);

}  // namespace mneme
