// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The elements of an SRDF that matter for planning.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mneme/base.h"

namespace mneme::internal {

/// A name in an SRDF, and where it stands.
struct SrdfName {
  std::string name;
  int line = 0;
};

/// Two links: the ends of a chain, or what may touch.
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

struct Srdf {
  SrdfName robot;
  std::vector<SrdfGroup> groups;
  std::vector<SrdfName> end_effectors;   ///< names of their groups
  std::vector<SrdfName> virtual_joints;  ///< which connect the robot to the world
  std::vector<SrdfName> passive_joints;  ///< which cannot be planned for
  std::vector<SrdfPair> disabled;        ///< links that may touch each other
  std::vector<SrdfName> disabled_links;  ///< links that may touch all others, except `enabled`
  std::vector<SrdfPair> enabled;
};

/// Strict about XML, elements and attributes; names need not exist in a robot. States of groups are
/// left out.
[[nodiscard]] Result<Srdf> read_srdf(std::string_view text, const std::string& source);

}  // namespace mneme::internal
