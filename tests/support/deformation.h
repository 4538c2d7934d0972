// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Deforms a path into another without contact: then both pass obstacles on the same side.
#pragma once

#include "mneme/collision.h"
#include "mneme/path.h"

#include "path/waypoints.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mneme::test {

/// Obstacles of the same names on their straight way from one scene to another, which differ in
/// places alone.
inline Scene scene_between(const Scene& from, const Scene& to, double share) {
  const auto place = [](const Obstacle& obstacle) {
    return bounding_sphere(obstacle.shapes.front()).center;
  };
  Scene scene = from;
  for (Obstacle& obstacle : scene.obstacles) {
    const Obstacle* other = to.find(obstacle.name);
    if (other == nullptr) continue;
    const Transform X{Eigen::Matrix3d::Identity(), share * (place(*other) - place(obstacle))};
    for (Shape& shape : obstacle.shapes) shape = transformed(X, shape);
  }
  return scene;
}

/// Looks for a sheet of free states from a path that is free in one scene to a path that is free in
/// another, while the obstacles go from there to here: row by row, each a little nearer to the
/// other path than the one before and pushed off what it touches. Rows and columns are joined by
/// motions that are free, and no longer than kLongestEdge: what such a cell encloses is taken to be
/// free. To find one proves that both paths are of one homotopy class, carried along with the
/// obstacles; to find none proves nothing.
class Deformation {
 public:
  Deformation(const Robot& robot, const Scene& from, const Scene& to)
      : robot_(robot),
        from_(from),
        to_(to),
        joints_(static_cast<std::size_t>(robot.joint_count())) {}

  bool find(const Path& from, const Path& to) {
    for (const int rows : {kFewestRows, 4 * kFewestRows}) {
      for (const Pace& pace : kPaces) {
        if (find({from_, from}, {to_, to}, rows, pace)) return true;
        if (find({to_, to}, {from_, from}, rows, pace)) return true;
      }
    }
    return false;
  }

 private:
  using Rows = std::vector<float>;
  /// A path and the scene that it is free in.
  struct Side {
    const Scene& scene;
    const Path& path;
  };
  /// When obstacles go and when the path does: shares of the rows.
  struct Pace {
    float scene_begin, scene_end, path_begin, path_end;
  };
  static constexpr Pace kPaces[] = {{0, 1, 0, 1}, {0, 0.5f, 0.5f, 1}, {0.5f, 1, 0, 0.5f}};
  static constexpr float kColumn = 0.02f, kRow = 0.05f, kLongestEdge = 0.2f;  ///< radians
  static constexpr int kFewestRows = 16, kPushes = 4;
  static constexpr float kClearance = 0.003f;  ///< metres

  bool find(const Side& from, const Side& to, int fewest_rows, const Pace& pace) {
    const internal::Waypoints first = unwrapped(from.path), last = unwrapped(to.path);
    const float length = std::max(first.length(), last.length());
    const int columns = static_cast<int>(length / kColumn) + 1;
    Rows row = spread(first, columns);
    Rows goal = spread(last, columns);
    const float farthest = align(row, goal);
    const int rows = std::max(fewest_rows, static_cast<int>(farthest / kRow) + 1);
    for (int left = rows; left > 0; --left) {
      const float done = static_cast<float>(rows - left + 1) / static_cast<float>(rows);
      const float share =
          std::clamp((done - pace.scene_begin) / (pace.scene_end - pace.scene_begin), 0.0f, 1.0f);
      const auto checker =
          CollisionChecker::make(robot_, scene_between(from.scene, to.scene, share));
      if (!checker) return false;
      // States that were pushed off have to come back, however late.
      const float path_left =
          std::max(static_cast<float>(left) - (1 - pace.path_end) * static_cast<float>(rows), 1.0f);
      const float step = done > pace.path_begin ? 1 / path_left : 0;
      Rows next = row;
      for (std::size_t i = 0; i < row.size(); ++i) next[i] += step * (goal[i] - row[i]);
      if (left > 1) push(*checker, next);
      if (!is_strip_free(*checker, row, next)) return false;
      row = std::move(next);
    }
    return true;
  }

