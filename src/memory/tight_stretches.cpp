// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/local_motions.h"
#include "path/push_off.h"
#include "path/waypoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace mneme::internal {
namespace {

constexpr double kMotionStep = 0.1;  ///< radians between waypoints of a stored motion
/// Clearances that are told apart, metres.
constexpr std::array kClearances = {0.0, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3, 8e-3, 1e-2, 1.5e-2, 3e-2};
/// Tight states that are fewer waypoints apart belong together.
constexpr int kMostOpen = 6;
/// Waypoints kept before and after a tight stretch, where trees reach it more easily.
constexpr int kMouth = 4;
/// Stretches of fewer states, or without a state this tight, are found in any scene.
constexpr int kLeastStates = 8;
constexpr float kTightest = 0.005f;
constexpr std::size_t kNearMisses = 64, kLeastNearMisses = 32;
constexpr double kMissDistance = 0.1;  ///< standard deviation per joint, radians or metres
constexpr int kMissTries = 64;         ///< rounds of kNearMisses states

/// Waypoints at most kMotionStep apart, row by row.
std::vector<float> densified(const Robot& robot, const Path& path) {
  Path dense = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Configuration delta = robot.difference(path[i - 1], path[i]);
    const int count = std::max(
        1, static_cast<int>(std::ceil(robot.distance(path[i - 1], path[i]) / kMotionStep)));
    for (int k = 1; k <= count; ++k) {
      Configuration q = path[i - 1];
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * k / count;
      dense.push_back(robot.normalized(q));
    }
  }
  return to_rows(dense);
}

/// The largest of kClearances that each state keeps.
std::vector<float> clearances_of(const CollisionChecker& checker, const std::vector<float>& rows) {
  const std::size_t count = rows.size() / static_cast<std::size_t>(checker.robot().joint_count());
  std::vector<float> clearances(count, 0);
  std::vector<std::uint8_t> is_free(count);
  for (const double clearance : kClearances) {
    checker.check_states(rows, is_free, clearance);
    for (std::size_t i = 0; i < count; ++i) {
      if (is_free[i] != 0) clearances[i] = static_cast<float>(clearance);
    }
  }
  return clearances;
}

/// The first and last tight state of each stretch.
std::vector<std::pair<int, int>> find_stretches(const std::vector<float>& clearances) {
  std::vector<std::pair<int, int>> stretches;
  for (int i = 0; i < static_cast<int>(clearances.size()); ++i) {
    if (!is_tight(clearances[static_cast<std::size_t>(i)])) continue;
    if (stretches.empty() || i - stretches.back().second > kMostOpen) stretches.emplace_back(i, i);
    stretches.back().second = i;
  }
  std::erase_if(stretches, [&](const auto& stretch) {
    const auto first = clearances.begin() + stretch.first;
    const auto end = clearances.begin() + stretch.second + 1;
    return end - first < kLeastStates || *std::min_element(first, end) > kTightest;
  });
  return stretches;
}

/// States next to `rows` that only obstacles block.
std::vector<float> find_near_misses(const CollisionChecker& checker, const CollisionChecker& empty,
                                    std::span<const float> rows) {
  const auto joints = static_cast<std::size_t>(checker.robot().joint_count());
  const auto count = static_cast<std::uint32_t>(rows.size() / joints);
  Rng rng(count);
  std::vector<float> misses, near(kNearMisses * joints);
  std::vector<std::uint8_t> is_free(kNearMisses), is_possible(kNearMisses);
  for (int i = 0; i < kMissTries && misses.size() < kNearMisses * joints; ++i) {
    for (std::size_t k = 0; k < kNearMisses; ++k) {
      const float* const q = rows.data() + rng.index(count) * joints;
      for (std::size_t j = 0; j < joints; ++j) {
        near[k * joints + j] = q[j] + static_cast<float>(kMissDistance * rng.normal());
      }
    }
    checker.check_states(near, is_free);
    empty.check_states(near, is_possible);
    for (std::size_t k = 0; k < kNearMisses && misses.size() < kNearMisses * joints; ++k) {
      if (is_free[k] != 0 || is_possible[k] == 0) continue;
      const auto q = near.begin() + static_cast<std::ptrdiff_t>(k * joints);
      misses.insert(misses.end(), q, q + static_cast<std::ptrdiff_t>(joints));
    }
  }
  return misses;
}

}  // namespace

