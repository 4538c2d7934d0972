// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/srdf.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "base/text.h"
#include "input/xml_reader.h"
#include "robot/kinematics.h"
#include "robot/planning_group.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

class SrdfReader {
 public:
  SrdfReader(const std::string& source, bool strict)
      : xml_(source, strict ? XmlReader::Mode::strict : XmlReader::Mode::lenient) {}

  Srdf read(std::string_view text) {
    tinyxml2::XMLDocument document;
    const XmlElement& robot = xml_.read_root(document, text, "robot");
    if (const char* robot_name = robot.Attribute("name")) {
      srdf_.robot = {robot_name, robot.GetLineNum()};
    } else {
      xml_.tolerate(robot, "no name", "attribute 'name' is missing");
    }
    xml_.check_attributes(robot, {"name", "version", "xmlns"});
    xml_.check_children(robot, {},
                        {"group", "group_state", "end_effector", "virtual_joint", "passive_joint",
                         "joint_property", "link_sphere_approximation", "disable_collisions",
                         "disable_default_collisions", "enable_collisions"});
    for (const XmlElement* child : children(robot)) read_element(*child);
    srdf_.warnings = xml_.warnings();
    return std::move(srdf_);
  }

 private:
  void read_element(const XmlElement& element) {
    const std::string_view kind = element.Name();
    if (kind == "group") {
      read_group(element);
    } else if (kind == "group_state") {
      read_state(element);
    } else if (kind == "end_effector") {
      xml_.check_attributes(element, {"name", "parent_link", "group", "parent_group"});
      const bool is_held = element.Attribute("parent_link") != nullptr;
      srdf_.end_effectors.push_back(
          {name(element, "group"), is_held ? name(element, "parent_link") : SrdfName{},
           text_or_empty(element, "name"), text_or_empty(element, "parent_group")});
    } else if (kind == "virtual_joint") {
      read_virtual_joint(element);
    } else if (kind == "passive_joint") {
      xml_.check_attributes(element, {"name"});
      srdf_.passive_joints.push_back(name(element, "name"));
    } else if (kind == "disable_collisions") {
      srdf_.disabled.push_back(link_pair(element));
    } else if (kind == "enable_collisions") {
      srdf_.enabled.push_back(link_pair(element));
    } else if (kind == "disable_default_collisions") {
      xml_.check_attributes(element, {"link"});
      srdf_.disabled_links.push_back(name(element, "link"));
    }
  }

  void read_virtual_joint(const XmlElement& element) {
    xml_.check_attributes(element, {"name", "type", "parent_frame", "child_link"});
    const char* text = element.Attribute("type");
    std::string type = text == nullptr ? "fixed" : text;
    if (type != "fixed" && type != "planar" && type != "floating") {
      xml_.tolerate(element, fmt::format("the type '{}', which counts as floating", type),
                    fmt::format("type '{}' is unknown; expected fixed, planar or floating", type));
      type = "floating";
    }
    const bool has_child = element.Attribute("child_link") != nullptr;
    srdf_.virtual_joints.push_back({name(element, "name"), std::move(type),
                                    text_or_empty(element, "parent_frame"),
                                    has_child ? name(element, "child_link") : SrdfName{}});
  }

