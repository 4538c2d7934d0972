// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The shapes of links as capsules: a sphere is one of length 0.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <vector>

namespace mneme::internal {

[[nodiscard]] bool has_shapes(const Link& link);

/// Spheres first, in the link's frame.
[[nodiscard]] std::vector<Capsule> shapes_of(const Link& link);
/// The same in the frame that X_WL takes the link to.
[[nodiscard]] std::vector<Capsule> shapes_of(const Link& link, const Transform& X_WL);

[[nodiscard]] Capsule moved(const Capsule& capsule, const Transform& X_WL);

/// A sphere that holds all shapes, about the middle of the box that holds their axes; a point
/// without any.
[[nodiscard]] Sphere bound_of(std::span<const Capsule> shapes);

/// Metres from the root's origin that no shape of the robot leaves within its limits.
[[nodiscard]] double farthest_reach(const Robot& robot);

}  // namespace mneme::internal
