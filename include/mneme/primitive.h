// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Local primitives: the pieces of a workspace that experience is bound to.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mneme {

/// The numbers that describe a primitive in the robot's base frame; which, is the business of its
/// kind of memory (mneme/memory.h).
using PrimitiveKey = std::vector<double>;

/// A motion of the workspace that a motion of the leading joints undoes: first the mirror image y
/// -> -y (which negates all joints of a planar arm), then a rotation about the axis of the turning
/// joint and a shift along it.
struct Symmetry {
  double rotation = 0;  ///< radians
  bool is_mirrored = false;
  double lift = 0;  ///< metres along z
};
/// The motion that undoes `motion`.
[[nodiscard]] Symmetry inverse(const Symmetry& motion);
/// `first`, then `second`, as one motion.
[[nodiscard]] Symmetry compose(const Symmetry& second, const Symmetry& first);

/// The leading joints of a robot that move all the rest of it rigidly; what stands before them on
/// the tree, such as a base or a head, is not moved by any symmetry.
struct SymmetricJoints {
  int turn = -1;                  ///< index into a configuration of the joint about z, or -1
  int lift = -1;                  ///< of the prismatic joint along z, or -1
  double axis_x = 0, axis_y = 0;  ///< where the axis of `turn` meets the plane z = 0, metres
};
/// Finds them in the kinematics: along the chain from the root, a prismatic joint along the root's
/// z and a revolute or continuous one about it, in either order, that carry all further joints of
/// the group. A planar arm has joint 1; Fetch has torso lift and shoulder pan. O(links).
[[nodiscard]] SymmetricJoints find_symmetric_joints(const Robot& robot);

/// The configuration whose moving links are those of `q`, moved by `motion`. The turning joint is
/// wrapped to [-pi, pi); limits are the caller's business.
[[nodiscard]] Configuration moved_configuration(const SymmetricJoints& joints,
                                                const Symmetry& motion, std::span<const double> q);
/// The pair of circles `key`, moved by `motion`.
[[nodiscard]] PrimitiveKey moved_key(const Symmetry& motion, const PrimitiveKey& key);

/// A local primitive lw_i of a scene.
struct LocalPrimitive {
  std::vector<int>
      obstacles;  ///< indices into the scene; of make_scene(key) if it came from make_primitive()
  std::string kind;   ///< MemoryKind::version of the kind of memory that the key is of
  PrimitiveKey key;   ///< canonical: the midpoint of the two centres lies on the positive x axis
                      ///< (seen from the axis of the turning joint) and, with a lift, at z = 0
  Symmetry to_scene;  ///< takes the canonical primitive to the scene
  double gap = 0;     ///< metres between the two obstacles
};

/// One of the ways to write down the same canonical primitive, such as the other order of a pair. A
/// lookup queries each of them, because choosing one would make the key jump where two are nearly
/// equal.
struct KeyImage {
  PrimitiveKey key;
  bool is_mirrored = false;
};
}  // namespace mneme
