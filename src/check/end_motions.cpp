// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/end_motions.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mneme {
namespace internal {
namespace {

/// Metres that a distance may shrink by rounding while contact is left.
constexpr double kRounding = 1e-7;
/// Metres that a link in contact moves between checked states, at most.
constexpr double kContactStep = 2e-4;
constexpr double kTiltRounding = 1e-9;  ///< radians
/// States of a motion that leaves contact, at least.
constexpr double kLeastStates = 64;

}  // namespace

std::vector<LimitExcess> find_excess(const Robot& robot, std::span<const double> q) {
  std::vector<LimitExcess> found;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    if (joint.type == JointType::continuous) continue;
    const double excess = std::max(joint.lower - q[as_index(i)], q[as_index(i)] - joint.upper);
    if (excess > kLimitTolerance) found.push_back({i, excess});
  }
  return found;
}

const Touch* find_same_pair(std::span<const Touch> touches, const Touch& touch) {
  const auto found = std::ranges::lower_bound(touches, touch.pair(), {}, &Touch::pair);
  return found != touches.end() && found->pair() == touch.pair() ? &*found : nullptr;
}

bool is_near_limits(const Robot& robot, std::span<const double> q,
                    const EndTolerances& tolerances) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (std::ssize(q) != robot.joint_count() || !std::ranges::all_of(q, is_finite)) return false;
  return std::ranges::all_of(find_excess(robot, q), [&](const LimitExcess& beyond) {
    const bool slides = robot.group_joint(beyond.joint).type == JointType::prismatic;
    return beyond.excess <= (slides ? tolerances.length : tolerances.angle);
  });
}

EndMotions::EndMotions(const Robot& robot, const Scene& scene, double margin,
                       const EndTolerances& tolerances)
    : robot_(robot),
      margin_(margin),
      tolerances_(tolerances),
      links_(robot),
      shapes_(obstacle_shapes(robot, scene)),
      pairs_(link_pairs(robot, scene)) {
  std::ranges::sort(pairs_, {}, [](const LinkPair& p) { return std::pair(p.first, p.second); });
  for (const EndContact& contact : scene.end_contacts) add_named(contact, scene);
}

/// A name that a link and an obstacle share means the link.
void EndMotions::add_named(const EndContact& contact, const Scene& scene) {
  auto first = robot_.find_link(contact.first), second = robot_.find_link(contact.second);
  if (first && second) {
    named_.push_back({std::min(*first, *second), std::max(*first, *second), true, contact.stretch});
    return;
  }
  const std::string& name = first ? contact.second : contact.first;
  const auto obstacle = std::ranges::find(scene.obstacles, name, &Obstacle::name);
  if ((!first && !second) || obstacle == scene.obstacles.end()) return;
  const int index = static_cast<int>(obstacle - scene.obstacles.begin());
  named_.push_back({first ? *first : *second, index, false, contact.stretch});
}

std::vector<Touch> EndMotions::touching(std::span<const double> q, double extra) const {
  const PosedLinks posed = links_.posed(robot_.link_poses(q));
  std::vector<Touch> found;
  for (int link = 0; link < links_.link_count(); ++link) {
    if (links_.shapes(link).empty() || !links_.is_moving(link)) continue;
    poll_interrupt();
    const auto first = std::ssize(found);
    for (const ObstacleShape& shape : shapes_) {
      const double gap = links_.between(posed, link, shape, margin_ + extra) - margin_;
      if (!(gap < extra)) continue;
      if (std::ssize(found) == first || found.back().other != shape.obstacle) {
        found.push_back({link, shape.obstacle, false, gap});
      }
      found.back().distance = std::min(found.back().distance, gap);
    }
  }
  int last_polled = -1;
  for (const LinkPair& pair : pairs_) {
    if (std::exchange(last_polled, pair.first) != pair.first) poll_interrupt();
    const double gap = links_.between(posed, pair, extra);
    if (gap < extra) found.push_back({pair.first, pair.second, true, gap});
  }
  return found;
}