  void read_group(const XmlElement& element) {
    SrdfGroup group;
    xml_.check_attributes(element, {"name"});
    group.name = name(element, "name");
    xml_.set_context(fmt::format("group '{}'", group.name.name));
    if (!group_names_.insert(group.name.name).second) {
      xml_.fail(element.GetLineNum(), "it is defined twice");
    }
    xml_.check_children(element, {}, {"joint", "link", "chain", "group", "passive_joint"});
    for (const XmlElement* child : children(element)) {
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

  void read_state(const XmlElement& element) {
    xml_.check_attributes(element, {"name", "group"});
    SrdfState state{name(element, "name"), "", {}};
    if (const char* group = element.Attribute("group")) {
      state.group = group;
    } else {
      xml_.tolerate(element, "no group", "attribute 'group' is missing");
    }
    xml_.set_context(fmt::format("group_state '{}'", state.name.name));
    xml_.check_children(element, {}, {"joint"});
    for (const XmlElement* child : children(element, "joint")) {
      xml_.check_attributes(*child, {"name", "value"});
      SrdfName joint = name(*child, "name");
      if (has_several_values(*child)) {
        xml_.tolerate(*child,
                      fmt::format("joint '{}' has several values and is ignored", joint.name),
                      "value has several numbers, expected one");
      } else {
        state.joints.emplace_back(std::move(joint), xml_.number(*child, "value"));
      }
    }
    xml_.set_context("");
    srdf_.states.push_back(std::move(state));
  }

  /// As a planar or floating joint has.
  bool has_several_values(const XmlElement& joint) {
    return split_words(xml_.text(joint, "value")).size() > 1;
  }

  static std::string text_or_empty(const XmlElement& element, const char* attribute) {
    const char* text = element.Attribute(attribute);
    return text == nullptr ? "" : text;
  }

  SrdfName name(const XmlElement& element, const char* attribute) {
    return {xml_.text(element, attribute), element.GetLineNum()};
  }

  SrdfPair link_pair(const XmlElement& element) {
    xml_.check_attributes(element, {"link1", "link2", "reason"});
    xml_.check_children(element, {}, {});
    return pair(element, "link1", "link2");
  }

  SrdfPair pair(const XmlElement& element, const char* first, const char* second) {
    return {name(element, first), name(element, second)};
  }

  XmlReader xml_;
  Srdf srdf_;
  std::set<std::string> group_names_;
};

}  // namespace

Result<Srdf> read_srdf(std::string_view text, const std::string& source, bool strict) {
  return without_throwing([&] { return SrdfReader(source, strict).read(text); });
}

namespace {

using NamedPair = std::pair<std::string, std::string>;

std::set<std::string_view> names_of(const std::vector<SrdfName>& list) {
  std::set<std::string_view> names;
  for (const SrdfName& entry : list) names.insert(entry.name);
  return names;
}

NamedPair ordered(const std::string& a, const std::string& b) {
  return a < b ? NamedPair(a, b) : NamedPair(b, a);
}

/// Radians or metres by which the value of a follower in a state may differ: files round.
constexpr double kStateTolerance = 1e-3;

/// Looks up the names of one SRDF in one robot.
class SrdfLookup {
 public:
  SrdfLookup(const Srdf& srdf, const std::string& source, Robot::Parts& parts)
      : srdf_(srdf), source_(source), parts_(parts) {
    for (const Link& link : parts.links) links_.emplace(link.name, static_cast<int>(links_.size()));
    for (const Joint& joint : parts.joints) joints_.insert(joint.name);
    for (const SrdfVirtualJoint& joint : srdf.virtual_joints) joints_.insert(joint.name.name);
    for (const SrdfGroup& group : srdf.groups) groups_.emplace(group.name.name, &group);
  }

  void add_groups() {
    std::set<std::string_view> end_effectors;
    for (const SrdfEndEffector& each : srdf_.end_effectors) end_effectors.insert(each.group.name);
    const std::set<std::string_view> passive = names_of(srdf_.passive_joints);
    std::set<std::string_view> moving_virtual;
    std::set<std::string> left_out;
    for (const SrdfVirtualJoint& joint : srdf_.virtual_joints) {
      if (!joint.is_fixed()) moving_virtual.insert(joint.name.name);
    }
    for (const SrdfGroup& group : srdf_.groups) {
      const std::set<std::string> joints = all_joints(group);
      JointGroup added{group.name.name, {}, end_effectors.contains(group.name.name)};
      const auto moving = std::ranges::find_if(
          joints, [&](const std::string& joint) { return moving_virtual.contains(joint); });
      if (moving != joints.end()) added.virtual_joint = *moving;
      const bool is_chain = group.chains.size() == 1 && group.joints.empty() &&
                            group.links.empty() && group.subgroups.empty();
      if (is_chain) {
        added.base = group.chains.front().first.name;
        added.tip = group.chains.front().second.name;
      }
      for (const Joint& joint : parts_.joints) {
        if (!is_free(joint) || !joints.contains(joint.name)) continue;
        if (passive.contains(joint.name)) {
          left_out.insert(joint.name);
        } else {
          added.joints.push_back(joint.name);
        }
      }
      parts_.groups.push_back(std::move(added));
    }
    if (left_out.empty()) return;
    parts_.warnings.push_back(fmt::format(
        "{}: <passive_joint> leaves {} out of the groups of the SRDF, which do not plan for it",
        source_, fmt::join(left_out, ", ")));
  }

