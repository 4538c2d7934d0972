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

/// A joint between the world and the robot.
struct SrdfVirtualJoint {
  SrdfName name;
  bool is_fixed = true;
  std::string frame;  ///< The frame of the world that it is in; empty if it has none.
  SrdfName child;     ///< The link that it carries; an empty name if it has none.
};

struct Srdf {
  SrdfName robot;
  std::vector<SrdfGroup> groups;
  std::vector<SrdfName> end_effectors;  ///< names of the groups of end effectors
  std::vector<SrdfName> holders;        ///< links that hold end effectors
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

/// Adds the groups, states, allowed pairs and warnings of an SRDF to `parts`, which are in tree
/// order. Each name that the robot lacks is ignored with a warning, or an error if `strict`.
[[nodiscard]] Result<void> apply_srdf(std::string_view text, const std::string& source,
                                      Robot::Parts& parts, bool strict = false);

}  // namespace mneme::internal
