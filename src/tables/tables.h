// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robot and scene as the kernels read them: flat arrays of floats, nothing of Eigen.
#pragma once

#include "geometry/compound_grids.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace mneme::internal {

/// Frames that joints move, and the root; more do not fit the kernels' stack frames.
inline constexpr int kMaxFrames = 64;
/// Bodies of the robot; links that move together share one if there are more.
inline constexpr int kMaxBodies = 128;
/// Joints of a robot whose steps are computed: a matrix of them has to fit the stack.
inline constexpr int kMostWalkingJoints = 32;
inline constexpr int kMostLimbPoints = kMaxFrames + 1;
/// Spheres of a group: so few that posing them in vain costs little, and always the same number,
/// which lets loops unroll.
inline constexpr int kGroupSize = 4;
/// Groups of a cluster, at most.
inline constexpr int kClusterSize = 4;
/// The number of obstacles in SceneTables is a multiple of this: the lanes of the widest vector.
inline constexpr int kObstacleBlock = 16;

/// How a frame is turned in its parent at joint value 0.
enum class Turn {
  none,
  permutation,  ///< each of its axes is one of the parent's, or its opposite
  general,
};

/// A frame that a joint moves. Its z axis is the joint's axis.
struct FrameRow {
  int parent = 0;                    ///< 0 is the robot's root, i + 1 is row i
  int joint = 0;                     ///< index into a configuration
  float multiplier = 1, offset = 0;  ///< the joint's value is multiplier * q[joint] + offset
  bool is_prismatic = false;
  Turn turn = Turn::none;
  float rotation[9] = {};     ///< row-major, in the parent frame, at joint value 0
  int source[3] = {0, 1, 2};  ///< of a permutation: the parent's axis for each axis
  float sign[3] = {};         ///< of a permutation: -0 where that axis is reversed, otherwise 0
  float translation[3] = {};
};

/// Where a link is.
struct LinkPlace {
  int frame = 0;           ///< 0 is the robot's root, i + 1 is frame row i
  float rotation[9] = {};  ///< row-major, of the link in that frame
  float translation[3] = {};
};

struct Ball {
  float center[3] = {};
  float radius = 0;
};

/// Neighbouring spheres of one link, or one of its capsules.
struct GroupRow {
  Ball ball;  ///< around them
  bool is_capsule = false;
  int begin = 0;    ///< of kGroupSize spheres, the last of which may repeat; or the capsule's index
  int cluster = 0;  ///< that it belongs to
};

/// Neighbouring groups of spheres of one link, or one of its capsules.
struct ClusterRow {
  Ball ball;  ///< around them
  int begin = 0, end = 0;
};

/// Links that move together and lie close to each other.
struct BodyRow {
  int frame = 0;   ///< 0 is the robot's root, i + 1 is frame row i
  Ball ball = {};  ///< around all groups
  /// The box around them, along the frame's axes.
  float box_center[3] = {}, box_half_extents[3] = {};
  int group_begin = 0, group_end = 0, cluster_begin = 0, cluster_end = 0;
};

struct CapsuleRow {
  float a[3] = {};
  float along[3] = {};  ///< to the other end
  float inverse_length2 = 0;
  float radius = 0;
};

/// The group `first` of one body is checked against some groups of another.
struct GroupPairRow {
  int first = 0;
  int second_begin = 0, second_end = 0;
};

struct BodyPairRow {
  int first = 0, second = 0;
  float reach2 = 0;        ///< squared sum of the balls' radii
  int begin = 0, end = 0;  ///< into group_pairs
  int ancestor = 0;        ///< the frame nearest to both that carries them
};

/// A point that moves with a frame.
struct LimbPoint {
  int frame = 0;
  float point[3] = {};
};

/// From a tip down to the first joint that turns: the tip, then joints' origins.
struct Limb {
  std::vector<LimbPoint> points;
  float length = 0;  ///< metres through the points
};

/// How far joints move bodies. A row of joint_count values each.
struct Reaches {
  /// Metres that a point of each moving body goes at most while a joint moves by 1.
  std::vector<float> bodies;
  /// Metres by which each pair of bodies comes closer at most.
  std::vector<float> pairs;
};

struct RobotTables {
  int joint_count = 0;
  std::vector<FrameRow> frames;      ///< parents before children
  std::vector<LinkPlace> links;      ///< as the robot's
  std::vector<BodyRow> bodies;       ///< tips first, because they hit most often; fixed bodies last
  int moving_count = 0;              ///< how many of the bodies move
  std::vector<GroupRow> groups;      ///< body by body, link by link
  std::vector<ClusterRow> clusters;  ///< in the order of their groups
  std::vector<Ball> spheres;
  std::vector<CapsuleRow> capsules;
  std::vector<BodyPairRow> body_pairs;
  std::vector<GroupPairRow> group_pairs;
  std::vector<Limb> limbs;
  Reaches reaches;
  /// Slides beyond a turning joint make reaches grow: then `reaches` hold for slides at 0.
  bool has_far_slides = false;
  std::vector<int> link_of_group;  ///< index into the robot's links
};

enum class ObstacleKind { sphere, aligned_box, box, upright_cylinder, cylinder, capsule, compound };

/// An obstacle's shape in the scene's frame.
struct ObstacleRow {
  ObstacleKind kind = ObstacleKind::sphere;
  float center[3] = {};       ///< of a capsule: its first end
  float along[3] = {};        ///< of a capsule: to its other end
  float inverse_length2 = 0;  ///< of a capsule: 0 if it is as short as a point
  /// Row-major, from the scene's frame to that of a box or cylinder that is not aligned.
  float rotation[9] = {};
  float half_extents[3] = {};  ///< of a box; of a cylinder: radius, radius, half the length
  float rounding = 0;  ///< the radius of a sphere, capsule or compound shape, around its core
  int compound = -1;   ///< index into SceneTables::compounds
};

/// Many small parts in a frame of their own.
struct CompoundRow {
  float rotation[9] = {};     ///< row-major, from the scene's frame to that of the parts
  float translation[3] = {};  ///< the same
  const VoxelGrid* voxels = nullptr;
  const PointGrid* points = nullptr;  ///< either these
  const PartTree* tree = nullptr;     ///< or this
  std::shared_ptr<const void> owner;  ///< of all three
};

/// Obstacles in a frame whose axes are those of most boxes: they need no rotation, and the bounds
/// below are tight. Its origin is the robot's root.
struct SceneTables {
  float rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major, from the root to that frame
  std::vector<ObstacleRow> obstacles;
  std::vector<CompoundRow> compounds;
  /// Per axis, of the box around each obstacle; filled up to a multiple of kObstacleBlock with
  /// boxes that nothing overlaps.
  std::array<std::vector<float>, 3> lower, upper;
  /// Obstacles that a group of one robot may touch, a bit each: kObstacleBlock of them in a word, a
  /// group's words one after the other. Empty if nothing may touch.
  std::vector<std::uint16_t> may_touch;

  [[nodiscard]] bool may_group_touch(std::size_t group, std::size_t obstacle) const {
    const std::size_t words = lower[0].size() / kObstacleBlock;
    return may_touch[group * words + obstacle / kObstacleBlock] >> obstacle % kObstacleBlock & 1;
  }
};

}  // namespace mneme::internal
