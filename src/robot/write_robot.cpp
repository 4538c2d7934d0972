// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "base/text.h"
#include "input/xml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mneme {

std::string_view to_string(JointType type) {
  constexpr std::array<std::string_view, 4> kNames = {"fixed", "revolute", "continuous",
                                                      "prismatic"};
  return kNames[static_cast<std::size_t>(type)];
}

namespace {

using internal::xml_escaped;
using internal::xml_origin;
using internal::xml_vector;

std::string begin_robot(const std::string& name, std::string_view comment) {
  return fmt::format("<?xml version=\"1.0\"?>\n{}<robot name=\"{}\">\n",
                     comment.empty() ? "" : fmt::format("<!-- {} -->\n", comment),
                     xml_escaped(name));
}

std::string collision(const Transform& pose, const std::string& shape) {
  return fmt::format("    <collision>{}<geometry>{}</geometry></collision>\n", xml_origin(pose),
                     shape);
}

/// The shortest rotation that takes the z axis to `direction`, which may be zero.
Eigen::Matrix3d rotation_to(const Vec3& direction) {
  const Vec3 axis = Vec3::UnitZ().cross(direction);
  if (axis.norm() > 0) {
    return rotation_about(axis.normalized(), std::atan2(axis.norm(), direction.z()));
  }
  return direction.z() < 0 ? rotation_about(Vec3::UnitX(), std::atan2(0.0, -1.0))
                           : Eigen::Matrix3d::Identity();
}

std::string to_xml(const Sphere& sphere) {
  return collision({Eigen::Matrix3d::Identity(), sphere.center},
                   fmt::format("<sphere radius=\"{}\"/>", sphere.radius));
}

std::string to_xml(const Capsule& capsule) {
  const Vec3 along = capsule.b - capsule.a;
  return collision(
      {rotation_to(along), 0.5 * (capsule.a + capsule.b)},
      fmt::format("<capsule radius=\"{}\" length=\"{}\"/>", capsule.radius, along.norm()));
}

std::string to_xml(const Box& box) {
  return collision(box.pose, fmt::format("<box size=\"{}\"/>", xml_vector(2 * box.half_extents)));
}

std::string to_xml(const Cylinder& cylinder) {
  return collision(cylinder.pose, fmt::format("<cylinder radius=\"{}\" length=\"{}\"/>",
                                              cylinder.radius, cylinder.length));
}

std::string to_xml(const MeshFile& mesh) {
  const std::string scheme = mesh.path.starts_with('/') ? "file://" : "";
  return collision(mesh.pose, fmt::format("<mesh filename=\"{}{}\" scale=\"{}\"/>", scheme,
                                          xml_escaped(mesh.path), xml_vector(mesh.scale)));
}

std::string to_xml(const Link& link) {
  std::string shapes;
  for (const Sphere& sphere : link.spheres) shapes += to_xml(sphere);
  for (const Capsule& capsule : link.capsules) shapes += to_xml(capsule);
  for (const Solid& solid : link.solids) {
    shapes += std::visit([](const auto& s) { return to_xml(s); }, solid);
  }
  const std::string name = xml_escaped(link.name);
  if (shapes.empty()) return fmt::format("  <link name=\"{}\"/>\n", name);
  return fmt::format("  <link name=\"{}\">\n{}  </link>\n", name, shapes);
}

/// The type of a joint in URDF.
std::string_view type_of(const Joint& joint) {
  if (!joint.held) return to_string(joint.type);
  return joint.held->is_planar ? "planar" : "floating";
}

std::string motion_to_xml(const Joint& joint, const Robot::Parts& parts) {
  if (joint.held && joint.held->is_planar) {
    return fmt::format("    <axis xyz=\"{}\"/>\n", xml_vector(joint.axis));
  }
  if (joint.type == JointType::fixed) return "";
  std::string text = fmt::format("    <axis xyz=\"{}\"/>\n    <limit ", xml_vector(joint.axis));
  if (joint.type != JointType::continuous) {
    text += fmt::format("lower=\"{}\" upper=\"{}\" ", joint.lower, joint.upper);
  }
  // Other readers require an effort.
  text += fmt::format("effort=\"1\" velocity=\"{}\"", joint.velocity);
  if (joint.acceleration) text += fmt::format(" acceleration=\"{}\"", *joint.acceleration);
  if (joint.jerk) text += fmt::format(" jerk=\"{}\"", *joint.jerk);
  text += "/>\n";
  if (joint.mimic) {
    const Joint& leader = parts.joints[internal::as_index(joint.mimic->joint)];
    text += fmt::format("    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>\n",
                        xml_escaped(leader.name), joint.mimic->multiplier, joint.mimic->offset);
  }
  return text;
}

std::string to_xml(const Joint& joint, const Robot::Parts& parts) {
  const auto link_name = [&](int link) {
    return xml_escaped(parts.links[internal::as_index(link)].name);
  };
  const std::string origin =
      xml_origin(joint.held ? joint.origin * joint.held->pose.inverse() : joint.origin);
  return fmt::format(
      "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
      "{}{}  </joint>\n",
      xml_escaped(joint.name), type_of(joint), link_name(joint.parent_link),
      link_name(joint.child_link), origin.empty() ? "" : "    " + origin + "\n",
      motion_to_xml(joint, parts));
}

}  // namespace

std::string to_urdf(const Robot::Parts& parts, std::string_view comment) {
  std::string text = begin_robot(parts.name, comment);
  for (const Link& link : parts.links) text += to_xml(link);
  for (const Joint& joint : parts.joints) text += to_xml(joint, parts);
  return text + "</robot>\n";
}

