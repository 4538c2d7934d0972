// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "instances/box_scenes.h"

#include <vector>

namespace mneme::internal {

std::optional<Configuration> sample_free(const CollisionChecker& checker, SampleStream& states) {
  constexpr int kTries = 10000;
  std::vector<float> q(static_cast<std::size_t>(checker.robot().joint_count()));
  for (int i = 0; i < kTries; ++i) {
    states.next(q);
    if (checker.is_valid(q)) return Configuration(q.begin(), q.end());
  }
  return std::nullopt;
}

Path find_path(const CollisionChecker& checker, const Sampler& sampler, const PlanQuery& query,
               std::uint64_t iterations, std::uint64_t seed, const std::atomic<bool>* cancel) {
  PlanSettings plan;
  plan.timeout_s = 1e6;
  plan.max_iterations = iterations;
  plan.seed = seed;
  plan.cancel = cancel;
  return plan_with(rrt_connect, checker, query, sampler, plan).path;
}

Result<bool> is_clear_of(const Box& box, const Robot& robot, const Path& path, double clearance) {
  CheckerSettings settings;
  settings.margin = clearance;
  const auto checker = MNEME_TRY(CollisionChecker::make(robot, {"", {{"", {box}}}}, settings));
  CheckCounters counters;
  return checker.fixed_contacts().empty() &&
         checker.is_valid(std::span<const double>(path.front())) &&
         find_invalid_motion(checker, path, counters) < 0;
}

}  // namespace mneme::internal
