// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots of a few joints as URDF text.
#pragma once

#include <string>

namespace mneme::test {

/// Root "world", then fixed "base" (0.5 m up, turned a quarter about z), then joints "lift"
/// (prismatic), "turn" (revolute) and "grip" (prismatic).
inline const std::string kLiftUrdf = R"(<robot name="lifter">
  <link name="world"/>
  <link name="base"/>
  <link name="carriage"/>
  <link name="arm">
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <link name="finger"/>
  <joint name="mount" type="fixed">
    <parent link="world"/><child link="base"/>
    <origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="carriage"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="turn" type="revolute">
    <parent link="carriage"/><child link="arm"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="arm"/><child link="finger"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.05" effort="1" velocity="1"/>
  </joint>
</robot>
)";

}  // namespace mneme::test
