// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/push_off.h"

#include "path/waypoints.h"

#include <vector>

namespace mneme::internal {
namespace {

constexpr float kSpacing = 0.15f;
/// Steps of a push: each leaves a little of what is in the way.
constexpr int kPushes = 2;
/// Metres to obstacles that a remembered path is pushed to, and that shortening it leaves.
constexpr double kPushedClearance = 0.035, kKeptClearance = 0.03;
/// Of the length that was free already: clearance is not worth more.
constexpr double kMostLengthening = 1.15;

}  // namespace

Path push_off(const CollisionChecker& checker, const Path& path, double clearance,
              const std::function<bool(float way)>& is_wanted) {
  const Robot& robot = checker.robot();
  if (checker.limbs().empty()) return path;
  std::vector<float> rows;
  for (const Configuration& q : path) rows.insert(rows.end(), q.begin(), q.end());
  Waypoints way(robot);
  way.assign(std::move(rows));
  const auto joints = static_cast<std::size_t>(way.joint_count());
  const std::vector<float> still(joints), jitter(3);
  WalkStep step;
  step.clearance = static_cast<float>(clearance);
  step.drift = still;
  step.jitter = jitter;
  const int parts = static_cast<int>(way.length() / kSpacing) + 1;
  std::vector<float> q(joints), pushed(joints);
  Path result = {path.front()};
  for (int i = 1; i < parts; ++i) {
    const float here = way.length() * static_cast<float>(i) / static_cast<float>(parts);
    way.write(way.locate(here), q.data());
    for (int push = 0; push < kPushes && is_wanted(here); ++push) {
      checker.walk(q, step, pushed);
      q = pushed;
    }
    result.push_back(robot.normalized(Configuration(q.begin(), q.end())));
  }
  result.push_back(path.back());
  return result;
}

Path widen(const CollisionChecker& checker, const Path& path, std::uint64_t seed) {
  const auto wide = CollisionChecker::make(
      checker.robot(), checker.scene(),
      {checker.resolution(), checker.margin() + kKeptClearance, checker.isa()});
  if (!wide || path.size() < 2) return path;
  Path widened = push_off(checker, path, kPushedClearance, [](float) { return true; });
  CheckCounters counters;
  shorten(*wide, widened, seed, {}, nullptr, counters);
  FinishSettings settings;
  settings.simplify = false;
  settings.seed = seed;
  PathFinisher verify(checker, settings);
  const Robot& robot = checker.robot();
  const bool is_short = path_length(robot, widened) <= kMostLengthening * path_length(robot, path);
  return is_short && verify(widened, counters) < 0 ? widened : path;
}

}  // namespace mneme::internal
