// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/threads.h"
#include "learning/run.h"
#include "store/store.h"

#include <fmt/format.h>

#include <bit>
#include <set>
#include <utility>

namespace mneme {
namespace {

/// Hash of all inputs of a lesson that decide what it teaches; Provenance::lesson.
Result<std::uint64_t> lesson_of(const Problem& problem, const MemorySettings& memory,
                                const ProblemLesson& lesson) {
  const MemoryKind* const kind = MNEME_TRY(choose_kind(problem.robot, memory));
  internal::ColumnDigest inputs;
  inputs.add(kind->version).add(to_compact_json(problem, problem.robot.hash()));
  inputs.add(std::bit_cast<std::int64_t>(memory.max_gap.value_or(-1)));
  inputs.add(lesson.paths).add(std::bit_cast<std::int64_t>(lesson.seed));
  return std::bit_cast<std::uint64_t>(inputs.value());
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
  const auto finished = MNEME_TRY(database.finished_lessons());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const std::uint64_t number = MNEME_TRY(lesson_of(problems[i], memory, lesson));
    if (!finished.contains(number)) open.push_back(i);
  }
  return open;
}

Result<internal::Learned> learn_from_problem(const Problem& problem, const MemorySettings& memory,
                                             const ProblemLesson& lesson) {
  if (problem.goals.empty() && !problem.pose_goals.empty()) {
    return internal::Learned{
        {},
        fmt::format("{}: not solved: lessons need joint values as a goal, not a pose",
                    problem.name)};
  }
  const auto plan = MNEME_TRY(solve_repeatedly(problem, lesson));
  if (plan.paths.empty()) {
    return internal::Learned{{}, fmt::format("{}: not solved: {}", problem.name, plan.message)};
  }
  auto rows = MNEME_TRY(learn_from_paths({problem.robot.without_attached(), problem.scene,
                                          &problem.start, problem.goals, problem.constraints},
                                         plan.paths, memory));
  drop_repetitions(rows);
  const std::uint64_t number = MNEME_TRY(lesson_of(problem, memory, lesson));
  for (Experience& row : rows) {
    row.provenance = {fmt::format("mneme {}", version()),
                      fmt::format("{} paths of problem {}", lesson.paths, problem.name),
                      lesson.seed,
                      {},
                      number};
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
  settings.walk = lesson.walk;
  RepeatedPlan repeated;
  for (int i = 0; i < lesson.paths && !internal::is_set(lesson.cancel); ++i) {
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
                                         const ProblemLesson& given) {
  for (const Problem& problem : problems) {
    MNEME_TRY(check_robot(problem.robot.without_attached(), database));
  }
  ProblemLesson lesson = given;
  if (lesson.walk == std::nullopt && memory.kind) {
    const MemoryKind* const kind = MNEME_TRY(find_memory_kind(*memory.kind));
    // Among many boxes a walk's step costs a hundred iterations, and passages alone need none.
    if (kind->is_placed_by_checking) lesson.walk = 0;
  }
  auto open = MNEME_TRY(open_problems(problems, memory, lesson, database));
  const internal::Tasks tasks = {
      std::move(open), static_cast<std::int64_t>(problems.size()),
      [&](std::size_t task) { return learn_from_problem(problems[task], memory, lesson); }};
  return internal::run_local(database, tasks, lesson);
}

}  // namespace mneme
