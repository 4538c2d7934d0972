// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contact by FCL in double precision, with kinematics of its own: shares no code with mneme's
/// kernels or its exact distances.
#pragma once

#include "mneme/planning.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <Eigen/Geometry>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/narrowphase/collision_object.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme::soak {

struct Overlap {
  double depth = 0;  ///< metres
  std::string what;
};

/// One robot in one scene. Belongs to one thread; robot and scene must outlive it.
class FclOracle {
 public:
  /// The robot's shapes are inflated by `margin` metres against obstacles.
  FclOracle(const Robot& robot, const Scene& scene, double margin = 0);

  /// Returns a pair that overlaps at `q` by more than `tolerance` metres, if there is one.
  [[nodiscard]] std::optional<Overlap> overlap(std::span<const double> q, double tolerance = 0);
  /// Of the states of `path` at `resolution` radians or finer, the one that overlaps most, if any
  /// does.
  [[nodiscard]] std::optional<Overlap> deepest(const Path& path, double resolution);
  /// The least distance between things that must not touch, metres; 0 in contact.
  [[nodiscard]] double clearance(std::span<const double> q);

 private:
  struct Part {
    std::unique_ptr<fcl::CollisionObjectd> object;
    std::unique_ptr<fcl::CollisionObjectd> inflated;
    Eigen::Isometry3d in_link;
  };
  void move_to(std::span<const double> q);
  [[nodiscard]] bool overlaps_obstacle(Overlap& worst) const;
  [[nodiscard]] bool overlaps_itself(Overlap& worst) const;

  const Robot& robot_;
  std::vector<std::vector<Part>> links_;
  std::vector<fcl::AABBd> link_bounds_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> obstacles_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

}  // namespace mneme::soak
