// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths as rows of single precision.
#pragma once

#include "mneme/path.h"

#include "robot/joint_space.h"

#include <span>
#include <vector>

namespace mneme::internal {

[[nodiscard]] std::vector<float> to_floats(std::span<const double> q);
/// Returns `q` within the limits: many turns of a continuous joint would lose digits.
[[nodiscard]] std::vector<float> to_floats(const Robot& robot, const Configuration& q);
[[nodiscard]] std::vector<float> to_rows(const Path& path);
/// Converts rows to a path. Moves values that rounding to floats moved out of the limits back into
/// them.
[[nodiscard]] Path to_path(const Robot& robot, const std::vector<std::vector<float>>& path);

/// Returns MotionCost::pace of path_time().
[[nodiscard]] std::vector<float> paces_of(const Robot& robot, const Path& path,
                                          const RateLimits* limits);

/// Waypoints row by row. Continuous joints are unwrapped, so that linear interpolation gives the
/// motion between neighbours. Radians, metres for prismatic joints.
class Waypoints {
 public:
  /// Arc lengths are L2 joint distances or, with a `pace`, estimates of time: see MotionCost.
  explicit Waypoints(const Robot& robot, std::vector<float> pace = {});

  void assign(std::vector<float> rows);
  /// Replaces the waypoints after `first` and before `last` by `rows`.
  void replace(int first, int last, std::span<const float> rows);

  [[nodiscard]] const JointSpace& space() const { return space_; }
  [[nodiscard]] int joint_count() const { return space_.joint_count(); }
  [[nodiscard]] int count() const { return static_cast<int>(rows_.size()) / joint_count(); }
  [[nodiscard]] const float* operator[](int i) const { return rows_.data() + i * joint_count(); }
  [[nodiscard]] std::span<const float> rows(int first, int last) const {
    return {(*this)[first], static_cast<std::size_t>((last - first) * joint_count())};
  }
  [[nodiscard]] PathView view() const { return {rows_, arc_lengths_, directions_, {pace_}}; }
  /// Length of the whole path.
  [[nodiscard]] float length() const { return arc_lengths_.back(); }
  /// Arc length from the start to waypoint `i`.
  [[nodiscard]] float arc_length(int i) const { return arc_lengths_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] PathPoint locate(float s) const;  ///< at arc length `s`
  void write(const PathPoint& point, float* q) const;

  [[nodiscard]] float distance(const float* a, const float* b) const;
  /// Returns false if a continuous joint turns by more than pi, or nearly pi.
  [[nodiscard]] bool has_unique_direction(const float* from, const float* to) const;

 private:
  void measure();

  JointSpace space_;
  bool has_turns_;           ///< a joint is continuous
  std::vector<float> pace_;  ///< MotionCost::pace
  std::vector<float> rows_;
  std::vector<float> arc_lengths_;  ///< per waypoint
  std::vector<float> directions_;   ///< row by row, of the motion that begins there
};

}  // namespace mneme::internal
