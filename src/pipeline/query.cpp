// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/query.h"

#include "base/check_ranges.h"
#include "base/fail.h"
#include "base/threads.h"
#include "store/row_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

namespace mneme::internal {
namespace {

/// Distance of replay for tasks that repeat, radians.
constexpr double kRepeated = 0.5;

bool replays(const MemoryKind* kind) { return kind->can_replay(); }
bool is_placed(const MemoryKind* kind) { return kind->is_placed_by_checking; }

/// The distance of replay: kRepeated by default if whole paths are remembered and the choice of
/// memory is left to the database.
double replay_distance(const Database& database, const SamplerEntry& sampler,
                       const SolveSettings& settings) {
  if (settings.replay) return *settings.replay;
  if (settings.memory.kind || !sampler.uses_memory || settings.learn_budget_s > 0) return 0;
  const bool holds_paths = std::ranges::any_of(database.kinds(), [](const KindInfo& info) {
    const MemoryKind* const kind = memory_kind_of(info.kind);
    return kind != nullptr && replays(kind);
  });
  return holds_paths ? kRepeated : 0;
}

/// Returns the kind of the settings; otherwise the known kinds in the database; otherwise, for an
/// empty or missing (null) database, the robot's default. Replay adds a kind that can replay.
Result<std::vector<const MemoryKind*>> choose_kinds(const Robot& robot, const Database* database,
                                                    const SolveSettings& settings) {
  std::vector<const MemoryKind*> kinds;
  if (settings.memory.kind) {
    kinds.push_back(MNEME_TRY(find_memory_kind(*settings.memory.kind)));
    return kinds;
  }
  std::vector<KindInfo> held = database == nullptr ? std::vector<KindInfo>() : database->kinds();
  std::erase_if(held, [](const KindInfo& info) {
    return info.kind == kTaskRows || info.kind == kUnsolvedRows;
  });
  for (const KindInfo& info : held) {
    if (const MemoryKind* kind = memory_kind_of(info.kind)) kinds.push_back(kind);
  }
  if (kinds.empty() && !held.empty()) {
    return fail(ErrorCode::unsupported,
                "{}: experience of the kind '{}' is unknown to this version of mneme",
                database->info().url, held.front().kind);
  }
  const bool only_remembers = settings.remember_after && settings.learn_budget_s == 0;
  if (kinds.empty()) {
    kinds.push_back(only_remembers ? &default_kind_of_paths(robot) : &default_memory_kind(robot));
  }
  if (only_remembers && std::ranges::none_of(kinds, is_placed)) {
    const MemoryKind* motions = *std::ranges::find_if(memory_kinds(), is_placed);
    if (motions->handles(robot)) kinds.push_back(motions);
  }
  if (settings.replay > 0 && std::ranges::none_of(kinds, replays)) {
    kinds.push_back(*std::ranges::find_if(memory_kinds(), replays));
  }
  return kinds;
}

MemoryShare default_share(const MemoryDefaults& defaults, const SolveSettings& settings) {
  const auto planner = find_planner(settings.planner);
  const bool walks = planner && (*planner)->walks && settings.plan.walk != 0.0;
  return defaults.share_for(walks);
}

KindSettings complete(const MemoryKind& kind, const SolveSettings& settings) {
  const MemoryDefaults& defaults = kind.defaults;
  const MemoryShare share = default_share(defaults, settings);
  KindSettings complete;
  complete.kind = &kind;
  complete.lambda = settings.lambda.value_or(share.lambda);
  complete.least_lambda =
      settings.least_lambda.value_or(share.least_lambda.value_or(complete.lambda));
  complete.sigma = settings.sigma.value_or(defaults.sigma);
  complete.matches = {std::max(settings.similarity.value_or(defaults.similarity),
                               std::numeric_limits<double>::denorm_min()),
                      settings.max_matches.value_or(defaults.max_matches),
                      settings.mirror.value_or(true)};
  complete.drop_invalid_means = settings.drop_invalid_means.value_or(defaults.drop_invalid_means);
  complete.retarget = settings.retarget.value_or(defaults.retarget);
  // Learning needs the misses of a query, so that memory must be queried at once.
  const int after = settings.learn_budget_s > 0 ? 0 : share.retrieve_after;
  complete.retrieve_after = settings.retrieve_after.value_or(after);
  // A fraction lambda of the iterations samples from components.
  complete.widening = {settings.first_components.value_or(defaults.first_components),
                       settings.component_growth / std::max(complete.lambda, 1e-3)};
  complete.max_gap = settings.memory.max_gap.value_or(defaults.max_gap);
  complete.replay = replays(&kind) ? settings.replay.value_or(0) : 0;
  return complete;
}

Result<void> check_budget(const SolveSettings& settings, const std::vector<KindSettings>& kinds) {
  const auto learns = [](const KindSettings& kind) { return kind.kind->can_learn_primitives(); };
  if (settings.learn_budget_s == 0 || std::ranges::any_of(kinds, learns)) return {};
  const MemoryKind& kind = *kinds.front().kind;
  return fail(ErrorCode::unsupported,
              "setting 'learn-budget': memory of the kind '{}' cannot learn while planning; "
              "'remember-after' learns from solved problems",
              kind.name);
}

Result<std::vector<KindSettings>> complete_kinds(const Robot& robot, const Database* database,
                                                 const SolveSettings& settings) {
  std::vector<KindSettings> completed;
  for (const MemoryKind* kind : MNEME_TRY(choose_kinds(robot, database, settings))) {
    completed.push_back(complete(*kind, settings));
  }
  MNEME_TRY(check_budget(settings, completed));
  return completed;
}

/// Query::ask_after; `query` is complete otherwise.
std::optional<std::uint64_t> ask_after(const Query& query, bool is_distance_given) {
  if (is_distance_given || !query.planner.walks) return std::nullopt;
  const KindSettings* kind = query.replayed_kind();
  const bool pays =
      kind != nullptr && query.may_change_memory() && query.database->pays(kind->kind->version);
  return pays ? 0 : kAlone;
}

bool is_memory_used(const SamplerEntry& sampler, const SolveSettings& settings) {
  if (settings.memory_mode == MemoryMode::off) return false;
  return sampler.uses_memory || settings.replay > 0 || settings.remember_after;
}

/// Only a sampler that queries memory knows its misses.
Result<void> check_learning(const SamplerEntry& sampler, const SolveSettings& settings) {
  if (settings.learn_budget_s == 0 || sampler.uses_memory) return {};
  return fail(ErrorCode::invalid,
              "setting 'learn-budget': sampler '{}' does not query memory, expected one that does, "
              "such as gl",
              sampler.name);
}

Result<void> check_constraints(const PlannerEntry& planner, const Problem& problem) {
  if (problem.constraints.empty() || planner.projects) return {};
  std::vector<std::string> able;
  for (const PlannerEntry& entry : planners()) {
    if (entry.projects) able.push_back(entry.name);
  }
  return fail(ErrorCode::unsupported, "planner '{}' cannot keep constraints, expected one of {}",
              planner.name, fmt::join(able, ", "));
}

Result<void> check_replay(const SolveSettings& settings) {
  if (!settings.memory.kind) return {};
  const MemoryKind* kind = MNEME_TRY(find_memory_kind(*settings.memory.kind));
  if (settings.replay.value_or(0) == 0 || replays(kind)) return {};
  return fail(ErrorCode::invalid,
              "setting 'replay': memory of the kind '{}' holds no whole paths, expected the kind "
              "paths",
              kind->name);
}

Result<void> check_together(const PlannerEntry& planner, const SamplerEntry& sampler,
                            const SolveSettings& settings) {
  if (settings.threads > 1 && planner.is_exclusive) {
    return fail(ErrorCode::invalid,
                "setting 'threads': only one search of planner '{}' can run in a process, expected "
                "1, got {}",
                planner.name, settings.threads);
  }
  if (planner.samples_valid_states || !sampler.samples_valid_states) return {};
  return fail(ErrorCode::invalid,
              "sampler '{}' is for planners that sample valid states, such as ompl:PRM, not '{}'",
              sampler.name, planner.name);
}

/// Errors: a problem that a kind does not handle. Invalid ends are refused later.
Result<void> check_primitives(const Problem& problem, const std::vector<KindSettings>& kinds) {
  const auto is_wrong = [&](const Configuration& q) { return !problem.robot.is_configuration(q); };
  if (problem.goals.empty() || is_wrong(problem.start) ||
      std::ranges::any_of(problem.goals, is_wrong)) {
    return {};
  }
  for (const KindSettings& kind : kinds) {
    MNEME_TRY(kind.kind->decompose(memory_query(problem), kind.max_gap));
  }
  return {};
}

}  // namespace

CheckerSettings checker_settings_of(const SolveSettings& settings,
                                    const std::vector<OrientationConstraint>& constraints) {
  return {settings.resolution, settings.margin, settings.isa, constraints};
}

const KindSettings* Query::replayed_kind() const {
  const auto kind = std::ranges::find_if(kinds, [](const auto& k) { return k.replay > 0; });
  return kind == kinds.end() ? nullptr : &*kind;
}

bool Query::is_over() const {
  return is_set(settings.plan.cancel) || stopwatch.elapsed_s() >= settings.plan.timeout_s;
}

double Query::remaining_s() const {
  return std::max(0.0, settings.plan.timeout_s - stopwatch.elapsed_s());
}

Result<Query> make_query(const Problem& problem, Database* database,
                         const SolveSettings& settings) {
  MNEME_TRY(check_settings(settings));
  const SamplerEntry* sampler = MNEME_TRY(find_sampler(settings.sampler));
  const PlannerEntry* planner = MNEME_TRY(find_planner(settings.planner));
  MNEME_TRY(check_constraints(*planner, problem));
  Query query{problem, nullptr, with_memory_mode(settings), *planner, *sampler, {}, {}};
  if (database == nullptr) return query;
  MNEME_TRY(check_learning(*sampler, settings));
  if (!is_memory_used(*sampler, settings)) return query;
  MNEME_TRY(check_robot(problem.robot.without_attached(), *database));
  query.settings.replay = replay_distance(*database, *sampler, query.settings);
  query.kinds = MNEME_TRY(complete_kinds(problem.robot, database, query.settings));
  query.database = database;
  query.ask_after = ask_after(query, settings.replay.has_value());
  query.knows_vain_searches =
      settings.memory_mode == MemoryMode::automatic && settings.replay != 0.0;
  return query;
}

}  // namespace mneme::internal

