// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/waypoints.h"

#include "base/as_index.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mneme {

Path unwrapped(const Robot& robot, Path path, const Configuration& start) {
  constexpr double kSameTurn = 1e-9;  // radians: rounding of whole turns
  const Configuration* before = &start;
  for (Configuration& q : path) {
    q = robot.turned_near(q, *before);
    before = &q;
  }
  for (std::size_t j = 0; j < start.size() && !path.empty(); ++j) {
    double& first = path.front()[j];
    if (std::abs(first - start[j]) < kSameTurn) first = start[j];
  }
  return path;
}

}  // namespace mneme

namespace mneme::internal {

std::vector<float> to_floats(std::span<const double> q) {
  std::vector<float> result;
  result.reserve(q.size());
  for (const double value : q) result.push_back(static_cast<float>(value));
  return result;
}

std::vector<float> to_floats(const Robot& robot, const Configuration& q) {
  return to_floats(robot.normalized(q));
}

std::vector<float> to_rows(const Path& path) {
  std::vector<float> rows;
  for (const Configuration& q : path) rows.insert(rows.end(), q.begin(), q.end());
  return rows;
}

Path to_path(const Robot& robot, const std::vector<std::vector<float>>& path) {
  Path result;
  result.reserve(path.size());
  for (const std::vector<float>& q : path) {
    result.push_back(robot.normalized(Configuration(q.begin(), q.end())));
  }
  return result;
}

Waypoints::Waypoints(const Robot& robot, std::vector<float> pace)
    : space_(robot),
      has_turns_(std::ranges::any_of(space_.periods(), [](float period) { return period > 0; })),
      pace_(std::move(pace)) {}

void Waypoints::assign(std::vector<float> rows) {
  const auto joints = as_index(joint_count());
  std::vector<float> delta(joints);
  for (std::size_t i = joints; i + joints <= rows.size(); i += joints) {
    space_.difference(&rows[i - joints], &rows[i], delta.data());
    for (std::size_t j = 0; j < joints; ++j) {
      if (space_.periods()[j] > 0) rows[i + j] = rows[i - joints + j] + delta[j];
    }
  }
  rows_ = std::move(rows);
  measure();
}

void Waypoints::replace(int first, int last, std::span<const float> rows) {
  const auto begin = rows_.begin() + (first + 1) * joint_count();
  const auto end = rows_.begin() + last * joint_count();
  const auto kept = std::min(end - begin, static_cast<std::ptrdiff_t>(rows.size()));
  std::copy_n(rows.begin(), kept, begin);
  rows_.insert(rows_.erase(begin + kept, end), rows.begin() + kept, rows.end());
  measure();
}

PathPoint Waypoints::locate(float s) const {
  int motion = 0;
  for (const int last = count() - 2; motion < last && arc_length(motion + 1) <= s;) ++motion;
  const float length = arc_length(motion + 1) - arc_length(motion);
  const float fraction = length > 0 ? (s - arc_length(motion)) / length : 0;
  return {motion, std::clamp(fraction, 0.0f, 1.0f)};
}

void Waypoints::write(const PathPoint& point, float* q) const {
  const float* from = (*this)[point.motion];
  const float* to = (*this)[point.motion + 1];
  for (int j = 0; j < joint_count(); ++j) q[j] = from[j] + point.fraction * (to[j] - from[j]);
}

float Waypoints::distance(const float* a, const float* b) const {
  float sum = 0, most = 0;
  for (int j = 0; j < joint_count(); ++j) {
    const float delta = (b[j] - a[j]) * (pace_.empty() ? 1 : pace_[as_index(j)]);
    sum += delta * delta;
    most = std::max(most, std::abs(delta));
  }
  const float all = std::sqrt(sum);
  return pace_.empty() ? all : all + MotionCost::kSlowest * (most - all);
}

bool Waypoints::has_unique_direction(const float* from, const float* to) const {
  constexpr float kTurnMargin = 1e-3f;  // radians
  constexpr float kMost = std::numbers::pi_v<float> - kTurnMargin;
  if (!has_turns_) return true;
  for (int j = 0; j < joint_count(); ++j) {
    if (space_.periods()[as_index(j)] > 0 && std::abs(to[j] - from[j]) > kMost) return false;
  }
  return true;
}

void Waypoints::measure() {
  const int joints = joint_count(), motions = count() - 1;
  arc_lengths_.assign(as_index(motions + 1), 0.0f);
  directions_.assign(rows_.size(), 0.0f);
  for (int i = 0; i < motions; ++i) {
    const float *from = (*this)[i], *to = (*this)[i + 1];
    const float length = distance(from, to);
    arc_lengths_[as_index(i + 1)] = arc_length(i) + length;
    const float inverse = length > 0 ? 1 / length : 0;
    float* direction = directions_.data() + i * joints;
    for (int j = 0; j < joints; ++j) direction[j] = (to[j] - from[j]) * inverse;
  }
}

}  // namespace mneme::internal
