// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The independent second look: exact distances in double precision, which share no code with the
/// kernels.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme {

/// Two things that overlap, or come closer than the margin.
struct Contact {
  std::string link;
  std::string other;     ///< the name of an obstacle or of another link
  bool is_self = false;  ///< true if `other` is a link
  double distance = 0;   ///< metres between the surfaces; negative by at most the sum of the radii
};

/// The exact geometry behind the spheres of links that touch, or come close.
struct ExactContact {
  double excess = 0;           ///< metres that the spheres stick out at most: of two links the sum
  int approximated_links = 0;  ///< 1, or 2 if both links are approximated by spheres
  double distance = 0;         ///< metres between the exact geometry; 0 if it touches, too
};

/// Nothing if the contact, which is one at `q`, is of links without a sphere approximation. Exact
/// distances from all solids, in double precision: milliseconds for large meshes.
[[nodiscard]] std::optional<ExactContact> find_exact_contact(const Robot& robot, const Scene& scene,
                                                             std::span<const double> q,
                                                             const Contact& contact);

/// True if every state of `path` at `resolution` radians or finer is free, by exact distances in
/// double precision that share no code with the kernels. What CollisionChecker leaves aside is left
/// aside here, too. False for an empty path and for one that leaves the joint limits.
[[nodiscard]] bool is_path_free(const Robot& robot, const Scene& scene,
                                const std::vector<Configuration>& path, double resolution);

/// Keeps a direction of a link within a cone wherever the link goes: what it carries stays upright.
struct OrientationConstraint {
  std::string link;
  Vec3 axis = Vec3::UnitZ();  ///< of unit length, in the link's frame
  Vec3 up = Vec3::UnitZ();    ///< of unit length, in the root link's frame: the cone's axis
  double angle = 0;           ///< radians that `axis` may lean from `up`
};

/// Narrower cones cannot be followed in single precision.
inline constexpr double kLeastTilt = 0.001;  ///< radians
/// Checks keep motions this far inside of the cone, so that no rounding of a path leads out of it.
inline constexpr double kTiltMargin = 1e-5;  ///< radians

/// Radians between the constraint's two directions at `q`, in double precision by link poses. The
/// constraint passes describe_fault().
[[nodiscard]] double tilt(const Robot& robot, const OrientationConstraint& constraint,
                          std::span<const double> q);
/// Largest tilt at states of `path` `resolution` radians or less apart; infinite for 0 or less.
[[nodiscard]] double largest_tilt(const Robot& robot, const OrientationConstraint& constraint,
                                  const std::vector<Configuration>& path, double resolution);
/// Why the robot cannot keep the constraint, or nothing: an unknown link, one that no joint of the
/// group turns, directions that are not of unit length, an angle below kLeastTilt.
[[nodiscard]] std::optional<std::string> describe_fault(const Robot& robot,
                                                        const OrientationConstraint& constraint);

}  // namespace mneme
