// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sphere approximations: spheres that contain the boxes, cylinders and meshes of a robot, and the
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
  /// Largest distance in metres that a sphere may stick out of the geometry; the mean is about half
  /// of it. Half the value takes three to four times the spheres. Small links get less: 0.4 of the
  /// middle one of their three extents, at least 0.005. 0.001 to 1.
  double excess = 0.015;
  /// Largest number of spheres of a link. Where the excess needs more, it is enlarged. 1 to 1000.
  int max_spheres = 1000;
  /// Replaces `excess`, if it is less, for an arm's fingers and last three links: links with at
  /// least four joints before them and at most two beyond. 0.001 to 1.
  double tip_excess = 0.005;
};

/// Declares the fields' names, ranges and sentences once, for checks and the command line.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, SphereSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit(
      "excess", s.excess, 0.001, 1.0,
      "Largest distance that a sphere may stick out of the geometry, metres. Half the value takes "
      "three to four times the spheres.");
  visit("tip-excess", s.tip_excess, 0.001, 1.0,
        "Replaces the excess for an arm's fingers and last three links, if it is less, metres.");
  visit("max-per-link", s.max_spheres, 1, 1000,
        "Largest number of spheres of a link. Where the excess needs more, it is enlarged.");
}

/// The sphere approximation of one link. Its quality is measured at samples that the search did not
/// use.
struct LinkSpheres {
  std::string link;
  std::vector<Sphere> spheres;  ///< In the link's frame.
  std::vector<Capsule>
      capsules;            ///< In the link's frame: one instead of spheres if it fits as well.
  double uncovered = 0;    ///< Fraction of the surface outside all spheres: 0 as promised.
  double mean_excess = 0;  ///< Mean over the surface of the spheres' union, metres.
  double max_excess = 0;   ///< Largest distance that a sphere sticks out, metres.
};

/// Computes spheres that contain the surface of a link's solids and all that it encloses. Gaps of
/// up to about a hundredth of the link's size count as closed. The inside of a surface with larger
/// holes is decided by the vote of five lines. The result depends on the solids and the settings
/// alone. Errors: a mesh that cannot be used (the message names its file), solids that are not
/// finite or have no surface. Cost: up to seconds.
[[nodiscard]] Result<LinkSpheres> approximate_link(const Link& link,
                                                   const SphereSettings& settings = {});

/// Called each time when the spheres of a link are ready. Links of equal geometry count once.
using SphereProgress = std::function<void(int done, int total, const std::string& link)>;

/// Returns a callback that shows progress in a line of standard error, once it takes longer than
/// half a second; an empty one if that is no terminal.
[[nodiscard]] SphereProgress terminal_progress();

/// A robot whose solids were replaced by spheres.
struct RobotSpheres {
  Robot::Parts parts;              ///< without solids; spheres and capsules stay as they were
  std::vector<LinkSpheres> links;  ///< the links that had solids, in their order
  std::vector<std::string> notes;  ///< for people: one sentence each
};
/// Approximates each link that has solids, several at a time. Calls `on_approximated` for each: one
/// call at a time, from any thread. Caches spheres in $XDG_CACHE_HOME/mneme, or ~/.cache/mneme,
/// under a hash of geometry, settings and the version of the algorithm. Damaged entries are
/// replaced; an unusable cache costs time only. Errors: those of approximate_link().
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
/// Returns the word of an SRDF: "Adjacent", "Always", "Never" or "Default".
[[nodiscard]] std::string_view to_string(AllowedReason reason);

struct AllowedPair {
  std::string first;
  std::string second;
  AllowedReason reason = AllowedReason::adjacent;
};

struct PairSettings {
  int samples = 10000;         ///< random configurations of all joints; > 0
  bool allow_at_rest = false;  ///< also allow pairs in contact where all joints are zero
  std::uint64_t seed = 1;
  bool is_exact = false;  ///< judge contact by the exact geometry behind spheres
};

/// Finds the pairs of links with shapes that need no check, by sampling: each pair once, in the
/// order of the links. `parts` has no solids. Errors: those of make_robot(); no joint to sample.
[[nodiscard]] Result<std::vector<AllowedPair>> derive_allowed_pairs(
    const Robot::Parts& parts, const PairSettings& settings = {});

/// Replaces the allowed pairs of `parts` by derive_allowed_pairs() and then its former ones.
/// Returns the reasons for to_srdf(): to_string(AllowedReason), or "User" for former ones. Errors:
/// those of derive_allowed_pairs().
[[nodiscard]] Result<std::vector<std::string>> allow_derived_pairs(
    Robot::Parts& parts, const PairSettings& settings = {});

struct DerivedSrdf {
  std::string text;
  std::vector<std::string> reasons;  ///< of the allowed pairs, in their order
  std::vector<std::string> notes;    ///< for people: one sentence each
};
/// Writes an SRDF for the URDF at `path`: groups, states and allowed pairs of the SRDF in use, if
/// there is one, and the pairs that need no check. Default: by exact geometry, also pairs in
/// contact at rest, as in MoveIt's Setup Assistant. Errors: those of read_robot(),
/// approximate_robot() and derive_allowed_pairs(). Cost: seconds.
[[nodiscard]] Result<DerivedSrdf> derive_srdf(
    const std::string& path, const RobotOptions& options = {},
    const PairSettings& settings = {.allow_at_rest = true, .is_exact = true},
    const SphereProgress& on_approximated = terminal_progress());

struct ApproximatedRobot {
  Robot robot;
  std::vector<std::string> notes;  ///< for people: one sentence each
};

/// Loads a robot with any collision geometry: as load_robot(), and solids become spheres, at a cost
/// of CPU seconds per arm, with progress on a terminal. The cache makes that milliseconds. Without
/// an SRDF, adjacent pairs are allowed. Pairs that random configurations and a search never part by
/// their exact geometry are allowed, too: with a warning if an SRDF checks them. Where only the
/// spheres of a pair always overlap, it is one of Robot::exact_pairs().
[[nodiscard]] Result<ApproximatedRobot> load_approximated_robot(
    const std::string& path, const RobotOptions& options = {}, const SphereSettings& settings = {},
    const SphereProgress& on_approximated = terminal_progress());

/// Default settings for attached objects.
inline constexpr SphereSettings kObjectSpheres{.excess = 0.015, .max_spheres = 64};

/// Returns the object with its spheres. Spheres and capsules stay as they are. Boxes and cylinders
/// become lattices of at most `max_spheres` spheres each, in microseconds. Meshes are approximated
/// as those of links, with the same cache. The exact geometry is kept, cylinders as enclosing
/// prisms of 48 sides. Errors: no shapes; a shape that is not finite, without size or with a pose
/// that is no rotation; a mesh that cannot be used.
[[nodiscard]] Result<ApproximatedObject> approximate_object(
    AttachedObject object, const SphereSettings& settings = kObjectSpheres);

/// Returns the robot with these objects attached: Robot::with_attached() of their approximations.
[[nodiscard]] Result<Robot> attach(const Robot& robot, std::vector<AttachedObject> objects);

}  // namespace mneme