  void find_root_frame() {
    for (const SrdfVirtualJoint& joint : srdf_.virtual_joints) {
      const bool is_root = joint.child.name.empty() || joint.child.name == parts_.links[0].name;
      if (joint.is_fixed() && is_root) parts_.root_frame = joint.frame;
    }
  }

  void add_other_parts() {
    for (const SrdfEndEffector& each : srdf_.end_effectors) {
      parts_.end_effectors.push_back(
          {each.name, each.group.name, each.holder.name, each.parent_group});
    }
    for (const SrdfVirtualJoint& joint : srdf_.virtual_joints) {
      parts_.virtual_joints.push_back({joint.name.name, joint.type, joint.frame, joint.child.name});
    }
    for (const SrdfName& joint : srdf_.passive_joints) parts_.passive_joints.push_back(joint.name);
  }

  void add_states() {
    for (const SrdfState& state : srdf_.states) {
      NamedState added{state.name.name, state.group, {}};
      for (const auto& [joint, value] : state.joints) {
        if (has_joint(joint)) added.values[joint.name] = value;
      }
      check_followers(state, added.values);
      parts_.states.push_back(std::move(added));
    }
  }

  void add_allowed_pairs() {
    std::set<NamedPair> allowed;
    std::set<std::string_view> disabled;
    for (const SrdfName& name : srdf_.disabled_links) {
      if (!find_link(name) || !disabled.insert(name.name).second) continue;
      for (const Link& link : parts_.links) {
        if (link.name != name.name) allowed.insert(ordered(link.name, name.name));
      }
    }
    for (const SrdfPair& pair : srdf_.enabled) {
      if (const auto named = find_pair(pair)) allowed.erase(*named);
    }
    for (const SrdfPair& pair : srdf_.disabled) {
      if (auto named = find_pair(pair)) allowed.insert(*std::move(named));
    }
    parts_.allowed_pairs.emplace(allowed.begin(), allowed.end());
  }

  /// Warns of names that are not used. Returns the first warning that is an error if strict, empty
  /// if none.
  const std::string& check_other_names() {
    for (const SrdfName& joint : srdf_.passive_joints) has_joint(joint);
    for (const SrdfEndEffector& each : srdf_.end_effectors) {
      if (!each.holder.name.empty()) find_link(each.holder);
      check_group(each.group);
    }
    for (const SrdfVirtualJoint& joint : srdf_.virtual_joints) {
      if (!joint.child.name.empty()) find_link(joint.child);
    }
    for (const SrdfState& state : srdf_.states) {
      if (!state.group.empty()) check_group({state.group, state.name.line});
    }
    return first_fault_;
  }

 private:
  /// Values of followers are not used.
  void check_followers(const SrdfState& state, const std::map<std::string, double>& values) {
    for (const Joint& joint : parts_.joints) {
      if (!joint.mimic) continue;
      const std::string& leader = parts_.joints[as_index(joint.mimic->joint)].name;
      const auto own = values.find(joint.name), leading = values.find(leader);
      if (own == values.end() || leading == values.end()) continue;
      const double follows = joint.mimic->multiplier * leading->second + joint.mimic->offset;
      if (std::abs(own->second - follows) <= kStateTolerance) continue;
      add_warning(fmt::format(
          "{}:{}: group_state '{}': joint '{}' follows '{}', which brings it to {:.6g}; its value "
          "{:.6g} is ignored",
          source_, state.name.line, state.name.name, joint.name, leader, follows, own->second));
    }
  }

  void add_warning(std::string text) {
    parts_.warnings.push_back(std::move(text));
    if (first_fault_.empty()) first_fault_ = parts_.warnings.back();
  }

  void check_group(const SrdfName& name) {
    if (!groups_.contains(name.name)) warn(name, "group");
  }