  [[nodiscard]] internal::Waypoints unwrapped(const Path& path) const {
    Rows rows;
    for (const Configuration& q : path) rows.insert(rows.end(), q.begin(), q.end());
    internal::Waypoints way(robot_);
    way.assign(std::move(rows));
    return way;
  }

  [[nodiscard]] Rows spread(const internal::Waypoints& way, int columns) const {
    Rows rows(static_cast<std::size_t>(columns + 1) * joints_);
    for (int i = 0; i <= columns; ++i) {
      const float here = way.length() * static_cast<float>(i) / static_cast<float>(columns);
      way.write(way.locate(here), rows.data() + static_cast<std::size_t>(i) * joints_);
    }
    return rows;
  }

  /// Turns continuous joints of `rows` by whole turns, so that it begins as near to `goal` as can
  /// be; the farthest that a state is from its counterpart then.
  float align(Rows& rows, const Rows& goal) const {
    const internal::JointSpace space(robot_);
    for (std::size_t j = 0; j < joints_; ++j) {
      const float period = space.periods()[j];
      if (period == 0) continue;
      const float turn = period * std::nearbyint((goal[j] - rows[j]) / period);
      for (std::size_t i = j; i < rows.size(); i += joints_) rows[i] += turn;
    }
    float farthest = 0;
    for (std::size_t i = 0; i < rows.size(); i += joints_) {
      farthest = std::max(farthest, distance(&rows[i], &goal[i]));
    }
    return farthest;
  }

  [[nodiscard]] float distance(const float* a, const float* b) const {
    float sum = 0;
    for (std::size_t j = 0; j < joints_; ++j) sum += (b[j] - a[j]) * (b[j] - a[j]);
    return std::sqrt(sum);
  }

  /// Pushes states in contact away from what they touch, together with their neighbours.
  void push(const CollisionChecker& checker, Rows& row) const {
    const std::size_t count = row.size() / joints_;
    std::vector<std::uint8_t> is_free(count);
    const Rows still(joints_), jitter(3);
    WalkStep step;
    step.clearance = kClearance;
    step.drift = still;
    step.jitter = jitter;
    Rows pushed(joints_);
    CheckCounters counters;
    for (int i = 0; i < kPushes; ++i) {
      checker.check_states(row, is_free);
      if (std::ranges::count(is_free, 0) == 0) return;
      for (std::size_t k = 0; k < count; ++k) {
        if (is_free[k] != 0) continue;
        const std::span<float> q(row.data() + k * joints_, joints_);
        checker.walk(q, step, pushed, counters);
        move_near(q, pushed);
      }
    }
  }

  /// `q` becomes `pushed`, up to whole turns.
  void move_near(std::span<float> q, const Rows& pushed) const {
    const internal::JointSpace space(robot_);
    Rows delta(joints_);
    space.difference(q.data(), pushed.data(), delta.data());
    for (std::size_t j = 0; j < joints_; ++j) q[j] += delta[j];
  }

  [[nodiscard]] bool is_edge_free(const CollisionChecker& checker, const float* a,
                                  const float* b) const {
    CheckCounters ignored;
    return distance(a, b) <= kLongestEdge &&
           checker.is_motion_valid({a, joints_}, {b, joints_}, ignored);
  }

  [[nodiscard]] bool is_strip_free(const CollisionChecker& checker, const Rows& row,
                                   const Rows& next) const {
    for (std::size_t i = 0; i < row.size(); i += joints_) {
      if (!is_edge_free(checker, &row[i], &next[i])) return false;
      if (i > 0 && !is_edge_free(checker, &next[i - joints_], &next[i])) return false;
    }
    return true;
  }

  const Robot& robot_;
  const Scene &from_, &to_;
  std::size_t joints_;
};

}  // namespace mneme::test
