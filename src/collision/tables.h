// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robot and scene as the kernels read them: flat arrays of floats, nothing of Eigen.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A frame that a joint of the group moves. Its z axis is the joint's axis.
struct FrameRow {
  int parent = -1;  ///< frame, or -1 for the robot's root
  int joint = 0;    ///< index into a configuration
  bool is_prismatic = false;
  bool is_rotated = false;  ///< `rotation` is not the identity
  float rotation[9] = {};   ///< row-major, in the parent frame, at joint value 0
  float translation[3] = {};
};

/// The shapes of one link, in the coordinates of its frame.
struct LinkRow {
  int link = 0;          ///< index into Robot::links()
  int frame = -1;        ///< -1: fixed to the root
  float center[3] = {};  ///< of a sphere around all shapes
  float radius = 0;
  int sphere_begin = 0, sphere_end = 0;
  int capsule_begin = 0, capsule_end = 0;
};

struct SphereRow {
  float center[3];
  float radius;
};

struct CapsuleRow {
  float a[3];
  float b[3];
  float radius;
};

struct BoxRow {
  float center[3];
  float rotation[9];  ///< row-major, world to box
  float half_extents[3];
  float bounding_radius;
};

struct RobotTables {
  int joint_count = 0;
  std::vector<FrameRow> frames;  ///< parents before children
  std::vector<LinkRow> links;    ///< that have shapes and move, tips first: they hit most often
  std::vector<LinkRow> fixed_links;
  std::vector<SphereRow> spheres;
  std::vector<CapsuleRow> capsules;
  std::vector<std::pair<int, int>> pairs;        ///< indices into `links`
  std::vector<std::pair<int, int>> fixed_pairs;  ///< a moving link and one of `fixed_links`
};

struct SceneTables {
  std::vector<SphereRow> spheres;
  std::vector<CapsuleRow> capsules;
  std::vector<BoxRow> boxes;
};

}  // namespace mneme::internal