  void warn(const SrdfName& name, const char* kind) {
    if (!warned_.insert(fmt::format("{} {}", kind, name.name)).second) return;
    add_warning(fmt::format("{}:{}: robot '{}' has no {} '{}'", source_, name.line, parts_.name,
                            kind, name.name));
  }

  std::optional<int> find_link(const SrdfName& name) {
    const auto found = links_.find(name.name);
    if (found != links_.end()) return found->second;
    warn(name, "link");
    return std::nullopt;
  }

  bool has_joint(const SrdfName& name) {
    const bool is_there = joints_.contains(name.name);
    if (!is_there) warn(name, "joint");
    return is_there;
  }

  std::optional<NamedPair> find_pair(const SrdfPair& pair) {
    const auto first = find_link(pair.first), second = find_link(pair.second);
    if (!first || !second) return std::nullopt;
    return ordered(pair.first.name, pair.second.name);
  }

  /// The joints of a group without those of its subgroups.
  const std::set<std::string>& own_joints(const SrdfGroup& group) {
    const auto [found, is_new] = own_joints_.try_emplace(&group);
    if (is_new) add_joints(group, found->second);
    return found->second;
  }

  void add_joints(const SrdfGroup& group, std::set<std::string>& joints) {
    for (const SrdfName& joint : group.joints) {
      if (has_joint(joint)) joints.insert(joint.name);
    }
    for (const SrdfName& name : group.links) {
      const auto link = find_link(name);
      if (!link) continue;
      if (*link == 0) {  // a virtual joint carries the root
        for (const SrdfVirtualJoint& joint : srdf_.virtual_joints) joints.insert(joint.name.name);
        continue;
      }
      joints.insert(parts_.joints[as_index(*link - 1)].name);
    }
    for (const SrdfPair& chain : group.chains) {
      const auto base = find_link(chain.first), tip = find_link(chain.second);
      if (!base || !tip) continue;
      for (std::string& joint : joints_between(parts_.links, parts_.joints, *base, *tip)) {
        joints.insert(std::move(joint));
      }
    }
  }

  /// The joints of a group and its subgroups.
  std::set<std::string> all_joints(const SrdfGroup& group) {
    std::set<std::string> joints;
    std::vector<const SrdfGroup*> family{&group};
    std::set<const SrdfGroup*> seen{&group};
    for (std::size_t i = 0; i < family.size(); ++i) {
      const std::set<std::string>& own = own_joints(*family[i]);
      joints.insert(own.begin(), own.end());
      for (const SrdfName& name : family[i]->subgroups) {
        const auto subgroup = groups_.find(name.name);
        if (subgroup == groups_.end()) {
          warn(name, "group");
        } else if (seen.insert(subgroup->second).second) {
          family.push_back(subgroup->second);
        }
      }
    }
    return joints;
  }

  const Srdf& srdf_;
  const std::string& source_;
  Robot::Parts& parts_;
  std::map<std::string_view, int> links_;
  std::set<std::string_view> joints_;
  std::map<std::string_view, const SrdfGroup*> groups_;
  std::map<const SrdfGroup*, std::set<std::string>> own_joints_;
  std::set<std::string> warned_;
  std::string first_fault_;
};

}  // namespace

Result<void> apply_srdf(std::string_view text, const std::string& source, Robot::Parts& parts,
                        bool strict) {
  const Srdf srdf = MNEME_TRY(read_srdf(text, source, strict));
  parts.warnings.insert(parts.warnings.end(), srdf.warnings.begin(), srdf.warnings.end());
  if (!srdf.robot.name.empty() && srdf.robot.name != parts.name) {
    parts.warnings.push_back(fmt::format("{}:{}: this SRDF is for robot '{}', not for '{}'", source,
                                         srdf.robot.line, srdf.robot.name, parts.name));
  }
  SrdfLookup lookup(srdf, source, parts);
  lookup.add_groups();
  lookup.add_states();
  lookup.add_other_parts();
  lookup.find_root_frame();
  lookup.add_allowed_pairs();
  const std::string& fault = lookup.check_other_names();
  if (strict && !fault.empty()) return fail(ErrorCode::invalid, fault);
  return {};
}

}  // namespace mneme::internal
