// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths in time: limits of velocity and acceleration, rounded corners, the fastest way along a
/// path, and files for those who execute it.
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
  std::optional<double> jerk_limit;
  double path_tolerance = 0.1;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, TrajectorySettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("dt", s.dt, 1e-4, 1e4,
        "Time between two written points of a trajectory, seconds. The last step may be shorter.");
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
        "Largest L2 joint distance between a trajectory and its path where corners are rounded. "
        "Larger is faster; at 0 a trajectory stops at each corner.");
}

/// What the joints of a planning group may do, in the order of a configuration; all above 0, and
/// finite but for those of jerk.
struct RateLimits {
  std::vector<double> velocity;      ///< rad/s, or m/s of prismatic joints
  std::vector<double> acceleration;  ///< rad/s^2 or m/s^2
  std::vector<double> jerk = {};  ///< rad/s^3 or m/s^3; infinite for a joint without; empty: none
};

/// The limits of the robot's URDF, those of `file` before them unless that is empty, and
/// `acceleration_limit` and `jerk_limit` of joints without one; velocity and acceleration scaled.
/// Joints that follow one of the group slow it
/// down if they must. `file` is YAML as MoveIt's joint_limits.yaml (docs/trajectories.md). Errors:
/// a file that cannot be read exactly; a joint of the group that may not move at all; settings out
/// of range.
[[nodiscard]] Result<RateLimits> find_rate_limits(const Robot& robot,
                                                  const TrajectorySettings& settings = {},
                                                  const std::string& file = "");

/// A motion from rest to rest. Velocities are continuous, accelerations only where jerk is limited.
/// Limits hold at every time, not only where the trajectory is sampled. Const and parallel-safe.
class Trajectory {
 public:
  /// Continuous joints do not wrap: they may leave [-pi, pi), so that nothing jumps.
  struct Point {
    double time_s = 0;
    Configuration position;
    std::vector<double> velocity;      ///< rad/s or m/s
    std::vector<double> acceleration;  ///< rad/s^2 or m/s^2; from this time on
  };
  /// A stretch of constant path acceleration: position = begin + direction s + bend s^2 / 2, with
  /// s = speed t + acceleration t^2 / 2, t from the stretch's begin.
  struct Stretch {
    double begin_s = 0;
    double speed = 0, acceleration = 0;
    Configuration begin;
    std::vector<double> direction;
    std::vector<double> bend;  ///< empty where the path is straight
  };

  /// `stretches` in order of time; `end` is where they come to rest at `end_s`. The motion is their
  /// average over the last `window_s` seconds: then it takes as much longer, keeps what limits of
  /// velocity and acceleration they keep, and its jerk is at most 2 / `window_s` times their
  /// greatest acceleration.
  Trajectory(std::vector<Stretch> stretches, Configuration end, double end_s, double window_s = 0);

  [[nodiscard]] double duration_s() const { return end_s_ + window_s_; }
  /// Before 0 and from the duration on it is at rest.
  [[nodiscard]] Point at(double time_s) const;
  /// Points `dt` seconds apart from 0 on, and the end. Errors: `dt` that is not above 0 or asks for
  /// more than ten million points.
  [[nodiscard]] Result<std::vector<Point>> sample(double dt) const;

 private:
  /// The point on the stretches, before averaging.
  [[nodiscard]] Point follow(double time_s) const;
  /// The integral of their positions, less those of the end, from 0 on.
  [[nodiscard]] std::vector<double> integral(double time_s) const;

  std::vector<Stretch> stretches_;
  std::vector<std::vector<double>> integrals_;  ///< at the stretches' begins, if there is a window
  Configuration end_;
  double end_s_;
  double window_s_;
};

/// The time-optimal motion along `path` with its corners rounded by parabolas that pass `verifier`
/// and stay within the path's tolerance; at a corner that cannot be rounded it stops. Without a
/// verifier (null) it stops at every corner. Time-optimal up to the grid on corners, after
/// reachability analysis (Pham and Pham, DOI 10.1109/TRO.2018.2819195); with limits of jerk the
/// average of such a motion, which passes the verifier and stays within the tolerance, too. Of
/// `settings` only the
/// path's tolerance counts: `limits` are scaled already. Errors: an empty path; a configuration
/// that is none of the robot; limits that are not as RateLimits says; settings out of range.
[[nodiscard]] Result<Trajectory> parameterize(const Robot& robot, const Path& path,
                                              const RateLimits& limits,
                                              const TrajectorySettings& settings,
                                              const MotionVerifier* verifier);

/// A header of names and a row per point: time, then positions, velocities and accelerations of
/// all joints of the group.
[[nodiscard]] std::string to_csv(const Robot& robot, std::span<const Trajectory::Point> points);
/// YAML in the shape of trajectory_msgs/JointTrajectory.
[[nodiscard]] std::string to_yaml(const Robot& robot, std::span<const Trajectory::Point> points);
/// JSON (docs/schema/trajectory.schema.json).
[[nodiscard]] std::string to_json(const Robot& robot, std::span<const Trajectory::Point> points);

}  // namespace mneme
