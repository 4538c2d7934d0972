// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "robot/xml_text.h"

namespace mneme {
namespace {

// check_urdf wants an effort and a velocity where there are limits; mneme uses neither.
constexpr std::string_view kUnusedLimits = R"(effort="1" velocity="1")";

std::string link_element(std::size_t number, double length, double radius) {
  return fmt::format(R"(  <link name="link_{}">
    <collision>
      <origin xyz="{} 0 0" rpy="0 {} 0"/>
      <geometry><capsule radius="{}" length="{}"/></geometry>
    </collision>
  </link>
)",
                     number, 0.5 * length, 0.5 * std::numbers::pi, radius, length);
}

std::string joint_element(std::size_t number, double previous_length) {
  const bool is_first = number == 1;
  const std::string parent = is_first ? "base" : fmt::format("link_{}", number - 1);
  const std::string limits =
      fmt::format(R"(lower="{}" upper="{}" )", -std::numbers::pi, std::numbers::pi);
  return fmt::format(R"(  <joint name="joint_{}" type="{}">
    <parent link="{}"/>
    <child link="link_{}"/>
    <origin xyz="{} 0 0" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit {}{}/>
  </joint>
)",
                     number, is_first ? "continuous" : "revolute", parent, number, previous_length,
                     is_first ? "" : limits, kUnusedLimits);
}

bool is_positive(double value) { return std::isfinite(value) && value > 0; }

}  // namespace

Result<std::string> planar_arm_urdf(const std::string& name, std::span<const double> lengths,
                                    double thickness) {
  if (name.empty()) return fail(ErrorCode::invalid, "planar arm: the robot's name is empty");
  if (lengths.empty()) return fail(ErrorCode::invalid, "planar arm: at least one link is needed");
  if (!is_positive(thickness)) {
    return fail(ErrorCode::invalid,
                fmt::format("planar arm: thickness is {}, expected more than 0", thickness));
  }
  std::string links, joints;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (!is_positive(lengths[i])) {
      return fail(ErrorCode::invalid, fmt::format("planar arm: length of link {} is {}, expected "
                                                  "more than 0",
                                                  i + 1, lengths[i]));
    }
    links += link_element(i + 1, lengths[i], 0.5 * thickness);
    joints += joint_element(i + 1, i == 0 ? 0.0 : lengths[i - 1]);
  }
  return fmt::format(R"(<?xml version="1.0"?>
<!-- Made by `mneme robot planar`. A capsule is an extension: its length is between cap centres. -->
<robot name="{}">
  <link name="base"/>
{}{}</robot>
)",
                     internal::xml_escaped(name), links, joints);
}

}  // namespace mneme
