// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// SRDF: groups, states and allowed contacts of a robot.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A name in an SRDF with its line.
struct SrdfName {
  std::string name;
  int line = 0;
};

/// Two links: the ends of a chain, or a pair that may touch.
struct SrdfPair {
  SrdfName first, second;
};

struct SrdfGroup {
  SrdfName name;
  std::vector<SrdfName> joints;     ///< these joints
  std::vector<SrdfName> links;      ///< the joints that carry these links
  std::vector<SrdfPair> chains;     ///< the joints between base_link and tip_link
  std::vector<SrdfName> subgroups;  ///< the joints of these groups
};

struct SrdfState {
  SrdfName name;
  std::string group;  ///< Empty: none.
  std::vector<std::pair<SrdfName, double>> joints;
};

struct SrdfEndEffector {
  SrdfName group;
  SrdfName holder;                 ///< The link that holds it; an empty name if it has none.
  std::string name, parent_group;  ///< Empty: none.
};

/// A joint between the world and the robot.
struct SrdfVirtualJoint {
  SrdfName name;
  std::string type;   ///< fixed, planar or floating
  std::string frame;  ///< The frame of the world that it is in; empty if it has none.
  SrdfName child;     ///< The link that it carries; an empty name if it has none.

  [[nodiscard]] bool is_fixed() const { return type == "fixed"; }
};

struct Srdf {
  SrdfName robot;
  std::vector<SrdfGroup> groups;
  std::vector<SrdfEndEffector> end_effectors;
  std::vector<SrdfVirtualJoint> virtual_joints;
  std::vector<SrdfName> passive_joints;  ///< joints that cannot be planned for
  std::vector<SrdfPair> disabled;        ///< links that may touch each other
  std::vector<SrdfName> disabled_links;  ///< links that may touch all others, except `enabled`
  std::vector<SrdfPair> enabled;
  std::vector<SrdfState> states;      ///< of joints with one value
  std::vector<std::string> warnings;  ///< such as text between elements
};

/// Reads an SRDF without a robot. Text between elements, unknown elements and attributes are
/// warnings, or errors if `strict`.
[[nodiscard]] Result<Srdf> read_srdf(std::string_view text, const std::string& source,
                                     bool strict = false);

/// Adds the groups, states, joints, allowed pairs and warnings of an SRDF to `parts`, which are in
/// tree order. Each name that the robot lacks is ignored with a warning, or an error if `strict`.
[[nodiscard]] Result<void> apply_srdf(std::string_view text, const std::string& source,
                                      Robot::Parts& parts, bool strict = false);

}  // namespace mneme::internal
