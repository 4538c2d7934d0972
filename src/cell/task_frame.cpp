// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/task_frame.h"

#include "base/as_index.h"
#include "base/fail.h"

#include <cmath>

namespace mneme {
namespace internal {
namespace {

/// Far less than the margin of proofs.
constexpr double kRounding = 1e-9;

}  // namespace

bool TaskBox::contains(const CellTask& task) const {
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    if (!(std::abs(task[k] - center[k]) <= half[k] + kRounding)) return false;
  }
  return true;
}

CellTask TaskBox::at(const std::vector<int>& varying, const double* u) const {
  CellTask task = center;
  for (const int k : varying) task[as_index(k)] += half[as_index(k)] * *u++;
  return task;
}

CellTask TaskBox::sample(const std::vector<int>& varying, Rng& rng, bool is_corner) const {
  std::array<double, kTaskSize> u;
  for (double& value : std::span(u).first(varying.size())) {
    const double share = rng.uniform(-1, 1);
    value = is_corner ? std::copysign(1.0, share) : share;
  }
  return at(varying, u.data());
}

std::array<double, kTaskSize> TaskBox::place_of(const std::vector<int>& varying,
                                                const CellTask& task) const {
  std::array<double, kTaskSize> u = {};
  std::size_t i = 0;
  for (const int k : varying)
    u[i++] = (task[as_index(k)] - center[as_index(k)]) / half[as_index(k)];
  return u;
}

TaskFrame::TaskFrame(const CellRegion& region)
    : half_extents_(region.half_extents),
      middle_(region.middle().pose),
      axes_(region.axes),
      from_pivot_(middle_.rotation * -region.pivot) {
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    if (half_extents_[k] > 0) varying_.push_back(static_cast<int>(k));
  }
}

Eigen::Matrix3d TaskFrame::turn_of(const CellTask& task) const {
  return rotation_about(axes_.col(2), task[kYaw]);
}

Transform TaskFrame::pose(const CellTask& task) const {
  const Eigen::Matrix3d turn = turn_of(task);
  const Vec3 pivot = middle_.translation - from_pivot_ + axes_ * Vec3(task[0], task[1], task[2]);
  return {turn * middle_.rotation, pivot + turn * from_pivot_};
}

Eigen::Matrix<double, 6, 1> TaskFrame::twist(const CellTask& task, int parameter) const {
  Eigen::Matrix<double, 6, 1> twist = Eigen::Matrix<double, 6, 1>::Zero();
  if (parameter == kYaw) {
    twist.head<3>() = axes_.col(2).cross(turn_of(task) * from_pivot_);
    twist.tail<3>() = axes_.col(2);
  } else {
    twist.head<3>() = axes_.col(parameter);
  }
  return twist;
}

double TaskFrame::displacement(const TaskBox& box, double away) const {
  return std::hypot(box.half[0], box.half[1], box.half[2]) + box.half[kYaw] * away;
}

double TaskFrame::distance2(const TaskBox& box, const CellTask& task) const {
  double sum = 0;
  for (const int k : varying_) {
    const auto at = as_index(k);
    const double off = std::abs(task[at] - box.center[at]);
    const double beyond = std::max(0.0, off - box.half[at]) / half_extents_[at];
    sum += beyond * beyond;
  }
  return sum;
}

double TaskFrame::share_of(const TaskBox& box) const {
  double share = 1;
  for (const int k : varying_) share *= box.half[as_index(k)] / half_extents_[as_index(k)];
  return share;
}

}  // namespace internal

Transform link_pose(const CellRegion& region, const CellTask& task) {
  return internal::TaskFrame(region).pose(task);
}

Result<CellTask> task_of(const CellRegion& region, const Transform& pose) {
  constexpr double kTolerance = 1e-6;
  const Transform& middle = region.middle().pose;
  const Eigen::AngleAxisd turn(pose.rotation * middle.rotation.transpose());
  CellTask task = {};
  task[internal::kYaw] = turn.angle() * turn.axis().dot(region.axes.col(2));
  const internal::TaskFrame frame(region);
  const Vec3 offset = region.axes.transpose() * (pose.translation - frame.pose(task).translation);
  for (Eigen::Index k = 0; k < 3; ++k) task[static_cast<std::size_t>(k)] = offset[k];
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    if (std::abs(task[k]) <= region.half_extents[k]) continue;
    if (!(std::abs(task[k]) <= region.half_extents[k] + kTolerance)) {
      return fail(ErrorCode::invalid,
                  "the pose is {:.6g} {} from the middle of the region along {}; expected at most "
                  "{:.6g}",
                  task[k], k == internal::kYaw ? "rad" : "m", kTaskNames[k],
                  region.half_extents[k]);
    }
    task[k] = std::copysign(region.half_extents[k], task[k]);
  }
  const Transform reached = frame.pose(task);
  const double tilt = Eigen::AngleAxisd(reached.rotation.transpose() * pose.rotation).angle();
  if (!(tilt <= kTolerance)) {
    return fail(ErrorCode::invalid,
                "the pose is turned by {:.3g} rad from the poses of the region, which turn about "
                "its z axis only",
                tilt);
  }
  return task;
}

}  // namespace mneme
