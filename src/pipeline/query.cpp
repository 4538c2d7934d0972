// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/query.h"

#include "base/check_ranges.h"
#include "base/threads.h"
#include "store/row_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

namespace mneme::internal {
namespace {

Result<void> check_settings(const SolveSettings& settings) {
  for (const auto& checked :
       {check_ranges(settings), check_ranges(settings.plan), check_ranges(settings.memory),
        check_ranges(settings.learn), check_ranges(settings.ik)}) {
    if (!checked) return checked;
  }
  if (settings.plan.improve_rounds && settings.plan.improve == 0) {
    return fail(ErrorCode::invalid, "improve-rounds: expected a time to improve beside it");
  }
  return {};
}

Result<void> check_robot(const Robot& robot, const Database& database) {
  // The very model that memory was learned with has its joints, whose own hash takes longer than
  // all that an easy query asks of a memory.
  if (database.signature().model_hash == robot.hash()) return {};
  const RobotSignature wanted = make_signature(robot);
  // A file without rows that is only looked at is of every robot.
  const bool is_empty = database.signature().model_hash.empty();
  if (is_empty || is_same_robot(database.signature(), wanted)) return {};
  return refuse_robot(database.info().url, database.signature(), wanted);
}

bool replays(const MemoryKind* kind) { return kind->can_replay(); }

/// Those that the settings name; or those that the database holds and this mneme knows; or, of an
/// empty one, which may be yet to come (null), the one that is about to be filled. What is to be
/// replayed or remembered as a task needs a kind that replays beside them.
Result<std::vector<const MemoryKind*>> choose_kinds(const Robot& robot, const Database* database,
                                                    const SolveSettings& settings) {
  std::vector<const MemoryKind*> kinds;
  if (settings.memory.kind) {
    const auto kind = find_memory_kind(*settings.memory.kind);
    if (!kind) return tl::unexpected(kind.error());
    if (settings.replay > 0 && !replays(*kind)) {
      return fail(ErrorCode::invalid,
                  fmt::format("setting 'replay': memory of the kind '{}' holds no whole paths, "
                              "expected the kind paths",
                              (*kind)->name));
    }
    kinds.push_back(*kind);
    return kinds;
  }
  const std::vector<KindInfo> held =
      database == nullptr ? std::vector<KindInfo>() : database->kinds();
  for (const KindInfo& info : held) {
    if (const MemoryKind* kind = memory_kind_of(info.kind)) kinds.push_back(kind);
  }
  if (kinds.empty() && !held.empty()) {
    return fail(ErrorCode::unsupported,
                fmt::format("{}: holds experience of the kind {}, which this mneme does not know",
                            database->info().url, held.front().kind));
  }
  const bool only_remembers = settings.remember_after && settings.learn_budget_s == 0;
  if (kinds.empty()) {
    kinds.push_back(only_remembers ? &default_kind_of_paths(robot) : &default_memory_kind(robot));
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
  complete.similarity = std::max(settings.similarity.value_or(defaults.similarity),
                                 std::numeric_limits<double>::denorm_min());
  complete.max_matches = settings.max_matches.value_or(defaults.max_matches);
  complete.drop_invalid_means = settings.drop_invalid_means.value_or(defaults.drop_invalid_means);
  complete.retarget = settings.retarget.value_or(defaults.retarget);
  // What is missing must be known before there is time to learn it.
  const int after = settings.learn_budget_s > 0 ? 0 : share.retrieve_after;
  complete.retrieve_after = settings.retrieve_after.value_or(after);
  // Components are drawn from in a fraction lambda of the iterations.
  complete.widening = {settings.first_components.value_or(defaults.first_components),
                       settings.component_growth / std::max(complete.lambda, 1e-3)};
  complete.max_gap = settings.memory.max_gap.value_or(defaults.max_gap);
  complete.replay = replays(&kind) ? settings.replay : 0;
  return complete;
}

Result<void> check_budget(const SolveSettings& settings, const std::vector<KindSettings>& kinds) {
  const auto learns = [](const KindSettings& kind) { return kind.kind->can_learn_primitives(); };
  if (settings.learn_budget_s == 0 || std::ranges::any_of(kinds, learns)) return {};
  const MemoryKind& kind = *kinds.front().kind;
  return fail(ErrorCode::unsupported,
              fmt::format("setting 'learn-budget': memory of the kind '{}' does not learn on a "
                          "miss; 'remember-after' learns from solved problems",
                          kind.name));
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

bool is_memory_used(const SamplerEntry& sampler, const SolveSettings& settings) {
  if (settings.memory_mode == MemoryMode::off) return false;
  return sampler.draws_from_memory || settings.replay > 0 || settings.remember_after;
}

/// Only a sampler that queries memory finds out what is missing there.
Result<void> check_learning(const SamplerEntry& sampler, const SolveSettings& settings) {
  if (settings.learn_budget_s == 0 || sampler.draws_from_memory) return {};
  return fail(
      ErrorCode::invalid,
      fmt::format("setting 'learn-budget': sampler '{}' does not query memory, expected one "
                  "that does, such as gl",
                  sampler.name));
}

Result<void> check_together(const PlannerEntry& planner, const SamplerEntry& sampler,
                            const SolveSettings& settings, bool is_constrained) {
  if (is_constrained && !planner.projects) {
    std::vector<std::string> able;
    for (const PlannerEntry& entry : planners()) {
      if (entry.projects) able.push_back(entry.name);
    }
    return fail(ErrorCode::unsupported,
                fmt::format("planner '{}' cannot keep constraints, expected one of {}",
                            planner.name, fmt::join(able, ", ")));
  }
  if (settings.threads > 1 && planner.is_exclusive) {
    return fail(ErrorCode::invalid,
                fmt::format("setting 'threads': planner '{}' searches alone in a process, expected "
                            "1, got {}",
                            planner.name, settings.threads));
  }
  if (planner.draws_valid_states || !sampler.draws_valid_states) return {};
  return fail(ErrorCode::invalid,
              fmt::format("sampler '{}' is for planners that draw valid states, such as ompl:PRM, "
                          "not '{}'",
                          sampler.name, planner.name));
}

/// Errors: a problem that a kind does not handle. Ends that are no configurations are refused
/// later.
Result<void> check_primitives(const Problem& problem, const std::vector<KindSettings>& kinds) {
  const auto is_wrong = [&](const Configuration& q) {
    return problem.robot.describe_violation(q, "q").has_value();
  };
  if (problem.goals.empty() || is_wrong(problem.start) ||
      std::ranges::any_of(problem.goals, is_wrong)) {
    return {};
  }
  for (const KindSettings& kind : kinds) {
    MNEME_TRY(kind.kind->decompose(memory_query(problem, problem.goals), kind.max_gap));
  }
  return {};
}

}  // namespace

CheckerSettings Query::checker_settings() const {
  return {settings.resolution, settings.margin, settings.isa, problem.constraints};
}

bool Query::is_over() const {
  return is_set(settings.plan.cancel) || stopwatch.elapsed_s() >= settings.plan.timeout_s;
}

double Query::remaining_s() const {
  return std::max(0.0, settings.plan.timeout_s - stopwatch.elapsed_s());
}

Result<Query> make_query(const Problem& problem, Database* database, const SolveSettings& asked) {
  const SolveSettings settings = with_memory_mode(asked);
  const SamplerEntry& sampler = *MNEME_TRY(find_sampler(settings.sampler));
  const PlannerEntry& planner = *MNEME_TRY(find_planner(settings.planner));
  MNEME_TRY(check_settings(settings));
  MNEME_TRY(check_together(planner, sampler, settings, !problem.constraints.empty()));
  Query query{problem, nullptr, settings, planner, sampler, {}, {}};
  if (database == nullptr) return query;
  MNEME_TRY(check_learning(sampler, settings));
  if (!is_memory_used(sampler, settings)) return query;
  MNEME_TRY(check_robot(problem.robot.without_attached(), *database));
  query.kinds = MNEME_TRY(complete_kinds(problem.robot, database, settings));
  query.database = database;
  return query;
}

}  // namespace mneme::internal

namespace mneme {

Result<void> check_query(const Problem& problem, const SolveSettings& settings) {
  const internal::Query query = MNEME_TRY(internal::make_query(problem, nullptr, settings));
  MNEME_TRY(make_query_checker(problem.robot, problem.scene, query.checker_settings(),
                               {problem.start, problem.goals}));
  MNEME_TRY(internal::check_learning(query.sampler, settings));
  if (!internal::is_memory_used(query.sampler, settings)) return {};
  const auto kinds = MNEME_TRY(internal::complete_kinds(problem.robot, nullptr, query.settings));
  return internal::check_primitives(problem, kinds);
}

}  // namespace mneme