namespace {

/// Returns ` NAME="TEXT"`, or nothing without a text.
std::string attribute(std::string_view name, const std::string& text) {
  return text.empty() ? "" : fmt::format(" {}=\"{}\"", name, xml_escaped(text));
}

std::string to_xml(const JointGroup& group, const Robot::Parts& parts) {
  std::string text = fmt::format("  <group name=\"{}\">\n", xml_escaped(group.name));
  if (!group.base.empty() && !group.tip.empty()) {
    return text + fmt::format("    <chain base_link=\"{}\" tip_link=\"{}\"/>\n  </group>\n",
                              xml_escaped(group.base), xml_escaped(group.tip));
  }
  if (std::ranges::count(parts.virtual_joints, group.virtual_joint, &VirtualJoint::name) > 0) {
    text += fmt::format("    <joint name=\"{}\"/>\n", xml_escaped(group.virtual_joint));
  }
  for (const std::string& joint : group.joints) {
    text += fmt::format("    <joint name=\"{}\"/>\n", xml_escaped(joint));
  }
  return text + "  </group>\n";
}

std::string to_xml(const NamedState& state) {
  std::string text = fmt::format("  <group_state name=\"{}\" group=\"{}\">\n",
                                 xml_escaped(state.name), xml_escaped(state.group));
  for (const auto& [joint, value] : state.values) {
    text += fmt::format("    <joint name=\"{}\" value=\"{}\"/>\n", xml_escaped(joint), value);
  }
  return text + "  </group_state>\n";
}

std::string to_xml(const VirtualJoint& joint) {
  return fmt::format("  <virtual_joint{}{}{}{}/>\n", attribute("name", joint.name),
                     attribute("type", joint.type), attribute("parent_frame", joint.parent_frame),
                     attribute("child_link", joint.child_link));
}

std::string to_xml(const EndEffector& each) {
  return fmt::format("  <end_effector{}{}{}{}/>\n", attribute("name", each.name),
                     attribute("parent_link", each.parent_link), attribute("group", each.group),
                     attribute("parent_group", each.parent_group));
}

/// The link that carries the first joint of a group; the root of a group without joints.
const std::string& parent_of(const JointGroup& group, const Robot::Parts& parts) {
  const auto joint = group.joints.empty()
                         ? parts.joints.end()
                         : std::ranges::find(parts.joints, group.joints.front(), &Joint::name);
  const int link = joint == parts.joints.end() ? 0 : joint->parent_link;
  return parts.links[internal::as_index(link)].name;
}

}  // namespace

std::string to_srdf(const Robot::Parts& parts, std::span<const std::string> reasons,
                    std::string_view comment) {
  std::string text = begin_robot(parts.name, comment);
  for (const VirtualJoint& joint : parts.virtual_joints) text += to_xml(joint);
  for (const JointGroup& group : parts.groups) text += to_xml(group, parts);
  for (const NamedState& state : parts.states) text += to_xml(state);
  for (const JointGroup& group : parts.groups) {
    const bool is_listed =
        std::ranges::count(parts.end_effectors, group.name, &EndEffector::group) > 0;
    if (!group.is_end_effector || is_listed) continue;
    text += to_xml(EndEffector{group.name, group.name, parent_of(group, parts)});
  }
  for (const EndEffector& each : parts.end_effectors) text += to_xml(each);
  for (const std::string& joint : parts.passive_joints) {
    text += fmt::format("  <passive_joint name=\"{}\"/>\n", xml_escaped(joint));
  }
  for (std::size_t i = 0; parts.allowed_pairs && i < parts.allowed_pairs->size(); ++i) {
    const auto& [first, second] = (*parts.allowed_pairs)[i];
    text += fmt::format("  <disable_collisions link1=\"{}\" link2=\"{}\" reason=\"{}\"/>\n",
                        xml_escaped(first), xml_escaped(second),
                        i < reasons.size() ? xml_escaped(reasons[i]) : "User");
  }
  return text + "</robot>\n";
}

namespace {

bool is_positive(double value) { return std::isfinite(value) && value > 0; }

}  // namespace

Result<std::string> planar_arm_urdf(const std::string& name, std::span<const double> lengths,
                                    double thickness) {
  if (name.empty()) return fail(ErrorCode::invalid, "planar arm: the robot's name is empty");
  if (lengths.empty()) return fail(ErrorCode::invalid, "planar arm: at least one link is needed");
  if (!is_positive(thickness)) {
    return fail(ErrorCode::invalid, "planar arm: thickness is {}, expected more than 0", thickness);
  }
  Robot::Parts parts{name, std::vector<Link>(1 + lengths.size()), {}};
  parts.links[0].name = "base";
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (!is_positive(lengths[i])) {
      return fail(ErrorCode::invalid,
                  "planar arm: length of link {} is {}, expected "
                  "more than 0",
                  i + 1, lengths[i]);
    }
    Joint joint;
    joint.name = fmt::format("joint_{}", i + 1);
    joint.type = i == 0 ? JointType::continuous : JointType::revolute;
    joint.parent_link = static_cast<int>(i);
    joint.child_link = static_cast<int>(i + 1);
    if (i > 0) joint.origin.translation = Vec3(lengths[i - 1], 0, 0);
    joint.axis = Vec3::UnitZ();
    joint.lower = -std::numbers::pi;
    joint.upper = std::numbers::pi;
    parts.joints.push_back(std::move(joint));
    Link& link = parts.links[i + 1];
    link.name = fmt::format("link_{}", i + 1);
    link.capsules.push_back({Vec3::Zero(), Vec3(lengths[i], 0, 0), 0.5 * thickness});
  }
  return to_urdf(parts,
                 "Made by `mneme robot planar`. A capsule is an extension: its length is between "
                 "cap centres.");
}

}  // namespace mneme
