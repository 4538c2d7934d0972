// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include <algorithm>

#include <fmt/format.h>

#include "robot/xml_text.h"

namespace mneme {
namespace {

using internal::xml_escaped;

std::string to_xml(const JointGroup& group) {
  std::string text = fmt::format("  <group name=\"{}\">\n", xml_escaped(group.name));
  for (const std::string& joint : group.joints) {
    text += fmt::format("    <joint name=\"{}\"/>\n", xml_escaped(joint));
  }
  return text + "  </group>\n";
}

/// The link that carries the first joint of a group; the root of a group without joints.
const std::string& parent_of(const JointGroup& group, const Robot::Parts& parts) {
  const auto joint = group.joints.empty()
                         ? parts.joints.end()
                         : std::ranges::find(parts.joints, group.joints.front(), &Joint::name);
  const int link = joint == parts.joints.end() ? 0 : joint->parent_link;
  return parts.links[static_cast<std::size_t>(link)].name;
}

}  // namespace

std::string to_srdf(const Robot::Parts& parts, std::span<const std::string> reasons,
                    std::string_view comment) {
  std::string text = "<?xml version=\"1.0\"?>\n";
  if (!comment.empty()) text += fmt::format("<!-- {} -->\n", comment);
  text += fmt::format("<robot name=\"{}\">\n", xml_escaped(parts.name));
  for (const JointGroup& group : parts.groups) text += to_xml(group);
  for (const JointGroup& group : parts.groups) {
    if (!group.is_end_effector) continue;
    text += fmt::format("  <end_effector name=\"{0}\" parent_link=\"{1}\" group=\"{0}\"/>\n",
                        xml_escaped(group.name), xml_escaped(parent_of(group, parts)));
  }
  for (std::size_t i = 0; parts.allowed_pairs && i < parts.allowed_pairs->size(); ++i) {
    const auto& [first, second] = (*parts.allowed_pairs)[i];
    text += fmt::format("  <disable_collisions link1=\"{}\" link2=\"{}\" reason=\"{}\"/>\n",
                        xml_escaped(first), xml_escaped(second),
                        i < reasons.size() ? xml_escaped(reasons[i]) : "User");
  }
  return text + "</robot>\n";
}

}  // namespace mneme