std::vector<RememberedPath> cut_tight_stretches(const CollisionChecker& checker,
                                                const CollisionChecker& empty, const Path& path) {
  std::vector<RememberedPath> motions;
  if (path.size() < 2) return motions;
  const Robot& robot = checker.robot();
  const auto joints = static_cast<std::ptrdiff_t>(robot.joint_count());
  const std::vector<float> rows = densified(robot, widen(checker, path, {}));
  const std::vector<float> clearances = clearances_of(checker, rows);
  for (const auto& [first, last] : find_stretches(clearances)) {
    const std::span tight(rows.begin() + first * joints, rows.begin() + (last + 1) * joints);
    RememberedPath motion;
    motion.joint_count = robot.joint_count();
    motion.near_misses = find_near_misses(checker, empty, tight);
    if (motion.near_misses.size() < kLeastNearMisses * static_cast<std::size_t>(joints)) continue;
    const int begin = std::max(0, first - kMouth);
    const int end = std::min(static_cast<int>(clearances.size()), last + 1 + kMouth);
    motion.waypoints.assign(rows.begin() + begin * joints, rows.begin() + end * joints);
    motion.clearances.assign(clearances.begin() + begin, clearances.begin() + end);
    motions.push_back(std::move(motion));
  }
  return motions;
}

extern const MemoryKind kLocalMotions;

namespace {

/// Distance of the last link from the robot's axis and height at the tightest waypoint, metres, and
/// the number of waypoints times their step.
PrimitiveKey key_of(const Robot& robot, const SymmetricJoints& joints,
                    const RememberedPath& motion) {
  const auto tightest = std::ranges::min_element(motion.clearances) - motion.clearances.begin();
  const auto q = motion.waypoints.begin() + tightest * motion.joint_count;
  const Vec3 tip = robot.link_poses(Configuration(q, q + motion.joint_count)).back().translation;
  return {std::hypot(tip.x() - joints.axis_x, tip.y() - joints.axis_y), tip.z(),
          kMotionStep * motion.waypoint_count()};
}

Result<std::vector<Experience>> remember_motions(const MemoryQuery& query,
                                                 std::span<const Path> paths, double, double) {
  const auto checker = MNEME_TRY(CollisionChecker::make(query.robot, query.scene));
  const auto empty = MNEME_TRY(CollisionChecker::make(query.robot, {}));
  const SymmetricJoints joints = find_symmetric_joints(query.robot);
  std::vector<Experience> rows;
  for (const Path& path : paths) {
    for (RememberedPath& motion : cut_tight_stretches(checker, empty, path)) {
      Experience& row = rows.emplace_back();
      row.kind = kLocalMotions.version;
      row.key = key_of(query.robot, joints, motion);
      row.content = std::move(motion);
    }
  }
  return rows;
}

}  // namespace

extern constinit const MemoryKind kLocalMotions = {
    .name = "motions",
    .version = "motions/1",
    .summary = "tight stretches of solved paths, found in a scene by checking alone",
    .defaults = {.share = {.lambda = 0}},
    .handles = [](const Robot& robot) { return !robot.is_planar(); },
    .key_size = [](const Robot&) { return 3; },
    .decompose = [](const MemoryQuery&, double) -> Result<std::vector<LocalPrimitive>> {
      return std::vector<LocalPrimitive>();
    },
    .images =
        [](const PrimitiveKey& key) {
          return std::vector<KeyImage>{{key, false}};
        },
    .synthesize =
        [](const MemoryQuery& query, std::span<const PrimitiveRetrieval>) {
          GaussianMixture none;
          none.joint_count = query.robot.joint_count();
          return none;
        },
    .learn_from_paths = remember_motions,
    .least_work = 50'000,
    .is_placed_by_checking = true,
};

}  // namespace mneme::internal
