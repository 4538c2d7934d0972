// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "line/floating_body.h"

#include "mneme/spheres.h"

#include "base/as_index.h"
#include "check/parted_pairs.h"
#include "planning/end_contacts.h"
#include "robot/kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace mneme::internal {
namespace {

/// Farther than any pose of an arm, metres.
constexpr double kFarthestPose = 20;

Joint joint_along(int axis, JointType type, int number) {
  Joint joint;
  joint.name = fmt::format("floating_{}", number);
  joint.type = type;
  joint.parent_link = number;
  joint.child_link = number + 1;
  joint.axis = Vec3::Unit(axis);
  joint.upper = type == JointType::prismatic ? kFarthestPose : 2 * std::numbers::pi;
  joint.lower = -joint.upper;
  return joint;
}

/// x, y, z, yaw, pitch, roll: six joints that reach any pose.
std::array<float, 6> floating_values(const Transform& pose) {
  const Eigen::Matrix3d& R = pose.rotation;
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  // At the poles yaw alone turns.
  const bool is_pole = std::hypot(R(0, 0), R(1, 0)) < 1e-9;
  const double yaw = is_pole ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0));
  const double roll = is_pole ? 0 : std::atan2(R(2, 1), R(2, 2));
  const Vec3& p = pose.translation;
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          static_cast<float>(yaw),   static_cast<float>(pitch), static_cast<float>(roll)};
}

Link moved_link(Link link, const Transform& X) {
  link.parent_joint = -1;
  for (Sphere& sphere : link.spheres) sphere.center = X * sphere.center;
  for (Capsule& capsule : link.capsules) capsule = moved(capsule, X);
  if (link.approximation) {
    Mesh& surface = link.approximation->surface;
    surface = std::get<Mesh>(transformed(X, surface));
  }
  return link;
}

/// A robot of three prismatic and three revolute joints that carries `links`.
Robot::Parts make_parts(std::vector<Link> links) {
  Robot::Parts parts;
  parts.name = "floating";
  parts.allowed_pairs.emplace();
  for (int i = 0; i <= 6; ++i) {
    parts.links.push_back({.name = fmt::format("floating_link_{}", i), .parent_joint = i - 1});
  }
  for (int i = 0; i < 3; ++i) parts.joints.push_back(joint_along(i, JointType::prismatic, i));
  for (int i = 0; i < 3; ++i)
    parts.joints.push_back(joint_along(2 - i, JointType::revolute, 3 + i));
  for (Link& link : links) {
    Joint joint;
    joint.name = "to_" + link.name;
    joint.parent_link = 6;
    joint.child_link = static_cast<int>(parts.links.size());
    link.parent_joint = static_cast<int>(parts.joints.size());
    parts.joints.push_back(std::move(joint));
    parts.links.push_back(std::move(link));
  }
  return parts;
}

/// The scene without what it says of other links.
Scene scene_for(const Robot& robot, Scene scene) {
  scene.exact_pairs.clear();
  // Contact that is allowed at the ends of a line is no reason to drop a pose there.
  for (const EndContact& contact : std::exchange(scene.end_contacts, {})) {
    if (Obstacle* other = scene.find(contact.second)) other->may_touch.push_back(contact.first);
    if (Obstacle* other = scene.find(contact.first)) other->may_touch.push_back(contact.second);
  }
  for (Obstacle& obstacle : scene.obstacles) {
    obstacle.exact_links.clear();
    std::erase_if(obstacle.may_touch,
                  [&](const std::string& name) { return !robot.find_link(name); });
  }
  return scene;
}

}  // namespace

std::optional<FloatingBody> FloatingBody::make(std::vector<Link> links, Scene scene,
                                               const BodySettings& settings) {
  std::erase_if(links, [](const Link& link) { return !has_shapes(link); });
  if (links.empty()) return std::nullopt;
  double excess = 0;
  bool has_surfaces = false;
  for (Link& link : links) {
    has_surfaces = has_surfaces || link.approximation.has_value();
    // Surfaces cost milliseconds to prepare.
    if (!settings.is_exact) link.approximation.reset();
    if (link.approximation) excess = std::max(excess, link.approximation->excess);
  }
  const auto robot = make_robot(make_parts(std::move(links)));
  if (!robot) return std::nullopt;
  auto checker =
      CollisionChecker::make(*robot, scene_for(*robot, std::move(scene)), {.isa = settings.isa});
  if (!checker) return std::nullopt;
  return FloatingBody(*std::move(checker), excess, has_surfaces);
}

