// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Local primitives: the pieces of a workspace that experience is bound to.
#pragma once

#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

namespace mneme {

/// The numbers that describe a primitive in the robot's base frame; metres.
/// For a pair of circles (x_a, y_a, r_a, x_b, y_b, r_b), as in the paper.
using PrimitiveKey = std::vector<double>;

/// A motion of the workspace that a motion of the leading joints undoes: first the mirror image y
/// -> -y (which negates all joints of a planar arm), then a rotation about the base's z axis (which
/// adds to joint 1).
struct Symmetry {
  double rotation = 0;  ///< radians
  bool is_mirrored = false;
};
/// The motion that undoes `motion`.
[[nodiscard]] Symmetry inverse(const Symmetry& motion);
/// `first`, then `second`, as one motion.
[[nodiscard]] Symmetry compose(const Symmetry& second, const Symmetry& first);
/// The configuration whose body is that of `q`, moved by `motion`. Joint 1 is wrapped to [-pi, pi).
[[nodiscard]] Configuration moved_configuration(const Symmetry& motion, std::span<const double> q);
/// The pair of circles `key`, moved by `motion`.
[[nodiscard]] PrimitiveKey moved_key(const Symmetry& motion, const PrimitiveKey& key);

/// A local primitive lw_i of a scene.
struct LocalPrimitive {
  std::vector<int>
      obstacles;  ///< indices into the scene; of make_scene(key) if it came from make_primitive()
  PrimitiveKey key;   ///< canonical: the midpoint of the two centres lies on the positive x axis
  Symmetry to_scene;  ///< takes the canonical primitive to the scene
  double gap = 0;     ///< metres between the two obstacles
};

struct DecomposeSettings {
  std::string decomposer = "pairs";
  double max_gap = 1.0;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, DecomposeSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("max-gap", s.max_gap, 0.0, 1e6,
        "two obstacles at most this far apart (metres, between surfaces) form a primitive");
}

/// Algorithm 2, line 1: the pairs of circles whose gap is positive and at most `max_gap` and that
/// the robot can reach, in scene order. Two circles that overlap leave no passage and form no
/// primitive. Errors: an unknown decomposer; a robot or obstacles that it does not handle.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose(const Robot& robot, const Scene& scene,
                                                            const DecomposeSettings& settings = {});

/// Name and version of a decomposer: experience is keyed to it, because a key means nothing without
/// it.
[[nodiscard]] Result<std::string> decomposer_version(const std::string& decomposer);

/// Brings a pair of circles to canonical form.
[[nodiscard]] LocalPrimitive make_primitive(const PrimitiveKey& circles);
/// The two circles of a key as a scene of their own.
[[nodiscard]] Scene make_scene(const PrimitiveKey& key);

/// One of the ways to write down the same canonical primitive: either order, either mirror image.
struct KeyImage {
  PrimitiveKey key;
  bool is_mirrored = false;
};
/// All images of a canonical key, that key first. A lookup queries each of them, because sorting
/// the pair instead would make the key jump where two circles are nearly equal.
[[nodiscard]] std::vector<KeyImage> images(const PrimitiveKey& canonical);

/// The paper's similarity error: squared Euclidean distance of two canonical keys, the least over
/// the images of one of them. m^2.
[[nodiscard]] double similarity_error(const PrimitiveKey& a, const PrimitiveKey& b);

}  // namespace mneme
