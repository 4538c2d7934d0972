// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Local primitives: the pieces of a workspace that experience is bound to.
#pragma once

#include <array>
#include <concepts>
#include <optional>
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
/// Of the decomposer "pairs" (x_a, y_a, r_a, x_b, y_b, r_b), as in the paper. Of "body_pairs" two
/// blocks of kBodyKeySize numbers: see body_key(). Of "gaps" kGapKeySize numbers: see gap_key().
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
  PrimitiveKey key;   ///< canonical: the midpoint of the two centres lies on the positive x axis
                      ///< (seen from the axis of the turning joint) and, with a lift, at z = 0
  Symmetry to_scene;  ///< takes the canonical primitive to the scene
  double gap = 0;     ///< metres between the two obstacles
};

struct DecomposeSettings {
  std::string decomposer;  ///< one of decomposer_names(); empty: see decompose()
  double max_gap = 0;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, DecomposeSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("max-gap", s.max_gap, 0.0, 1e6,
        "two obstacles at most this far apart (metres, between surfaces) form a primitive; 0 picks "
        "the decomposer's default (1 for pairs of circles, 0.25 for body_pairs and gaps)");
}

/// Algorithm 2, line 1: the pairs of obstacles whose gap is at most `max_gap`, in scene order. An
/// empty `decomposer` is the robot's own: "pairs" for planar arms, which needs spheres in the plane
/// and leaves out pairs that overlap or that the arm cannot reach; "body_pairs" for all others,
/// which takes obstacles of any shapes, touching ones too. "gaps" takes pairs of any shapes that
/// leave a passage for the thinnest part of the robot, together with the obstacles that bound that
/// passage: those that a ray from its middle, at right angles to the line between the pair, meets
/// first, within kGapReach. Errors: an unknown decomposer; a robot or obstacles that it does not
/// handle; "paths", whose primitives are whole queries.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose(const Robot& robot, const Scene& scene,
                                                            const DecomposeSettings& settings = {});

/// Name and version of a decomposer: experience is keyed to it, because a key means nothing without
/// it.
[[nodiscard]] Result<std::string> decomposer_version(const std::string& decomposer);
/// All decomposers.
[[nodiscard]] std::vector<std::string> decomposer_names();
/// The decomposer that makes keys of this version, or nothing if there is none.
[[nodiscard]] std::optional<std::string> decomposer_of_version(std::string_view version);
/// The decomposer of a robot: "pairs" or "body_pairs".
[[nodiscard]] std::string default_decomposer(const Robot& robot);

/// Numbers of one obstacle in a key of the decomposer "body_pairs".
inline constexpr int kBodyKeySize = 9;
/// An obstacle as numbers, all in metres and all alike under the Euclidean norm, whatever its
/// shapes: its centroid c (x, y, z), then the square root S of three times the covariance of its
/// volume (xx, yy, zz, and sqrt(2) times xy, xz, yz). S of a box with half extents h and rotation R
/// is R diag(h) R^T, so that no order or sign of its axes matters; a cylinder has sqrt(3)/2 of its
/// radius and half its length, a sphere sqrt(3/5) of its radius. Shapes of one obstacle are summed
/// by volume.
[[nodiscard]] std::array<double, kBodyKeySize> body_key(const Obstacle& obstacle);
/// Brings a pair of bodies to canonical form.
[[nodiscard]] LocalPrimitive make_body_primitive(const SymmetricJoints& joints, const Obstacle& a,
                                                 const Obstacle& b);

/// Numbers in a key of the decomposer "gaps": the middle of the passage and 3 x 3 x 3 distances.
inline constexpr int kGapKeySize = 30;
inline constexpr double kGapReach = 0.25;        ///< metres from the middle that matter to a gap
inline constexpr double kGapProbeSpacing = 0.1;  ///< metres between the points of gap_key()
/// The place and the surroundings of a passage as numbers, all in metres and alike under the
/// Euclidean norm: its middle, then a third of the distances, each at most kGapReach, from the
/// points of a grid around the middle to the nearest obstacle (0 inside one). The grid has the axes
/// of `rotation` and kGapProbeSpacing; its last axis counts fastest. Whatever the obstacles'
/// shapes, number and order, surfaces that move by less than e change the distances' share of the
/// norm by less than sqrt(3) e; what is out of reach changes nothing, so that keys of unlike
/// shelves agree where their passages do.
[[nodiscard]] PrimitiveKey gap_key(std::span<const Obstacle> obstacles, const Vec3& middle,
                                   const Eigen::Matrix3d& rotation);

/// Brings a pair of circles to canonical form.
[[nodiscard]] LocalPrimitive make_primitive(const PrimitiveKey& circles);
/// The two circles of a key as a scene of their own.
[[nodiscard]] Scene make_scene(const PrimitiveKey& key);

/// A whole query as a primitive, for memory of whole paths (decomposer "paths"): its key holds both
/// configurations, a continuous joint as its cosine and sine, and before them the distance between
/// these two rows. The two images are the query and its reverse; no obstacles count.
[[nodiscard]] LocalPrimitive make_query_primitive(const Robot& robot, std::span<const double> start,
                                                  std::span<const double> goal);
/// Numbers in such a key: odd, unlike those of the other decomposers.
[[nodiscard]] int query_key_size(const Robot& robot);

/// One of the ways to write down the same canonical primitive: either order of a pair, and for
/// circles either mirror image. Keys of gaps have no order.
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