std::optional<FloatingBody> FloatingBody::of_link(const Robot& robot, const Scene& scene,
                                                  const std::string& link,
                                                  const BodySettings& settings) {
  const Robot bare = robot.without_attached();
  const int tip = *bare.find_link(link);
  const Configuration middle = bare.normalized(Configuration(as_index(bare.joint_count()), 0.0));
  const std::vector<Transform> poses = bare.link_poses(middle);
  std::vector<Link> links;
  for (const int i : rigid_with(bare, tip)) {
    links.push_back(
        moved_link(bare.links()[as_index(i)], poses[as_index(tip)].inverse() * poses[as_index(i)]));
  }
  return make(std::move(links), scene, settings);
}

std::optional<FloatingBody> FloatingBody::of_object(const Robot& robot, const Scene& scene,
                                                    const std::string& object,
                                                    const Transform& X_LO,
                                                    const BodySettings& settings) {
  const Transform X_OL = X_LO.inverse();
  std::vector<Link> links;
  for (const ApproximatedObject& each : robot.attached()) {
    if (each.object.name != object) continue;
    links.push_back(
        moved_link({object, -1, each.spheres, each.capsules, {}, each.approximation}, X_OL));
  }
  return make(std::move(links), scene, settings);
}

std::optional<FloatingBody> FloatingBody::of_obstacle(const Scene& scene, const std::string& name,
                                                      const Transform& X_WO,
                                                      const BodySettings& settings) {
  const Transform X_OW = X_WO.inverse();
  AttachedObject object{name, "", {}};
  for (const Shape& shape : scene.find(name)->shapes) {
    object.shapes.push_back(transformed(X_OW, shape));
  }
  const auto spheres = approximate_object(std::move(object));
  Scene others = scene;
  if (!spheres || !others.remove(name)) return std::nullopt;
  return make({{name, -1, spheres->spheres, spheres->capsules, {}, spheres->approximation}},
              std::move(others), settings);
}

std::vector<std::uint8_t> FloatingBody::find_free(const std::vector<Transform>& poses,
                                                  double depth) const {
  std::vector<std::uint8_t> is_free = find_shallower(poses, depth);
  if (excess_ == 0) return is_free;
  // Twice the excess: it is measured at samples.
  const std::vector<std::uint8_t> may_be_free = find_shallower(poses, depth + 2 * excess_);
  if (depth > 0) return may_be_free;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (is_free[i] || !may_be_free[i]) continue;
    const std::array<float, 6> values = floating_values(poses[i]);
    is_free[i] = is_clear_by_exact_geometry(checker_, {values.begin(), values.end()}) ? 1 : 0;
  }
  return is_free;
}

std::vector<std::uint8_t> FloatingBody::find_shallower(const std::vector<Transform>& poses,
                                                       double depth) const {
  std::vector<float> rows;
  rows.reserve(6 * poses.size());
  for (const Transform& pose : poses) {
    const std::array<float, 6> values = floating_values(pose);
    rows.insert(rows.end(), values.begin(), values.end());
  }
  std::vector<std::uint8_t> is_free(poses.size(), 1);
  if (!poses.empty()) checker_.check_states(rows, is_free, -depth);
  return is_free;
}

std::string FloatingBody::describe_contact(const Transform& pose) const {
  const std::array<float, 6> values = floating_values(pose);
  return describe_deepest(checker_.contacts(Configuration(values.begin(), values.end())));
}

std::string describe_deepest(std::span<const Contact> contacts) {
  if (contacts.empty()) return "";
  const Contact& deepest = *std::ranges::min_element(contacts, {}, &Contact::distance);
  const std::string_view gap = deepest.distance > 1e-4 ? ", nearer than the margin" : "";
  return fmt::format("'{}' with '{}'{}", deepest.link, deepest.other, gap);
}

}  // namespace mneme::internal
