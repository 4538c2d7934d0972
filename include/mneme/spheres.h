// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sphere approximations: spheres that hold the boxes, cylinders and meshes of a robot, and the
/// pairs of links that need no check.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mneme {

struct SphereSettings {
  /// Metres that a sphere may stick out of the solids. Halving it takes three to four times as many
  /// spheres; about half of it is the mean. Small links are given less: 0.4 of the middle one of
  /// their three extents, though not less than 0.005. 0.001 to 1.
  double excess = 0.015;
  /// Spheres a link may have; where the excess needs more, it is enlarged for that link. 1 to 1000.
  int max_spheres = 1000;
  /// The same as `excess`, if that is not less, for an arm's fingers and last three links: those
  /// with at least four joints before them and at most two beyond. 0.001 to 1.
  double tip_excess = 0.005;
};

/// Declares the fields' names, ranges and sentences once, for checks and the command line.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, SphereSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("excess", s.excess, 0.001, 1.0,
        "metres that a sphere may stick out of the geometry; halving it takes three to four times "
        "as many spheres");
  visit("tip-excess", s.tip_excess, 0.001, 1.0,
        "the same for an arm's fingers and last three links, if it is less");
  visit("max-per-link", s.max_spheres, 1, 1000,
        "spheres a link may have; where the excess needs more, it is enlarged for that link");
}

/// The sphere approximation of one link, measured by samples that the search did not use.
struct LinkSpheres {
  std::string link;
  std::vector<Sphere> spheres;  ///< in the link's frame
  double uncovered = 0;         ///< fraction of the surface outside all spheres; 0 is promised
  double mean_excess = 0;       ///< metres that the spheres' common skin is outside the solids
  double max_excess = 0;        ///< metres
};

/// Spheres around the surface of a link's solids and all that it encloses: what cannot be reached
/// from outside through gaps of more than about a hundredth of the link's size, and what lies
/// within a surface with holes, by the vote of five lines. Takes up to seconds; the result depends
/// on the solids and the settings alone. Errors: a mesh that cannot be used (the message names its
/// file), solids without any surface or not finite.
[[nodiscard]] Result<LinkSpheres> approximate_link(const Link& link,
                                                   const SphereSettings& settings = {});

/// Called when a link has its spheres.
using SphereProgress = std::function<void(int done, int total, const std::string& link)>;

/// A robot whose solids have become spheres.
struct RobotSpheres {
  Robot::Parts parts;              ///< without solids; spheres and capsules stay as they were
  std::vector<LinkSpheres> links;  ///< the links that had solids, in their order
  std::vector<std::string> notes;  ///< what was done, for people: one sentence each
};
/// Approximates each link that has solids, several at a time, and calls `on_approximated` for each:
/// one call at a time, from any thread. Spheres are kept in $XDG_CACHE_HOME/mneme, or
/// ~/.cache/mneme, named by a hash of geometry, settings and the version of the algorithm. A
/// damaged entry is replaced; a cache that cannot be used costs time only.
[[nodiscard]] Result<RobotSpheres> approximate_robot(Robot::Parts parts,
                                                     const SphereSettings& settings = {},
                                                     const SphereProgress& on_approximated = {});

/// Why a pair of links need not be checked.
enum class AllowedReason {
  adjacent,  ///< joined by a joint, by welded links or by links without shapes
  always,    ///< in contact in every sample
  never,     ///< in contact in no sample
  at_rest,   ///< in contact where all joints are zero
};
/// The word for it in an SRDF: "Adjacent", "Always", "Never" or "Default".
[[nodiscard]] std::string_view to_string(AllowedReason reason);

struct AllowedPair {
  std::string first;
  std::string second;
  AllowedReason reason = AllowedReason::adjacent;
};

struct PairSettings {
  int samples = 10000;         ///< random configurations of all joints; > 0
  bool allow_at_rest = false;  ///< also allow what touches where all joints are zero
  std::uint64_t seed = 1;
};

/// The pairs of links with shapes that need not be checked, found by sampling; each pair once, in
/// the order of the links. The parts have no solids. Errors: those of make_robot; no joint to
/// sample.
[[nodiscard]] Result<std::vector<AllowedPair>> derive_allowed_pairs(
    const Robot::Parts& parts, const PairSettings& settings = {});

struct ApproximatedRobot {
  Robot robot;
  std::vector<std::string> notes;  ///< what was done, for people: one sentence each
};

/// load_robot for robots with any collision geometry: solids become spheres, and without an SRDF
/// the pairs that are adjacent or always in contact are allowed. Pairs that an SRDF checks although
/// no configuration parts them are allowed too, with a warning.
[[nodiscard]] Result<ApproximatedRobot> load_approximated_robot(
    const std::string& path, const RobotOptions& options = {}, const SphereSettings& settings = {},
    const SphereProgress& on_approximated = {});

/// Settings for attached objects.
inline constexpr SphereSettings kObjectSpheres{.excess = 0.015, .max_spheres = 64};

/// The object with its spheres: spheres and capsules as they are; boxes and cylinders, in
/// microseconds, by lattices of spheres, at most `max_spheres` each; meshes as those of links, from
/// the cache if they are known there. The exact geometry is kept, cylinders as prisms of 48
/// sides around them. Errors: an object without shapes, or with one that
/// is not finite, without size or posed by no rotation; a mesh that cannot be used.
[[nodiscard]] Result<ApproximatedObject> approximate_object(
    AttachedObject object, const SphereSettings& settings = kObjectSpheres);

/// Robot::with_attached of the objects' sphere approximations.
[[nodiscard]] Result<Robot> attach(const Robot& robot, std::vector<AttachedObject> objects);

}  // namespace mneme
