// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots made of parts for the tests of this room.
#pragma once

#include "support/support.h"

namespace mneme::test {

/// Links l0 to l<n>, without shapes; joint j<i> joins l<i-1> to l<i>, is 1 m further along x and
/// turns about z between -2 and 2.
inline Robot::Parts make_bare_chain(int joint_count) {
  Robot::Parts parts;
  parts.name = "chain";
  for (int i = 0; i <= joint_count; ++i) {
    Link link;
    link.name = "l" + std::to_string(i);
    parts.links.push_back(link);
    if (i == 0) continue;
    Joint joint;
    joint.name = "j" + std::to_string(i);
    joint.type = JointType::revolute;
    joint.parent_link = i - 1;
    joint.child_link = i;
    joint.origin.translation = Vec3(1, 0, 0);
    joint.axis = Vec3::UnitZ();
    joint.lower = -2;
    joint.upper = 2;
    parts.joints.push_back(joint);
  }
  return parts;
}

}  // namespace mneme::test
