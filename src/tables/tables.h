// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robot and scene as the kernels read them: flat arrays of floats, without Eigen.
#pragma once

#include "geometry/compound_grids.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace mneme::internal {

/// Largest number of moving frames: more do not fit the kernels' stack.
inline constexpr int kMaxFrames = 64;
/// Largest number of bodies. Where there would be more, links that move together share a body.
inline constexpr int kMaxBodies = 128;
/// Largest number of joints for which walk() works: their matrix has to fit the stack.
inline constexpr int kMostWalkingJoints = 32;
inline constexpr int kMostLimbPoints = kMaxFrames + 1;
/// Spheres in a group: a constant, so that loops unroll, and small, so that posing them in vain
/// costs little.
inline constexpr int kGroupSize = 4;
/// Largest number of groups in a cluster.
inline constexpr int kClusterSize = 4;
/// The number of obstacles in SceneTables is a multiple of this: the lanes of the widest vector.
inline constexpr int kObstacleBlock = 16;

/// Rotation of a frame in its parent at joint value 0.
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
  int source[3] = {0, 1, 2};  ///< for a permutation: the parent's axis for each axis
  bool is_reversed[3] = {};   ///< for a permutation: whether that axis is reversed
  float translation[3] = {};
};

/// The place of a link.
struct LinkPlace {
  int frame = 0;           ///< 0 is the robot's root, i + 1 is frame row i
  float rotation[9] = {};  ///< row-major, from the link to that frame
  float translation[3] = {};
};

struct Ball {
  float center[3] = {};
  float radius = 0;
};

/// Neighbouring spheres of one link, or one capsule.
struct GroupRow {
  Ball ball;  ///< the bounding ball
  bool is_capsule = false;
  int begin = 0;    ///< first of kGroupSize spheres, the last of which may repeat; or the capsule
  int cluster = 0;  ///< index of its cluster
};

/// A cluster: several neighbouring groups of spheres of one body, or a single capsule.
struct ClusterRow {
  Ball ball;  ///< the bounding ball
  int begin = 0, end = 0;
};

/// Links that move together and lie close to each other.
struct BodyRow {
  int frame = 0;   ///< 0 is the robot's root, i + 1 is frame row i
  Ball ball = {};  ///< the bounding ball
  /// The bounding box, along the frame's axes.
  float box_center[3] = {}, box_half_extents[3] = {};
  int group_begin = 0, group_end = 0, cluster_begin = 0, cluster_end = 0;
};

struct CapsuleRow {
  float a[3] = {};
  float along[3] = {};  ///< from `a` to the other end
  float inverse_length2 = 0;
  float radius = 0;
};

/// Group `first` of one body, and the groups of another that it is checked against.
struct GroupPairRow {
  int first = 0;
  int second_begin = 0, second_end = 0;
};

struct BodyPairRow {
  int first = 0, second = 0;
  float reach2 = 0;           ///< squared sum of the balls' radii
  int begin = 0, end = 0;     ///< into group_pairs
  int ancestor = 0;           ///< the nearest frame that carries both
  int separation_table = -1;  ///< index into RobotTables::separation_tables; -1: none
};

/// Largest number of joints between two bodies with a separation table.
inline constexpr std::size_t kMostJointsBetween = 2;

/// Where two bodies are proven apart, for cells of the values of the one or two joints between
/// them. Without a period, the first and last cells are those beyond the limits, where nothing is
/// proven.
struct SeparationTable {
  /// Metres that bodies are apart throughout a cell that is not 0.
  static constexpr float kApart = 1e-3f;
  static constexpr int kMostRings = 3;
  static constexpr int kBits = 2, kCellsPerWord = 32 / kBits;

  struct Axis {
    int joint = 0;  ///< index into a configuration
    int cells = 1;
    float scale = 0, offset = 0;  ///< the cell is the integer part of scale * value + offset
    bool has_period = true;       ///< cells repeat
  };
  std::array<Axis, kMostJointsBetween> axes;  ///< cells of the last are contiguous
  /// kBits bits a cell, lowest first: 0 if bodies may come closer than kApart. Otherwise they are
  /// apart in the cell and in all within less than this number of cells.
  std::vector<std::uint32_t> rings;
};

/// A point that moves with a frame.
struct LimbPoint {
  int frame = 0;
  float point[3] = {};
};

