// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "robot/xml_text.h"

namespace mneme {
namespace {

using internal::xml_escaped;
using internal::xml_origin;
using internal::xml_vector;

std::string_view type_name(JointType type) {
  switch (type) {
    case JointType::fixed:
      return "fixed";
    case JointType::revolute:
      return "revolute";
    case JointType::continuous:
      return "continuous";
    case JointType::prismatic:
      return "prismatic";
  }
  return "fixed";
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

std::string motion_to_xml(const Joint& joint, const Robot::Parts& parts) {
  if (joint.type == JointType::fixed) return "";
  std::string text = fmt::format("    <axis xyz=\"{}\"/>\n    <limit ", xml_vector(joint.axis));
  if (joint.type != JointType::continuous) {
    text += fmt::format("lower=\"{}\" upper=\"{}\" ", joint.lower, joint.upper);
  }
  // Readers want an effort and a velocity where there are limits; mneme uses neither.
  text += "effort=\"1\" velocity=\"1\"/>\n";
  if (joint.mimic) {
    const Joint& leader = parts.joints[static_cast<std::size_t>(joint.mimic->joint)];
    text += fmt::format("    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>\n",
                        xml_escaped(leader.name), joint.mimic->multiplier, joint.mimic->offset);
  }
  return text;
}

std::string to_xml(const Joint& joint, const Robot::Parts& parts) {
  const auto link_name = [&](int link) {
    return xml_escaped(parts.links[static_cast<std::size_t>(link)].name);
  };
  const std::string origin = xml_origin(joint.origin);
  return fmt::format(
      "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
      "{}{}  </joint>\n",
      xml_escaped(joint.name), type_name(joint.type), link_name(joint.parent_link),
      link_name(joint.child_link), origin.empty() ? "" : "    " + origin + "\n",
      motion_to_xml(joint, parts));
}

}  // namespace

std::string to_urdf(const Robot::Parts& parts, std::string_view comment) {
  std::string text = "<?xml version=\"1.0\"?>\n";
  if (!comment.empty()) text += fmt::format("<!-- {} -->\n", comment);
  text += fmt::format("<robot name=\"{}\">\n", xml_escaped(parts.name));
  for (const Link& link : parts.links) text += to_xml(link);
  for (const Joint& joint : parts.joints) text += to_xml(joint, parts);
  return text + "</robot>\n";
}

}  // namespace mneme
