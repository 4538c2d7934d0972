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
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

/// Shorter searches may have failed by chance.
constexpr std::uint64_t kLeastIterations = 5'000;

constexpr double kSameEnds = 0.5;  ///< squared distance of keys

/// What a row remembers. Rows are found by the distance of their keys: the digest of the ends is in
/// whole numbers, which differ by 1 at least; the other numbers are too small to matter.
struct VainSearch {
  std::uint64_t ends = 0;  ///< digest of all but the scene
  std::uint64_t scene = 0;
  double seconds = 0;  ///< time limit; 0 if the search reached another limit
  double iterations = 0;
};

constexpr double kSceneUnit = 1e-6, kSecondsUnit = 1e-7, kIterationsUnit = 1e-10;
constexpr std::size_t kPieces = 4;  ///< numbers of a digest, of 16 bits each

PrimitiveKey to_key(const VainSearch& search) {
  PrimitiveKey key;
  for (const auto& [digest, unit] : {std::pair(search.ends, 1.0), {search.scene, kSceneUnit}}) {
    for (std::size_t i = 0; i < kPieces; ++i) {
      key.push_back(unit * static_cast<double>(digest >> (16 * i) & 0xffff));
    }
  }
  key.push_back(kSecondsUnit * search.seconds);
  key.push_back(kIterationsUnit * search.iterations);
  return key;
}

VainSearch from_key(const PrimitiveKey& key) {
  const auto digest = [&](std::size_t first, double unit) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < kPieces; ++i) {
      bits |= static_cast<std::uint64_t>(std::lround(key[first + i] / unit)) << (16 * i);
    }
    return bits;
  };
  return {digest(0, 1), digest(kPieces, kSceneUnit), key[2 * kPieces] / kSecondsUnit,
          key[2 * kPieces + 1] / kIterationsUnit};
}

std::uint64_t digest_of_ends(const Query& query) {
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
  return std::bit_cast<std::uint64_t>(digest.value());
}

std::uint64_t digest_of_scene(const Scene& scene) {
  FramedScene unnamed{scene, ""};
  unnamed.scene.name.clear();
  return std::bit_cast<std::uint64_t>(ColumnDigest().add(to_compact_json(unnamed)).value());
}

/// The limit of the query that the search has reached; nothing if the query allows more.
std::optional<PlanStatus> limit_reached(const VainSearch& search, const PlanSettings& limits) {
  constexpr double kSlack = 1 + 1e-9;
  const double iterations = kSlack * search.iterations, seconds = kSlack * search.seconds;
  const auto most = limits.max_iterations;
  if (most && iterations >= static_cast<double>(*most)) return PlanStatus::iteration_limit;
  if (seconds > 0 && seconds >= limits.timeout_s) return PlanStatus::timeout;
  return std::nullopt;
}

PlanResult describe_unsolved(std::int64_t row, const VainSearch& search, PlanStatus reached) {
  PlanResult plan;
  plan.status = reached;
  const std::string limit = reached == PlanStatus::timeout
                                ? fmt::format("{:.3g} s", search.seconds)
                                : fmt::format("{:.0f} iterations", search.iterations);
  plan.message = fmt::format(
      "no path: row {} remembers a search of {} for exactly this problem in vain; a longer limit "
      "or the setting replay at 0 (`--replay 0`) searches again",
      row, limit);
  return plan;
}

}  // namespace

std::optional<PlanResult> find_unsolved(const Query& query) {
  if (query.database == nullptr || !query.knows_vain_searches) return std::nullopt;
  const std::vector<KindInfo> held = query.database->kinds();
  if (std::ranges::find(held, kUnsolvedRows, &KindInfo::kind) == held.end()) return std::nullopt;
  const std::array keys = {to_key({digest_of_ends(query)})};
  const auto found = query.database->find(kUnsolvedRows, keys, kSameEnds, 0);
  if (!found || found->empty()) return std::nullopt;
  const std::uint64_t scene = digest_of_scene(query.problem.scene);
  for (const KeyMatch& match : *found) {
    const VainSearch search = from_key(match.experience->key);
    const auto reached = limit_reached(search, query.settings.plan);
    if (search.scene == scene && reached) {
      return describe_unsolved(match.experience->id, search, *reached);
    }
  }
  return std::nullopt;
}

void remember_unsolved(const ResolvedQuery& resolved, const PlanResult& plan) {
  const Query& query = resolved.query;
  const bool is_limit =
      plan.status == PlanStatus::timeout || plan.status == PlanStatus::iteration_limit;
  const bool may_remember =
      query.database != nullptr && query.settings.remember_after && query.knows_vain_searches;
  if (!is_limit || !may_remember || plan.iterations < kLeastIterations) return;
  const bool is_timeout = plan.status == PlanStatus::timeout;
  const VainSearch search = {digest_of_ends(query), digest_of_scene(query.problem.scene),
                             is_timeout ? query.settings.plan.timeout_s : 0,
                             static_cast<double>(plan.iterations)};
  RememberedPath start;
  start.joint_count = query.problem.robot.joint_count();
  start.waypoints.assign(resolved.ends.start.begin(), resolved.ends.start.end());
  start.planning_states = plan.states_checked;
  // A hint that is not kept is no failure of the query.
  static_cast<void>(query.database->insert_later(
      new_row(kUnsolvedRows, to_key(search), std::move(start),
              provenance_of("searched problem " + query.problem.name + " in vain",
                            query.settings.plan.seed))));
}

}  // namespace mneme::internal