/// The chain from a tip down to the first revolute joint: the tip, then joints' origins.
struct Limb {
  std::vector<LimbPoint> points;
  float length = 0;  ///< metres through the points
};

/// Displacement bounds per joint: rows of joint_count values, metres per unit of the joint.
struct Reaches {
  std::vector<float> bodies;  ///< for the points of each moving body
  std::vector<float> pairs;   ///< for the approach of each pair of bodies
};

struct RobotTables {
  int joint_count = 0;
  std::vector<FrameRow> frames;      ///< parents before children
  std::vector<LinkPlace> links;      ///< in the robot's order
  std::vector<BodyRow> bodies;       ///< tips first, because they hit most often; fixed bodies last
  int moving_count = 0;              ///< number of bodies that move
  std::vector<GroupRow> groups;      ///< body by body, link by link
  std::vector<ClusterRow> clusters;  ///< in the order of their groups
  std::vector<Ball> spheres;
  std::vector<CapsuleRow> capsules;
  std::vector<BodyPairRow> body_pairs;
  std::vector<GroupPairRow> group_pairs;
  std::shared_ptr<const std::vector<SeparationTable>>
      separation_tables;  ///< null if no pair has one
  std::vector<Limb> limbs;
  Reaches reaches;
  /// True if a prismatic joint lies beyond a revolute one. Then `reaches` are valid only for slides
  /// at 0.
  bool has_far_slides = false;
  std::vector<int> link_of_group;  ///< index into the robot's links
};

enum class ObstacleKind { sphere, aligned_box, box, upright_cylinder, cylinder, capsule, compound };

/// An obstacle's shape in the scene's frame.
struct ObstacleRow {
  ObstacleKind kind = ObstacleKind::sphere;
  float center[3] = {};       ///< For a capsule: its first end.
  float along[3] = {};        ///< For a capsule: from its first end to the other.
  float inverse_length2 = 0;  ///< For a capsule: 1 / length^2, or 0 if its length is 0.
  /// Row-major, from the scene's frame to the frame of a box or cylinder that is not aligned.
  float rotation[9] = {};
  float half_extents[3] = {};  ///< for a cylinder: radius, radius, half the length
  float rounding = 0;          ///< radius of a sphere, capsule or compound shape around its core
  int compound = -1;           ///< index into SceneTables::compounds
};

/// Many small parts in their own frame.
struct CompoundRow {
  float rotation[9] = {};     ///< row-major, from the scene's frame to the parts' frame
  float translation[3] = {};  ///< from the scene's frame to the parts' frame
  const VoxelGrid* voxels = nullptr;
  const PointGrid* points = nullptr;  ///< null for triangles and cubes
  const PartTree* tree = nullptr;     ///< null for points
  std::shared_ptr<const void> owner;  ///< keeps the data behind the pointers alive
};

/// Obstacles in a frame with the axes of most boxes, so that these need no rotation and have tight
/// bounds. The frame's origin is the robot's root.
struct SceneTables {
  float rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major, from the root to that frame
  std::vector<ObstacleRow> obstacles;
  std::vector<CompoundRow> compounds;
  /// The bounding box of each obstacle, by axis. Padded to a multiple of kObstacleBlock with boxes
  /// that nothing overlaps.
  std::array<std::vector<float>, 3> lower, upper;
  /// Bits of the obstacles that each group may touch: kObstacleBlock bits a word, group by group.
  /// Empty if no contact is allowed.
  std::vector<std::uint16_t> may_touch;
  /// For each moving body of the robot: metres that it keeps from all obstacles in every
  /// configuration. Negative: nothing is known. Empty: nothing is known of any body.
  std::vector<float> clearances;

  /// Returns false if body `body` keeps `margin` from all obstacles in every configuration.
  [[nodiscard]] bool is_reached(int body, float margin) const {
    return clearances.empty() || margin >= clearances[static_cast<std::size_t>(body)];
  }
  [[nodiscard]] bool may_group_touch(std::size_t group, std::size_t obstacle) const {
    const std::size_t words = lower[0].size() / kObstacleBlock;
    return may_touch[group * words + obstacle / kObstacleBlock] >> obstacle % kObstacleBlock & 1;
  }
};

}  // namespace mneme::internal
