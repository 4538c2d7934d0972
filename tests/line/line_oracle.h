// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Independent checks of lines: an exhaustive layered search, and the deviation at many states.
#pragma once

#include "mneme/goal.h"
#include "mneme/line.h"

#include "line/line_segment.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {

/// The pose of the link at a share of the line, in the root link's frame.
inline Transform line_pose(const LineResult& result, double fraction) {
  return internal::LineSegment(result.begin, result.end).at(fraction);
}

inline double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return 2 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0)));
}

struct LineDeviation {
  double position = 0, rotation = 0;
};

/// The largest deviation at `per_motion` states of each motion, by Robot::link_poses(). With a free
/// axis the rotation is the angle between the directions of this axis.
inline LineDeviation measure_deviation(const Robot& robot, const std::string& link,
                                       const LineResult& result, int per_motion,
                                       std::optional<Axis> free_axis = {}) {
  const auto index = static_cast<std::size_t>(*robot.find_link(link));
  LineDeviation worst;
  const LinePath& line = result.line;
  for (std::size_t i = 1; i < line.path.size(); ++i) {
    const Configuration delta = robot.difference(line.path[i - 1], line.path[i]);
    for (int k = 0; k <= per_motion; ++k) {
      const double t = static_cast<double>(k) / per_motion;
      Configuration q = line.path[i - 1];
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += t * delta[j];
      const Transform pose = robot.link_poses(q)[index];
      const double s = line.fractions[i - 1] + t * (line.fractions[i] - line.fractions[i - 1]);
      const Transform wanted = line_pose(result, s);
      worst.position = std::max(worst.position, (pose.translation - wanted.translation).norm());
      const int column = free_axis ? static_cast<int>(*free_axis) : 0;
      const double angle =
          free_axis ? std::acos(std::clamp(
                          pose.rotation.col(column).dot(wanted.rotation.col(column)), -1.0, 1.0))
                    : angle_between(pose.rotation, wanted.rotation);
      worst.rotation = std::max(worst.rotation, angle);
    }
  }
  return worst;
}

/// An exhaustive search over all branches, layer by layer, scalar and in double precision. Each
/// layer holds configurations that cover what is reachable on the self-motion, no two of them in
/// one cell.
class LineOracle {
 public:
  /// `step`: metres between layers. `cell`: radians.
  LineOracle(const CollisionChecker& checker, const std::string& link, double step, double cell)
      : checker_(checker),
        robot_(checker.robot()),
        link_(static_cast<std::size_t>(*robot_.find_link(link))),
        step_(step),
        cell_(cell) {}

  /// True if a configuration of the first layer leads to one of the last layer.
  [[nodiscard]] bool is_possible(const LineResult& line, std::vector<Configuration> layer) const {
    const double length = (line.end.translation - line.begin.translation).norm();
    const int layers = std::max(1, static_cast<int>(std::ceil(length / step_)));
    for (int k = 1; k <= layers && !layer.empty(); ++k) {
      layer = advance(layer, line_pose(line, static_cast<double>(k) / layers));
    }
    return !layer.empty();
  }

 private:
  using Vector = Eigen::VectorXd;

  [[nodiscard]] std::vector<Configuration> advance(const std::vector<Configuration>& layer,
                                                   const Transform& pose) const {
    std::set<std::vector<int>> cells;
    std::vector<Configuration> next;
    for (const Configuration& q : layer) {
      const Eigen::MatrixXd jacobian = slopes(q);
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
      const Eigen::MatrixXd free = svd.matrixV().rightCols(jacobian.cols() - 6);
      const Eigen::MatrixXd solver = jacobian.completeOrthogonalDecomposition().pseudoInverse();
      for (const Vector& change : changes(free.cols())) {
        Configuration moved = q;
        const Vector motion = free * change;
        for (std::size_t j = 0; j < q.size(); ++j) moved[j] += motion[static_cast<int>(j)];
        if (!settle(moved, pose, solver) || robot_.distance(q, moved) > 6 * cell_ + 0.1) continue;
        if (!cells.insert(cell_of(moved)).second || !is_clear(q, moved)) continue;
        next.push_back(std::move(moved));
      }
    }
    return next;
  }

  /// All vectors with elements of -1.5, 0 and 1.5 cells.
  [[nodiscard]] std::vector<Vector> changes(Eigen::Index dimension) const {
    std::vector<Vector> all = {Vector::Zero(dimension)};
    for (Eigen::Index i = 0; i < dimension; ++i) {
      const std::size_t count = all.size();
      for (std::size_t k = 0; k < count; ++k) {
        for (const double by : {-1.5 * cell_, 1.5 * cell_}) {
          all.push_back(all[k]);
          all.back()[i] = by;
        }
      }
    }
    return all;
  }

  [[nodiscard]] std::vector<int> cell_of(const Configuration& q) const {
    std::vector<int> cell;
    for (const double value : robot_.normalized(q)) {
      cell.push_back(static_cast<int>(std::floor(value / cell_)));
    }
    return cell;
  }

  /// Jacobian of the link by differences.
  [[nodiscard]] Eigen::MatrixXd slopes(const Configuration& q) const {
    constexpr double kBy = 1e-6;
    Eigen::MatrixXd jacobian(6, static_cast<Eigen::Index>(q.size()));
    for (std::size_t j = 0; j < q.size(); ++j) {
      Configuration up = q, down = q;
      up[j] += kBy;
      down[j] -= kBy;
      jacobian.col(static_cast<Eigen::Index>(j)) =
          error(robot_.link_poses(down)[link_], robot_.link_poses(up)[link_]) / (2 * kBy);
    }
    return jacobian;
  }

  static Vector error(const Transform& from, const Transform& to) {
    Vector twist(6);
    twist.head<3>() = to.translation - from.translation;
    const Eigen::AngleAxisd turn(to.rotation * from.rotation.transpose());
    twist.tail<3>() = turn.angle() * turn.axis();
    return twist;
  }

  bool settle(Configuration& q, const Transform& pose, const Eigen::MatrixXd& solver) const {
    for (int i = 0; i < 20; ++i) {
      const Vector off = error(robot_.link_poses(q)[link_], pose);
      if (off.norm() < 1e-6) return !robot_.describe_violation(q, "state");
      if (!(off.norm() < 1)) return false;
      const Vector by = solver * off;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += by[static_cast<Eigen::Index>(j)];
    }
    return false;
  }

  [[nodiscard]] bool is_clear(const Configuration& from, const Configuration& to) const {
    return checker_.is_motion_valid(std::span<const double>(from), std::span<const double>(to),
                                    {4, kVerificationMargin});
  }

  const CollisionChecker& checker_;
  const Robot& robot_;
  std::size_t link_;
  double step_, cell_;
};

}  // namespace mneme::test
