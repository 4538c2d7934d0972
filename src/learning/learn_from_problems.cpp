// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/run.h"
#include "store/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace mneme {
namespace {

/// Provenance of a row, with a hash that distinguishes problems of equal names.
std::string provenance_text(const Problem& problem, const MemorySettings& memory,
                            const ProblemLesson& lesson) {
  std::string all = to_compact_json(problem, problem.robot.hash());
  if (memory.max_gap) all += fmt::format("max-gap={}", *memory.max_gap);
  const auto hash = static_cast<std::uint64_t>(internal::hash_bytes(std::as_bytes(std::span(all))));
  return fmt::format("{} paths of problem {} ({:016x})", lesson.paths, problem.name, hash);
}

/// Removes rows with equal content, such as those of straight paths: the database keeps one, but
/// the summary would count all.
void drop_repetitions(std::vector<Experience>& rows) {
  std::set<internal::ContentHash> known;
  std::erase_if(rows, [&](const Experience& row) {
    return !known.insert(internal::EncodedRow(row).content()).second;
  });
}

/// Indices of the problems that were not learned yet.
Result<std::vector<std::size_t>> open_problems(std::span<const Problem> problems,
                                               const MemorySettings& memory,
                                               const ProblemLesson& lesson,
                                               const Database& database) {
  std::set<std::pair<std::string, std::string>> known;  // kinds and texts
  MNEME_TRY(database.for_each([&](const auto& row) {
    if (row->provenance.seed == lesson.seed) known.emplace(row->kind, row->provenance.settings);
  }));
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const MemoryKind* const kind = MNEME_TRY(choose_kind(problems[i].robot, memory));
    const std::string text = provenance_text(problems[i], memory, lesson);
    if (!known.contains({std::string(kind->version), text})) open.push_back(i);
  }
  return open;
}

Result<internal::Learned> learn_from_problem(const Problem& problem, const MemorySettings& memory,
                                             const ProblemLesson& lesson) {
  const auto plan = MNEME_TRY(solve_repeatedly(problem, lesson));
  if (plan.paths.empty()) {
    return internal::Learned{{}, fmt::format("{}: not solved: {}", problem.name, plan.message)};
  }
  auto rows = MNEME_TRY(learn_from_paths({problem.robot.without_attached(), problem.scene,
                                          &problem.start, problem.goals, problem.constraints},
                                         plan.paths, memory));
  drop_repetitions(rows);
  const std::string text = provenance_text(problem, memory, lesson);
  for (Experience& row : rows) {
    row.provenance = {fmt::format("mneme {}", version()), text, lesson.seed, {}};
  }
  return internal::Learned{std::move(rows), {}};
}

}  // namespace

Result<RepeatedPlan> solve_repeatedly(const Problem& problem, const ProblemLesson& lesson) {
  if (!(lesson.timeout_s >= 0 && lesson.timeout_s <= 1e6)) {
    return fail(ErrorCode::invalid, "a path's time limit must be 0 to 1e6 seconds");
  }
  const auto checker = MNEME_TRY(
      CollisionChecker::make(problem.robot, problem.scene, {.constraints = problem.constraints}));
  const auto sampler = make_uniform_sampler(problem.robot);
  PlanSettings settings;
  settings.timeout_s = lesson.timeout_s;
  settings.cancel = lesson.cancel;
  RepeatedPlan repeated;
  for (int i = 0; i < lesson.paths && !internal::is_cancelled(lesson); ++i) {
    settings.seed = derive_seed(lesson.seed, static_cast<std::uint64_t>(i));
    PlanResult plan =
        plan_with(rrt_connect, checker, {problem.start, problem.goals}, *sampler, settings);
    if (plan.is_solved()) {
      repeated.paths.push_back(std::move(plan.path));
    } else {
      repeated.message = std::move(plan.message);
    }
  }
  return repeated;
}

Result<LearnSummary> learn_from_problems(std::span<const Problem> problems,
                                         const MemorySettings& memory, Database& database,
                                         const ProblemLesson& lesson) {
  auto open = MNEME_TRY(open_problems(problems, memory, lesson, database));
  const internal::Tasks tasks = {
      std::move(open), static_cast<std::int64_t>(problems.size()),
      [&](std::size_t task) { return learn_from_problem(problems[task], memory, lesson); }};
  return internal::run_local(database, tasks, lesson);
}

}  // namespace mneme