void EndMotions::check_exactly(std::span<const Touch> touches) {
  const auto is_approximated = [&](int link) {
    return robot_.links()[as_index(link)].approximation.has_value();
  };
  for (const Touch& touch : touches) {
    if (touch.is_self || !is_approximated(touch.link)) continue;
    auto shape = std::ranges::lower_bound(shapes_, touch.other, {}, &ObstacleShape::obstacle);
    for (; shape != shapes_.end() && shape->obstacle == touch.other; ++shape) {
      shape->exact_links.push_back(touch.link);
    }
  }
  for (LinkPair& pair : pairs_) {
    if (find_same_pair(touches, {pair.first, pair.second, true}) == nullptr) continue;
    pair.is_exact = is_approximated(pair.first) || is_approximated(pair.second);
  }
}

bool EndMotions::is_held(const Touch& touch) const {
  const int first_attached = links_.link_count() - static_cast<int>(robot_.attached().size());
  return touch.link >= first_attached || (touch.is_self && touch.other >= first_attached);
}

std::optional<double> EndMotions::stretch_of(const Touch& touch) const {
  std::pair<int, int> ends(touch.link, touch.other);
  if (touch.is_self) ends = std::minmax(touch.link, touch.other);
  for (const NamedPair& pair : named_) {
    if (pair.is_self == touch.is_self && std::pair(pair.link, pair.other) == ends) {
      return pair.stretch;
    }
  }
  return is_held(touch) ? std::optional(tolerances_.stretch) : std::nullopt;
}

double EndMotions::longest_stretch() const {
  double longest = tolerances_.stretch;
  for (const NamedPair& pair : named_) longest = std::max(longest, pair.stretch);
  return longest;
}

double EndMotions::deepest(const Touch& touch) const {
  double least = tolerances_.depth;
  for (const int link : {touch.link, touch.is_self ? touch.other : touch.link}) {
    for (const Capsule& shape : links_.shapes(link)) least = std::min(least, 0.5 * shape.radius);
  }
  return least;
}

bool EndMotions::may_leave(const Touch& touch, bool is_start) const {
  return stretch_of(touch).value_or(0) > 0 || (is_start && touch.distance > -deepest(touch));
}

double EndMotions::travel(const PosedLinks& from, const PosedLinks& to, const Touch& touch) const {
  double most = 0;
  for (const int link : {touch.link, touch.is_self ? touch.other : touch.link}) {
    const Transform &before = from.poses[as_index(link)], &after = to.poses[as_index(link)];
    for (const Capsule& shape : links_.shapes(link)) {
      for (const Vec3& p : {shape.a, shape.b})
        most = std::max(most, (after * p - before * p).norm());
    }
  }
  return most;
}

bool EndMotions::is_left_by(const Configuration& end, const Configuration& inside, bool is_start,
                            int steps, double extra) const {
  std::vector<Touch> open = touching(end, extra);
  const auto may_leave_it = [&](const Touch& touch) {
    return touch.distance >= 0 || may_leave(touch, is_start);
  };
  if (!std::ranges::all_of(open, may_leave_it)) return false;
  const PosedLinks at_end = links_.posed(robot_.link_poses(end));
  const PosedLinks at_inside = links_.posed(robot_.link_poses(inside));
  double farthest = 0;
  for (const Touch& touch : open) farthest = std::max(farthest, travel(at_end, at_inside, touch));
  steps = std::max(steps, static_cast<int>(std::ceil(farthest / kContactStep)));
  for (int i = 1; i <= steps; ++i) {
    const Configuration q = interpolate(robot_, end, inside, static_cast<double>(i) / steps);
    const PosedLinks posed = links_.posed(robot_.link_poses(q));
    std::vector<Touch> still_open;
    for (const Touch& now : touching(q, extra)) {
      const Touch* before = find_same_pair(open, now);
      if (before == nullptr || now.distance < before->distance - kRounding) return false;
      const auto stretch = stretch_of(now);
      const bool is_far = stretch && travel(at_end, posed, now) > *stretch;
      if (now.distance < 0 && (is_far || i == steps)) return false;
      still_open.push_back(now);
    }
    open = std::move(still_open);
  }
  return true;
}