namespace mneme {

Result<void> check_settings(const SolveSettings& settings) {
  using internal::check_ranges;
  const SamplerEntry* sampler = MNEME_TRY(find_sampler(settings.sampler));
  const PlannerEntry* planner = MNEME_TRY(find_planner(settings.planner));
  MNEME_TRY(check_ranges(settings));
  MNEME_TRY(check_ranges(settings.plan));
  MNEME_TRY(check_ranges(settings.memory));
  MNEME_TRY(check_ranges(settings.learn));
  MNEME_TRY(check_ranges(settings.ik));
  if (settings.plan.improve_rounds && settings.plan.improve == 0) {
    return fail(ErrorCode::invalid,
                "setting 'improve-rounds' has no effect without 'improve': set a time to improve");
  }
  MNEME_TRY(internal::check_replay(settings));
  return internal::check_together(*planner, *sampler, settings);
}

Result<void> check_query(const Problem& problem, const SolveSettings& settings) {
  const internal::Query query = MNEME_TRY(internal::make_query(problem, nullptr, settings));
  MNEME_TRY(make_query_checker(problem.robot, problem.scene, query.checker_settings(),
                               {problem.start, problem.goals}));
  MNEME_TRY(internal::check_learning(query.sampler, settings));
  if (!internal::is_memory_used(query.sampler, settings)) return {};
  const std::vector<internal::KindSettings> kinds =
      MNEME_TRY(internal::complete_kinds(problem.robot, nullptr, query.settings));
  return internal::check_primitives(problem, kinds);
}

}  // namespace mneme
