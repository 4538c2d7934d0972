// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Independent verification: exact distances in double precision, by code that the kernels do not
/// share.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme {

/// A link and an obstacle, or two links, that overlap or come closer than the margin.
struct Contact {
  std::string link;
  std::string other;     ///< name of an obstacle or of another link
  bool is_self = false;  ///< true if `other` is a link
  double distance = 0;   ///< metres between the surfaces; negative: depth of overlap
  /// True if the overlap may be deeper: depth ends at the center of a sphere of the robot, or at
  /// the axis of a capsule.
  bool may_be_deeper = false;
};

/// The distance by exact geometry of a pair whose spheres are in contact.
struct ExactContact {
  double excess = 0;  ///< largest distance that spheres stick out, metres; summed over both links
  int approximated_links = 0;  ///< 1, or 2 if both links are approximated by spheres
  double distance = 0;         ///< metres between the exact geometries; 0 if they touch
};

/// Measures the pair of `contact` at `q` by exact geometry. Returns nothing if no link of the pair
/// is approximated by spheres, or if robot and scene lack one of its names. Cost: milliseconds for
/// large meshes.
[[nodiscard]] std::optional<ExactContact> find_exact_contact(const Robot& robot, const Scene& scene,
                                                             std::span<const double> q,
                                                             const Contact& contact);

/// True if states of `path`, at most `resolution` radians apart, are free of contact by exact
/// distances in double precision. Ignores the same contacts as CollisionChecker. False for an empty
/// path, for one that leaves the joint limits, and unless `resolution` is positive. A motion
/// between two states of `path` is checked at no more than 1e9 states, however fine the resolution
/// is.
[[nodiscard]] bool is_path_free(const Robot& robot, const Scene& scene,
                                const std::vector<Configuration>& path, double resolution);

/// Exceptions for the ends of a path. The start may exceed limits and be in contact. At the goal
/// only an attached object or a pair of Scene::end_contacts may be in contact. All limits and
/// distances must be kept where the first motion ends and where the last motion begins. A value of
/// 0 allows no exception.
struct EndTolerances {
  double angle = 0.05;    ///< Radians that a start may be beyond limits of joints and cones.
  double length = 0.005;  ///< Metres that a start may be beyond limits of prismatic joints.
  /// Largest overlap of any pair at the start, metres; at most half the radius of the pair's
  /// thinnest shape.
  double depth = 0.001;
  /// Largest distance, metres, that an attached object may move while in contact at start or goal.
  double stretch = 0.005;
};
/// As above, with exceptions at the ends of the path: contact may only decrease along the first
/// motion and only increase along the last motion. Motions with exceptions are checked at no more
/// than 1e6 states.
[[nodiscard]] bool is_path_free(const Robot& robot, const Scene& scene,
                                const std::vector<Configuration>& path, double resolution,
                                const EndTolerances& tolerances);

/// Keeps a direction of a link within a cone, so that a carried glass stays upright.
struct OrientationConstraint {
  std::string link;
  Vec3 axis = Vec3::UnitZ();  ///< unit vector in the link's frame
  Vec3 up = Vec3::UnitZ();    ///< the cone's axis: unit vector in the root link's frame
  double angle = 0;           ///< largest angle between `axis` and `up`, radians
};

/// Least OrientationConstraint::angle, radians: single precision cannot follow a narrower cone.
inline constexpr double kLeastTilt = 0.001;
/// Checks keep motions this far inside the cone, radians, so that rounding a path cannot leave it.
inline constexpr double kTiltMargin = 1e-5;

/// Returns the angle between the constraint's two directions at `q`, radians. Precondition:
/// describe_fault() returns nothing for the constraint.
[[nodiscard]] double tilt(const Robot& robot, const OrientationConstraint& constraint,
                          std::span<const double> q);
/// Returns the largest tilt at states of `path` at most `resolution` radians apart, at no more than
/// 1e9 states between two of `path`. Infinite unless `resolution` is positive and states are
/// numbers.
[[nodiscard]] double largest_tilt(const Robot& robot, const OrientationConstraint& constraint,
                                  const std::vector<Configuration>& path, double resolution);
/// True if states of `path`, at most `resolution` radians apart, keep the constraint. The tilt of a
/// start within the tolerances may only decrease along the first motion. False for an empty path,
/// and unless `resolution` is positive.
[[nodiscard]] bool keeps_cone(const Robot& robot, const OrientationConstraint& constraint,
                              const std::vector<Configuration>& path, double resolution,
                              const EndTolerances& tolerances);
/// Says why the robot cannot keep the constraint; nothing if it can. Faults: an unknown link, a
/// link that no joint of the group turns, a direction that is no unit vector, an angle below
/// kLeastTilt.
[[nodiscard]] std::optional<std::string> describe_fault(const Robot& robot,
                                                        const OrientationConstraint& constraint);

}  // namespace mneme