double EndMotions::distance(const PosedLinks& posed, const Touch& touch) const {
  double least = std::numeric_limits<double>::infinity();
  if (touch.is_self) return links_.between_spheres(posed, touch.link, touch.other, least);
  for (const ObstacleShape& shape : shapes_) {
    if (shape.obstacle != touch.other) continue;
    least = std::min(least, links_.between_spheres(posed, touch.link, shape, least));
  }
  return least;
}

Vec3 EndMotions::direction_out(std::span<const double> q, const Touch& touch) const {
  constexpr double kShift = 1e-6;  // metres
  const std::vector<Transform> poses = robot_.link_poses(q);
  const auto distance_at = [&](int axis, double shift) {
    std::vector<Transform> moved = poses;
    moved[as_index(touch.link)].translation[axis] += shift;
    return distance(links_.posed(std::move(moved)), touch);
  };
  Vec3 gradient = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    gradient[axis] = distance_at(axis, kShift) - distance_at(axis, -kShift);
  }
  const double norm = gradient.norm();
  return norm > 0 && std::isfinite(norm) ? Vec3(gradient / norm) : Vec3(Vec3::Zero());
}

namespace {

/// States between two waypoints that a motion is checked at.
int steps_between(const Robot& robot, const Configuration& from, const Configuration& to,
                  double resolution) {
  constexpr double kMostStates = 1e6;
  const double steps = std::ceil(robot.distance(from, to) / resolution);
  // In this order of arguments NaN becomes kLeastStates.
  return static_cast<int>(std::max(kLeastStates, std::min(steps, kMostStates)));
}

/// Removes a start and a goal that need the tolerances from `path`. Returns false if the motion
/// next to one of them does not leave its contact or its excess of limits as EndTolerances allow.
bool drop_ends(const Robot& robot, const Scene& scene, double resolution,
               const EndTolerances& tolerances, std::vector<Configuration>& path) {
  const EndMotions ends(robot, scene, 0, tolerances);
  const auto is_left = [&](const Configuration& end, const Configuration& inside, bool is_start) {
    return ends.is_left_by(end, inside, is_start, steps_between(robot, end, inside, resolution), 0);
  };
  const bool is_out = !robot.is_configuration(path.front());
  if (is_out || !ends.touching(path.front()).empty()) {
    if (!is_near_limits(robot, path.front(), tolerances)) return false;
    if (!robot.is_configuration(path[1]) || !is_left(path.front(), path[1], true)) return false;
    path.erase(path.begin());
  }
  if (!robot.is_configuration(path.back())) return false;
  if (path.size() < 2 || ends.touching(path.back()).empty()) return true;
  const Configuration goal = path.back();
  path.pop_back();
  return robot.is_configuration(path.back()) && is_left(goal, path.back(), false);
}

}  // namespace
}  // namespace internal

bool is_path_free(const Robot& robot, const Scene& scene, const std::vector<Configuration>& path,
                  double resolution, const EndTolerances& tolerances) {
  std::vector<Configuration> inner = path;
  if (path.size() > 1 && resolution > 0 &&
      !internal::drop_ends(robot, scene, resolution, tolerances, inner)) {
    return false;
  }
  return is_path_free(robot, scene, inner, resolution);
}

bool keeps_cone(const Robot& robot, const OrientationConstraint& constraint,
                const std::vector<Configuration>& path, double resolution,
                const EndTolerances& tolerances) {
  if (path.empty() || !(resolution > 0)) return false;
  std::vector<Configuration> inner = path;
  double before = tilt(robot, constraint, path.front());
  if (before > constraint.angle && path.size() > 1) {
    if (before > constraint.angle + tolerances.angle) return false;
    const int steps = internal::steps_between(robot, path[0], path[1], resolution);
    for (int i = 1; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const double now =
          tilt(robot, constraint, internal::interpolate(robot, path[0], path[1], share));
      if (now > std::max(before, constraint.angle) + internal::kTiltRounding) return false;
      before = now;
    }
    inner.erase(inner.begin());
  }
  return largest_tilt(robot, constraint, inner, resolution) <= constraint.angle;
}

}  // namespace mneme
