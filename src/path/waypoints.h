// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths as rows of single precision, as planners and shortening have them.
#pragma once

#include "mneme/path.h"

#include "robot/joint_space.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mneme::internal {

[[nodiscard]] std::vector<float> to_floats(std::span<const double> q);
/// Row by row.
[[nodiscard]] std::vector<float> to_rows(const Path& path);
/// Within the limits, which floats may miss by rounding.
[[nodiscard]] Path to_path(const Robot& robot, const std::vector<std::vector<float>>& path);

/// A point of a path: `fraction` of the way along motion `motion`.
struct PathPoint {
  int motion = 0;
  float fraction = 0;
};

/// Waypoints row by row, continuous joints unwrapped: what is straight between neighbours is the
/// motion. Joints are in radians, prismatic ones in metres.
class Waypoints {
 public:
  explicit Waypoints(const Robot& robot);

  void assign(std::vector<float> rows);
  /// Puts `rows` in the place of the waypoints after `first` and before `last`.
  void replace(int first, int last, std::span<const float> rows);

  [[nodiscard]] const JointSpace& space() const { return space_; }
  [[nodiscard]] int joint_count() const { return space_.joint_count(); }
  [[nodiscard]] int count() const { return static_cast<int>(rows_.size()) / joint_count(); }
  [[nodiscard]] const float* operator[](int i) const { return rows_.data() + i * joint_count(); }
  [[nodiscard]] std::span<const float> rows(int first, int last) const {
    return {(*this)[first], static_cast<std::size_t>((last - first) * joint_count())};
  }
  /// Length of the whole path.
  [[nodiscard]] float length() const { return ways_.back(); }
  /// From the start to waypoint `i`.
  [[nodiscard]] float way_to(int i) const { return ways_[static_cast<std::size_t>(i)]; }
  /// The point that is `way` from the start.
  [[nodiscard]] PathPoint locate(float way) const;
  void write(const PathPoint& point, float* q) const;

  [[nodiscard]] float distance(const float* a, const float* b) const;
  /// False for a motion that is not the shorter way round, or close to it.
  [[nodiscard]] bool has_one_way(const float* from, const float* to) const;

 private:
  void measure();

  JointSpace space_;
  std::vector<float> rows_;
  std::vector<float> ways_;  ///< per waypoint
};

}  // namespace mneme::internal
