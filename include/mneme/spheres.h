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
  /// of this value. Half the value takes three to four times the spheres. Small links get a smaller
  /// limit: 0.4 of the middle one of their three extents, at least 0.005. Range: 0.001 to 1.
  double excess = 0.015;
  /// Largest number of spheres of a link, 1 to 1000. A link that would need more gets a larger
  /// excess.
  int max_spheres = 1000;
  /// Replaces `excess`, if less, for an arm's fingers and last three links, metres, 0.001 to 1.
  /// These are links with at least four joints before them and at most two beyond.
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

/// The sphere approximation of one link. Its quality is measured at samples that the search for
/// spheres did not use.
struct LinkSpheres {
  std::string link;
  std::vector<Sphere> spheres = {};  ///< In the link's frame.
  /// In the link's frame: one capsule instead of spheres where it fits as well.
  std::vector<Capsule> capsules = {};
  double uncovered = 0;    ///< Fraction of the link's surface outside all spheres; 0 is expected.
  double mean_excess = 0;  ///< Mean distance of the spheres' outer surface from the link, metres.
  double max_excess = 0;   ///< Largest distance that a sphere sticks out, metres.
};

/// Computes spheres that contain the surface of a link's solids and everything inside. Gaps of up
/// to about a hundredth of the link's size count as closed. If a surface has larger holes, a vote
/// of five rays decides which points are inside. The result depends on the solids and the settings
/// alone. Errors: a mesh that cannot be used (the message names its file), solids that are not
/// finite or have no surface. Cost: up to seconds.
[[nodiscard]] Result<LinkSpheres> approximate_link(const Link& link,
                                                   const SphereSettings& settings = {});

/// Called whenever the spheres of a link are ready. Links of equal geometry count once.
using SphereProgress = std::function<void(int done, int total, const std::string& link)>;

/// Returns a callback that shows progress on a line of standard error after half a second. Returns
/// an empty callback if standard error is no terminal.
[[nodiscard]] SphereProgress terminal_progress();

/// A robot whose solids were replaced by spheres.
struct RobotSpheres {
  Robot::Parts parts;                   ///< solids replaced by spheres; other spheres and capsules
                                        ///< unchanged
  std::vector<LinkSpheres> links;       ///< the links that had solids, in their order
  std::vector<std::string> notes = {};  ///< for people: one sentence each
};
/// Approximates each link that has solids, several at a time. A cylinder between two spheres of its
/// radius becomes a capsule, which needs no approximation. Calls `on_approximated` for each: one
/// call at a time, from any thread. Caches spheres in $XDG_CACHE_HOME/mneme, or ~/.cache/mneme,
/// under a hash of geometry, settings and the version of the algorithm. Damaged entries are
/// replaced; an unusable cache costs time only. Errors: those of approximate_link().
[[nodiscard]] Result<RobotSpheres> approximate_robot(Robot::Parts parts,
                                                     const SphereSettings& settings = {},
                                                     const SphereProgress& on_approximated = {});

/// Why a pair of links need not be checked.
enum class AllowedReason {
  adjacent,  ///< joined by a joint, directly or by links without shapes, or welded together
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
  bool is_exact = false;  ///< decide contact by exact geometry instead of spheres
};

/// Finds by sampling the pairs of links with shapes that need no check. Returns each pair once, in
/// the order of the links. `parts` must not have solids. Errors: those of make_robot(); no joint to
/// sample.
[[nodiscard]] Result<std::vector<AllowedPair>> derive_allowed_pairs(
    const Robot::Parts& parts, const PairSettings& settings = {});

/// Replaces the allowed pairs of `parts` by those of derive_allowed_pairs(), followed by the former
/// ones. Returns the reasons for to_srdf(): to_string(AllowedReason), or "User" for former ones.
/// Errors: those of derive_allowed_pairs().
[[nodiscard]] Result<std::vector<std::string>> allow_derived_pairs(
    Robot::Parts& parts, const PairSettings& settings = {});

struct DerivedSrdf {
  std::string text;
  std::vector<std::string> reasons;     ///< one per allowed pair, in the order of the pairs
  std::vector<std::string> notes = {};  ///< for people: one sentence each
};
/// Returns an SRDF for the URDF at `path`. If the robot has an SRDF, its groups, states and allowed
/// pairs are kept. Pairs of links that need no check are added. The default settings decide contact
/// by exact geometry and also allow pairs in contact where all joints are zero, as MoveIt's Setup
/// Assistant does. Errors: those of read_robot(), approximate_robot() and derive_allowed_pairs().
/// Cost: seconds.
[[nodiscard]] Result<DerivedSrdf> derive_srdf(
    const std::string& path, const RobotOptions& options = {},
    const PairSettings& settings = {.allow_at_rest = true, .is_exact = true},
    const SphereProgress& on_approximated = terminal_progress());

struct ApproximatedRobot {
  Robot robot;
  std::vector<std::string> notes = {};  ///< for people: one sentence each
};

/// Loads a robot with any collision geometry: as load_robot(), but solids become spheres. Cost: CPU
/// seconds per arm, with progress on a terminal, or milliseconds from the cache. Without an SRDF,
/// adjacent pairs are allowed. A pair is also allowed if its exact geometry is in contact in all
/// random configurations and a search finds no free one: with a note, or a warning if an SRDF
/// checks the pair. A pair of which only the spheres always overlap becomes one of
/// Robot::exact_pairs().
[[nodiscard]] Result<ApproximatedRobot> load_approximated_robot(
    const std::string& path, const RobotOptions& options = {}, const SphereSettings& settings = {},
    const SphereProgress& on_approximated = terminal_progress());

/// Default settings for attached objects.
inline constexpr SphereSettings kObjectSpheres{.excess = 0.015, .max_spheres = 64};

/// Returns the object with spheres for its shapes. Shapes that are spheres or capsules stay as they
/// are. Boxes and cylinders become lattices of at most `max_spheres` spheres each, in microseconds.
/// Meshes are approximated as those of links, with the same cache. The exact geometry is kept,
/// cylinders as enclosing prisms of 48 sides. Errors: no shapes; a shape that is not finite,
/// without size or with a pose that is no rotation; a mesh that cannot be used.
[[nodiscard]] Result<ApproximatedObject> approximate_object(
    AttachedObject object, const SphereSettings& settings = kObjectSpheres);

/// Returns the robot with these objects attached: Robot::with_attached() of their approximations.
[[nodiscard]] Result<Robot> attach(const Robot& robot, std::vector<AttachedObject> objects);

}  // namespace mneme
