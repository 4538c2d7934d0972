// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Forward kinematics over a sorted tree, moving joints and links, and the shapes of links.
#pragma once

#include "mneme/robot.h"

#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// True if the values of the joint are angles.
[[nodiscard]] inline bool is_turning(const Joint& joint) {
  return joint.type == JointType::revolute || joint.type == JointType::continuous;
}

/// True if the joint moves and follows no other.
[[nodiscard]] inline bool is_free(const Joint& joint) {
  return joint.type != JointType::fixed && !joint.mimic;
}

/// Radians or metres beyond a limit that count as a rounding error.
inline constexpr double kLimitTolerance = 1e-5;

/// Returns a configuration that is uniform between the limits of the group's joints.
[[nodiscard]] Configuration random_configuration(const Robot& robot, Rng& rng);

/// Returns the configuration at a fraction of the shortest motion; continuous joints are unwrapped.
[[nodiscard]] Configuration interpolate(const Robot& robot, std::span<const double> from,
                                        std::span<const double> to, double fraction);

/// Returns the pose of the child link in the joint frame at `value`.
[[nodiscard]] Transform joint_motion(const Joint& joint, double value);

/// Returns the values of all joints: `q[i]` for `group[i]`, the values of followers, fixed values
/// of the others.
[[nodiscard]] std::vector<double> joint_values(std::span<const Joint> joints,
                                               std::span<const int> group,
                                               std::span<const double> q);

/// Returns the poses of all links in the root link's frame. Links and joints are in tree order.
[[nodiscard]] std::vector<Transform> forward_kinematics(std::span<const Joint> joints,
                                                        std::span<const int> group,
                                                        std::span<const double> q);

/// Returns per joint true if it is in `group` or follows one of its joints.
[[nodiscard]] std::vector<bool> find_moving(std::span<const Joint> joints,
                                            std::span<const int> group);
/// Returns per link true if a moving joint (see find_moving()) carries it.
[[nodiscard]] std::vector<bool> find_moving_links(const Robot& robot);

/// Returns per link the topmost link of its body. Joints that do not move weld links into bodies.
[[nodiscard]] std::vector<int> find_bodies(std::span<const Joint> joints,
                                           std::span<const int> group);

/// Returns the joints that carry the link, from the link to the root.
[[nodiscard]] std::vector<int> joints_to(const Robot& robot, int link);

/// The value of a joint as a function of the group: rate * q[joint] + offset.
struct Drive {
  int joint = 0;  ///< Position in the group.
  double rate = 1, offset = 0;
};
/// Returns nothing if the joint keeps its fixed value, also as a follower with rate 0.
[[nodiscard]] std::optional<Drive> find_drive(const Robot& robot, int joint);

/// Returns true if all moving joints rotate about an axis parallel to the root's z axis, and all
/// shapes are centred in z = 0; to within 1e-9. One configuration suffices: such joints keep z.
[[nodiscard]] bool moves_in_plane(std::span<const Link> links, std::span<const Joint> joints,
                                  std::span<const int> group);

[[nodiscard]] bool has_shapes(const Link& link);

/// Returns spheres, as capsules of length 0, then capsules, in the link's frame.
[[nodiscard]] std::vector<Capsule> shapes_of(const Link& link);
/// Returns the same capsules in frame W.
[[nodiscard]] std::vector<Capsule> shapes_of(const Link& link, const Transform& X_WL);

[[nodiscard]] Capsule moved(const Capsule& capsule, const Transform& X_WL);

/// Returns a sphere around all shapes, centred in the bounding box of their axes; a point at the
/// origin without shapes.
[[nodiscard]] Sphere bound_of(std::span<const Capsule> shapes);

/// Returns a distance in metres from the root's origin that no shape exceeds within the limits.
[[nodiscard]] double farthest_reach(const Robot& robot);

}  // namespace mneme::internal
