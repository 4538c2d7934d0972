// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems and results made by hand, and a reader for the SVG that comes out.
#pragma once

#include "mneme/report.h"

#include "support/support.h"

#include <tinyxml2.h>

#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace mneme::test {

/// An arm of `joints` links of 1 m; its plane is z = 0 unless `axis` is another.
inline Robot unit_arm(int joints, const Vec3& axis = Vec3::UnitZ()) {
  Robot::Parts parts;
  parts.name = "unit_arm";
  parts.links.emplace_back().name = "base";
  for (int i = 0; i < joints; ++i) {
    const std::string number = std::to_string(i + 1);
    Link& link = parts.links.emplace_back();
    link.name = "link_" + number;
    link.capsules.push_back({Vec3::Zero(), Vec3::UnitX(), 0.001});
    Joint& joint = parts.joints.emplace_back();
    joint.name = "joint_" + number;
    joint.type = i == 0 ? JointType::continuous : JointType::revolute;
    joint.parent_link = i;
    joint.child_link = i + 1;
    joint.origin.translation = i == 0 ? Vec3(0, 0, 0) : Vec3(1, 0, 0);
    joint.axis = axis;
    joint.lower = -3.14159;
    joint.upper = 3.14159;
  }
  return require(make_robot(std::move(parts)));
}

/// Three links between two circles.
inline Problem gap_problem() {
  return {.name = "gap",
          .robot = unit_arm(3),
          .scene = make_circle_scene("gap", {{2, 1, 0.7}, {2, -1, 0.6}}),
          .start = {0, 0, 0},
          .goals = {{1.5, 0.4, 0.3}}};
}

/// Memory of that gap: one primitive with two matches, `components` means.
inline GlSampler gap_memory(int components) {
  GlSampler gl;
  PrimitiveRetrieval retrieval;
  retrieval.primitive.obstacles = {0, 1};
  retrieval.primitive.key = {2, 1, 0.7, 2, -1, 0.6};
  retrieval.primitive.gap = 0.7;
  retrieval.matches = {{nullptr, 0.0123456, {}}, {nullptr, 0.2, {}}};
  gl.primitives = {retrieval};
  auto mixture = std::make_shared<GaussianMixture>();
  mixture->joint_count = 3;
  for (int i = 0; i < components; ++i) {
    for (const float value : {0.1F, 0.01F * static_cast<float>(i), 0.0F})
      mixture->means.push_back(value);
  }
  gl.mixture = mixture;
  gl.retrieval_time_s = 0.25;
  gl.learning_time_s = 0.125;
  return gl;
}

inline PlanarPicture picture_of(const Problem& problem) {
  PlanarPicture picture;
  picture.problem = &problem;
  return picture;
}

/// Elements of an SVG document.
class SvgReader {
 public:
  explicit SvgReader(const std::string& svg) {
    REQUIRE_MESSAGE(document_.Parse(svg.c_str()) == tinyxml2::XML_SUCCESS, document_.ErrorStr());
  }
  [[nodiscard]] const tinyxml2::XMLElement* root() const { return document_.RootElement(); }
  /// All elements that are called `tag` and stand in a group of `group` (any if empty).
  [[nodiscard]] std::vector<const tinyxml2::XMLElement*> find(const std::string& group,
                                                              const std::string& tag) const {
    std::vector<const tinyxml2::XMLElement*> found;
    collect(root(), group.empty(), group, tag, found);
    return found;
  }
  [[nodiscard]] int count(const std::string& group, const std::string& tag) const {
    return static_cast<int>(find(group, tag).size());
  }

 private:
  static void collect(const tinyxml2::XMLElement* element, bool is_inside, const std::string& group,
                      const std::string& tag, std::vector<const tinyxml2::XMLElement*>& found) {
    const char* name = element->Attribute("class");
    const bool is_in_group = is_inside || (name != nullptr && name == group);
    if (is_in_group && element->Name() == tag) found.push_back(element);
    for (auto* child = element->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      collect(child, is_in_group, group, tag, found);
    }
  }
  tinyxml2::XMLDocument document_;
};

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace mneme::test
