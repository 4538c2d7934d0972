// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include "memory/moved_means.h"
#include "primitive/near_pairs.h"
#include "primitive/passage.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace mneme {
namespace {

constexpr std::string_view kGapsVersion = "gaps/1";

constexpr double kDistanceWeight = 1.0 / 3;

double distance_to(const Vec3& point, const Obstacle& obstacle, double most) {
  double least = most;
  for (const Shape& shape : obstacle.shapes) least = std::min(least, distance(point, shape));
  return least;
}

/// Diameter of the robot's thinnest shape: nothing of it passes where it is narrower.
double thinnest(const Robot& robot) {
  double least = std::numeric_limits<double>::infinity();
  for (const Link& link : robot.links()) {
    for (const Sphere& sphere : link.spheres) least = std::min(least, 2 * sphere.radius);
    for (const Capsule& capsule : link.capsules) least = std::min(least, 2 * capsule.radius);
  }
  return std::isfinite(least) ? least : 0.0;
}

/// Finds the passages of one scene.
class GapFinder {
 public:
  GapFinder(const Robot& robot, const Scene& scene, double max_gap)
      : scene_(scene),
        joints_(find_symmetric_joints(robot)),
        max_gap_(max_gap),
        thinnest_(thinnest(robot)) {}

  Result<std::vector<LocalPrimitive>> find() const {
    const auto pairs = internal::find_near_pairs(scene_, max_gap_);
    if (!pairs) return tl::unexpected(pairs.error());
    std::vector<LocalPrimitive> primitives;
    for (const auto& [i, j] : *pairs) {
      const auto passage = internal::find_passage(obstacle(i), obstacle(j), max_gap_);
      if (!passage || passage->width() < thinnest_ || is_blocked(*passage, i, j)) continue;
      primitives.push_back(make_primitive(*passage, i, j));
    }
    return primitives;
  }

 private:
  [[nodiscard]] const Obstacle& obstacle(int index) const {
    return scene_.obstacles[static_cast<std::size_t>(index)];
  }

  [[nodiscard]] bool is_blocked(const internal::Passage& passage, int a, int b) const {
    for (int i = 0; i < static_cast<int>(scene_.obstacles.size()); ++i) {
      if (i == a || i == b) continue;
      const double most = 0.5 * thinnest_;
      if (distance_to(passage.middle(), obstacle(i), most) < most) return true;
    }
    return false;
  }

  /// The obstacle other than `a` and `b` that a ray meets first within kGapReach, or -1: steps as
  /// long as the distance to everything (Hart, DOI 10.1007/s003710050084).
  [[nodiscard]] int first_hit(const Vec3& from, const Vec3& direction, int a, int b) const {
    constexpr double kHit = 1e-4;
    for (double along = 0; along < kGapReach;) {
      double step = kGapReach;
      int nearest = -1;
      for (int i = 0; i < static_cast<int>(scene_.obstacles.size()); ++i) {
        if (i == a || i == b) continue;
        const double away = distance_to(from + along * direction, obstacle(i), step);
        if (away >= step) continue;
        step = away;
        nearest = i;
      }
      if (step < kHit) return nearest;
      along += step;
    }
    return -1;
  }

  /// The pair first, then what bounds the passage, in scene order.
  [[nodiscard]] std::vector<int> members(const internal::Passage& passage, const Vec3& radial,
                                         int a, int b) const {
    const Vec3 across = (passage.b - passage.a).normalized();
    constexpr double kUpright = 0.9;
    const Vec3 guide = std::abs(across.z()) < kUpright ? Vec3(Vec3::UnitZ()) : radial;
    const Vec3 first = across.cross(guide).normalized();
    const Vec3 second = across.cross(first);
    std::vector<int> bounds;
    for (const Vec3& direction : {first, Vec3(-first), second, Vec3(-second)}) {
      const int hit = first_hit(passage.middle(), direction, a, b);
      if (hit >= 0) bounds.push_back(hit);
    }
    std::ranges::sort(bounds);
    bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());
    bounds.insert(bounds.begin(), {a, b});
    return bounds;
  }

  [[nodiscard]] LocalPrimitive make_primitive(const internal::Passage& passage, int a,
                                              int b) const {
    const Vec3 axis(joints_.axis_x, joints_.axis_y, 0);
    const Vec3 from_axis = passage.middle() - axis;
    LocalPrimitive primitive;
    primitive.kind = kGapsVersion;
    if (joints_.turn >= 0) primitive.to_scene.rotation = std::atan2(from_axis.y(), from_axis.x());
    if (joints_.lift >= 0) primitive.to_scene.lift = from_axis.z();
    const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), primitive.to_scene.rotation);
    primitive.gap = passage.width();
    primitive.obstacles = members(passage, turn.col(0), a, b);
    std::vector<Obstacle> own;
    for (const int index : primitive.obstacles) own.push_back(obstacle(index));
    primitive.key = gap_key(own, passage.middle(), turn);
    const Vec3 canonical = turn.transpose() * (from_axis - Vec3(0, 0, primitive.to_scene.lift));
    std::copy(canonical.data(), canonical.data() + 3, primitive.key.begin());
    return primitive;
  }

  const Scene& scene_;
  SymmetricJoints joints_;
  double max_gap_;
  double thinnest_;
};

}  // namespace

PrimitiveKey gap_key(std::span<const Obstacle> obstacles, const Vec3& middle,
                     const Eigen::Matrix3d& rotation) {
  PrimitiveKey key(middle.data(), middle.data() + 3);
  key.reserve(kGapKeySize);
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Vec3 probe = middle + kGapProbeSpacing * (rotation * Vec3(x, y, z));
        double least = kGapReach;
        for (const Obstacle& obstacle : obstacles) {
          least = std::min(least, distance_to(probe, obstacle, kGapReach));
        }
        key.push_back(kDistanceWeight * least);
      }
    }
  }
  return key;
}

namespace internal {
namespace {

Result<std::vector<LocalPrimitive>> decompose_into_gaps(const MemoryQuery& query, double max_gap) {
  const std::optional<Scene> boxed = with_boxed_compounds(query.scene);
  return GapFinder(query.robot, boxed ? *boxed : query.scene, max_gap).find();
}

}  // namespace

extern constinit const MemoryKind kGaps = {
    .name = "gaps",
    .version = kGapsVersion,
    .summary = "the passage between two obstacles, by the clearance around it; for arms in space",
    .defaults = {.share = {.retrieve_after = 1500},
                 .sigma = 0.07,
                 .similarity = 0.03,
                 .max_gap = 0.25},
    .key_size = [](const Robot&) { return kGapKeySize; },
    .decompose = decompose_into_gaps,
    .images =
        [](const PrimitiveKey& key) {
          return std::vector<KeyImage>{{key, false}};
        },
    .synthesize = pool_moved_means,
    .learn_from_paths = learn_waypoints<decompose_into_gaps>,
    .learn = learn_local_sampler,
    .no_learning_on_a_miss = {},
};

}  // namespace internal
}  // namespace mneme
