// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/unsolved.h"

#include "pipeline/memory_steps.h"
#include "store/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

/// Shorter searches may have failed by chance.
constexpr std::uint64_t kLeastIterations = 5'000;

/// Numbers of a key: the digest of all but the scene, whose keys are at least 1 apart; then, small
/// enough not to matter for a lookup, the digest of the scene, and the limits of the search.
constexpr std::size_t kDigestSize = 4, kScene = kDigestSize, kSeconds = 2 * kDigestSize,
                      kIterations = kSeconds + 1, kKeySize = kIterations + 1;
constexpr double kSceneUnit = 1e-6, kSecondsUnit = 1e-7, kIterationsUnit = 1e-10;
constexpr double kSameEnds = 0.5;  ///< squared distance of keys

using Digest = std::array<double, kDigestSize>;

Digest split(std::int64_t value) {
  Digest digest{};
  auto bits = std::bit_cast<std::uint64_t>(value);
  for (double& number : digest) {
    number = static_cast<double>(bits & 0xffff);
    bits >>= 16;
  }
  return digest;
}

Digest digest_of_ends(const Query& query) {
  const Problem& problem = query.problem;
  const SolveSettings& settings = query.settings;
  Problem ends{.robot = problem.robot, .start = problem.start, .goals = problem.goals};
  ends.pose_goals = problem.pose_goals;
  ends.constraints = problem.constraints;
  ColumnDigest digest;
  digest.add(to_compact_json(ends, problem.robot.hash())).add(query.planner.name);
  for (const double value : {settings.margin, settings.resolution.value_or(-1),
                             settings.start_tolerance, settings.allow_at_ends}) {
    digest.add(std::bit_cast<std::int64_t>(value));
  }
  return split(digest.value());
}

Digest digest_of_scene(const Scene& scene) {
  FramedScene unnamed{scene, ""};
  unnamed.scene.name.clear();
  return split(ColumnDigest().add(to_compact_json(unnamed)).value());
}

bool is_of_scene(const std::vector<double>& key, const Digest& scene) {
  for (std::size_t i = 0; i < kDigestSize; ++i) {
    if (std::lround(key[kScene + i] / kSceneUnit) != std::lround(scene[i])) return false;
  }
  return true;
}

/// True if a search with the limits of the key has done all that the query allows.
bool covers(const std::vector<double>& key, const PlanSettings& limits) {
  constexpr double kSlack = 1e-9;
  const double seconds = key[kSeconds] / kSecondsUnit * (1 + kSlack);
  const double iterations = key[kIterations] / kIterationsUnit * (1 + kSlack);
  return seconds >= limits.timeout_s ||
         (limits.max_iterations && iterations >= static_cast<double>(*limits.max_iterations));
}

PlanResult describe_unsolved(const Experience& row) {
  const double seconds = row.key[kSeconds] / kSecondsUnit;
  const double iterations = row.key[kIterations] / kIterationsUnit;
  PlanResult plan;
  plan.status = seconds > 0 ? PlanStatus::timeout : PlanStatus::iteration_limit;
  const std::string limit =
      seconds > 0 ? fmt::format("{:.3g} s", seconds) : fmt::format("{:.0f} iterations", iterations);
  plan.message = fmt::format(
      "no path: row {} remembers a search of {} for exactly this problem in vain; a longer limit "
      "or `memory: off` searches again",
      row.id, limit);
  return plan;
}

}  // namespace

std::optional<PlanResult> find_unsolved(const Query& query) {
  if (query.database == nullptr || query.settings.memory_mode != MemoryMode::automatic) {
    return std::nullopt;
  }
  const std::vector<KindInfo> held = query.database->kinds();
  if (std::ranges::find(held, kUnsolvedRows, &KindInfo::kind) == held.end()) return std::nullopt;
  const Digest ends = digest_of_ends(query);
  std::vector<double> key(ends.begin(), ends.end());
  key.resize(kKeySize);
  const auto found = query.database->find(kUnsolvedRows, std::array{key}, kSameEnds, 0);
  if (!found || found->empty()) return std::nullopt;
  const Digest scene = digest_of_scene(query.problem.scene);
  for (const KeyMatch& match : *found) {
    const Experience& row = *match.experience;
    if (!is_of_scene(row.key, scene) || !covers(row.key, query.settings.plan)) continue;
    return describe_unsolved(row);
  }
  return std::nullopt;
}

void remember_unsolved(const ResolvedQuery& resolved, const PlanResult& plan) {
  const Query& query = resolved.query;
  const bool is_limit =
      plan.status == PlanStatus::timeout || plan.status == PlanStatus::iteration_limit;
  const bool may_remember = query.database != nullptr && query.settings.remember_after &&
                            query.settings.memory_mode == MemoryMode::automatic;
  if (!is_limit || !may_remember || plan.iterations < kLeastIterations) return;
  const Digest ends = digest_of_ends(query), scene = digest_of_scene(query.problem.scene);
  PrimitiveKey key(ends.begin(), ends.end());
  for (const double number : scene) key.push_back(kSceneUnit * number);
  const bool is_timeout = plan.status == PlanStatus::timeout;
  key.push_back(is_timeout ? kSecondsUnit * query.settings.plan.timeout_s : 0);
  key.push_back(kIterationsUnit * static_cast<double>(plan.iterations));
  RememberedPath start;
  start.joint_count = query.problem.robot.joint_count();
  start.waypoints.assign(resolved.ends.start.begin(), resolved.ends.start.end());
  start.planning_states = plan.states_checked;
  // A hint that is not kept is no failure of the query.
  static_cast<void>(query.database->insert_later(
      new_row(kUnsolvedRows, std::move(key), std::move(start),
              provenance_of("searched problem " + query.problem.name + " in vain",
                            query.settings.plan.seed))));
}

}  // namespace mneme::internal
