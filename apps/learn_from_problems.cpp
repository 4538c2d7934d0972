// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "learn_from_problems.h"

#include "mneme/benchmark.h"
#include "mneme/pipeline.h"

#include "console.h"
#include "inputs.h"

#include <fmt/format.h>

#include <chrono>
#include <set>

namespace mneme::app {
namespace {

/// Says in the provenance what a row was learned from.
std::string describe(const Problem& problem, const ProblemLesson& lesson) {
  return fmt::format("{} paths of problem {}", lesson.paths, problem.name);
}

using KnownLessons = std::set<std::pair<std::string, std::uint64_t>>;

Result<KnownLessons> lessons_in(const Database& database) {
  KnownLessons lessons;
  return database
      .for_each(
          [&](const auto& row) { lessons.emplace(row->provenance.settings, row->provenance.seed); })
      .map([&] { return std::move(lessons); });
}

}  // namespace

Result<std::vector<Problem>> load_lesson(const ProblemLesson& lesson,
                                         const ProblemOptions& overrides) {
  const auto found = find_bench_problems(lesson.problems).and_then([&](auto problems) {
    return take_part(std::move(problems), lesson.part);
  });
  if (!found) return tl::unexpected(found.error());
  std::vector<Problem> problems;
  for (const BenchProblem& entry : *found) {
    Result<Problem> problem = load_problem(entry.where, overrides);
    if (!problem) return tl::unexpected(problem.error());
    if (!problems.empty() && problems.front().robot.hash() != problem->robot.hash()) {
      return fail(
          ErrorCode::invalid,
          fmt::format("'{}': its robot '{}' differs from that of '{}'; expected problems of "
                      "one robot",
                      entry.where, problem->robot.name(), found->front().where));
    }
    problem->name = fmt::format("{}#{}", entry.set, problem->name);
    problems.push_back(std::move(*problem));
  }
  return problems;
}

Result<RepeatedPlan> solve_repeatedly(const Problem& problem, const ProblemLesson& lesson) {
  RepeatedPlan plan;
  for (int i = 0; i < lesson.paths && !interrupt_flag()->load(); ++i) {
    SolveSettings settings;
    settings.sampler = "uniform";
    settings.plan.seed = derive_seed(lesson.seed, static_cast<std::uint64_t>(i));
    settings.plan.timeout_s = lesson.timeout_s;
    settings.plan.cancel = interrupt_flag();
    Result<SolveResult> solved = solve(problem, nullptr, settings);
    if (!solved) return tl::unexpected(solved.error());
    if (solved->plan.is_solved()) {
      plan.paths.push_back(std::move(solved->plan.path));
    } else {
      plan.message = std::move(solved->plan.message);
    }
  }
  return plan;
}

Result<ProblemLessonSummary> learn_from_problems(std::span<const Problem> problems,
                                                 const ProblemLesson& lesson,
                                                 const DecomposeSettings& decompose,
                                                 Database& database) {
  const auto begin = std::chrono::steady_clock::now();
  const auto known = lessons_in(database);
  if (!known) return tl::unexpected(known.error());
  ProblemLessonSummary summary;
  Progress progress("learning");
  for (const Problem& problem : problems) {
    progress.update(summary.learned + summary.skipped + summary.unsolved,
                    static_cast<std::int64_t>(problems.size()),
                    fmt::format("{} components", summary.components));
    const std::string settings = describe(problem, lesson);
    if (known->contains({settings, lesson.seed})) {
      ++summary.skipped;
      continue;
    }
    const Result<RepeatedPlan> plan = solve_repeatedly(problem, lesson);
    if (!plan) return tl::unexpected(plan.error());
    if ((summary.is_cancelled = interrupt_flag()->load())) break;
    if (plan->paths.empty()) {
      ++summary.unsolved;
      print_note(fmt::format("{}: not solved: {}", problem.name, plan->message));
      continue;
    }
    auto rows = learn_from_paths(problem.robot, problem.scene, plan->paths, decompose);
    if (!rows) return tl::unexpected(rows.error());
    ++summary.learned;
    for (Experience& row : *rows) {
      row.provenance = {fmt::format("mneme {}", version()), settings, lesson.seed, {}};
      summary.components += row.sampler.component_count();
    }
    summary.rows += static_cast<std::int64_t>(rows->size());
    if (rows->empty()) continue;
    if (auto inserted = database.insert(std::move(*rows)); !inserted) {
      return tl::unexpected(inserted.error());
    }
  }
  summary.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace mneme::app
