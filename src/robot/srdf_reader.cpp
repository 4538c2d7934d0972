// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/srdf_reader.h"

#include <algorithm>

#include <fmt/format.h>

#include "robot/xml_reader.h"

namespace mneme::internal {
namespace {

class SrdfReader {
 public:
  explicit SrdfReader(const std::string& source) : xml_(source) {}

  Result<Srdf> read(std::string_view text);

 private:
  void read_element(const XmlElement& element);
  void read_group(const XmlElement& element);
  SrdfName name(const XmlElement& element, const char* attribute);
  SrdfPair pair(const XmlElement& element, const char* first, const char* second);

  XmlReader xml_;
  Srdf srdf_;
};

Result<Srdf> SrdfReader::read(std::string_view text) {
  tinyxml2::XMLDocument document;
  if (text.size() > kMaxRobotTextSize) xml_.note(1, "the text is longer than 64 MB");
  const XmlElement* robot = xml_.fault() ? nullptr : xml_.read_root(document, text, "robot");
  if (robot != nullptr) {
    srdf_.robot = name(*robot, "name");
    xml_.check_children(*robot, {},
                        {"group", "group_state", "end_effector", "virtual_joint", "passive_joint",
                         "joint_property", "link_sphere_approximation", "disable_collisions",
                         "disable_default_collisions", "enable_collisions"});
    for (const auto* child = robot->FirstChildElement(); child && !xml_.fault();
         child = child->NextSiblingElement()) {
      read_element(*child);
    }
  }
  if (xml_.fault()) return tl::unexpected(*xml_.fault());
  return std::move(srdf_);
}

void SrdfReader::read_element(const XmlElement& element) {
  const std::string_view kind = element.Name();
  if (kind == "group") {
    read_group(element);
  } else if (kind == "end_effector") {
    xml_.check_attributes(element, {"name", "parent_link", "group", "parent_group"});
    srdf_.end_effectors.push_back(name(element, "group"));
  } else if (kind == "virtual_joint") {
    xml_.check_attributes(element, {"name", "type", "parent_frame", "child_link"});
    srdf_.virtual_joints.push_back(name(element, "name"));
  } else if (kind == "passive_joint") {
    xml_.check_attributes(element, {"name"});
    srdf_.passive_joints.push_back(name(element, "name"));
  } else if (kind == "disable_collisions") {
    srdf_.disabled.push_back(pair(element, "link1", "link2"));
  } else if (kind == "enable_collisions") {
    srdf_.enabled.push_back(pair(element, "link1", "link2"));
  } else if (kind == "disable_default_collisions") {
    xml_.check_attributes(element, {"link"});
    srdf_.disabled_links.push_back(name(element, "link"));
  }
}

void SrdfReader::read_group(const XmlElement& element) {
  SrdfGroup group;
  xml_.check_attributes(element, {"name"});
  group.name = name(element, "name");
  xml_.set_context(fmt::format("group '{}'", group.name.name));
  const auto is_same = [&](const SrdfGroup& other) { return other.name.name == group.name.name; };
  if (std::ranges::any_of(srdf_.groups, is_same)) {
    xml_.note(element.GetLineNum(), "it is defined twice");
  }
  xml_.check_children(element, {}, {"joint", "link", "chain", "group", "passive_joint"});
  for (const auto* child = element.FirstChildElement(); child && !xml_.fault();
       child = child->NextSiblingElement()) {
    const std::string_view kind = child->Name();
    if (kind == "chain") {
      xml_.check_attributes(*child, {"base_link", "tip_link"});
      group.chains.push_back(pair(*child, "base_link", "tip_link"));
      continue;
    }
    xml_.check_attributes(*child, {"name"});
    if (kind == "joint") group.joints.push_back(name(*child, "name"));
    if (kind == "link") group.links.push_back(name(*child, "name"));
    if (kind == "group") group.subgroups.push_back(name(*child, "name"));
  }
  xml_.set_context("");
  srdf_.groups.push_back(std::move(group));
}

SrdfName SrdfReader::name(const XmlElement& element, const char* attribute) {
  return {xml_.text(element, attribute), element.GetLineNum()};
}

SrdfPair SrdfReader::pair(const XmlElement& element, const char* first, const char* second) {
  return {name(element, first), name(element, second)};
}

}  // namespace

Result<Srdf> read_srdf(std::string_view text, const std::string& source) {
  return SrdfReader(source).read(text);
}

}  // namespace mneme::internal
