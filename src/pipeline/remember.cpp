// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/remember.h"

#include "base/stopwatch.h"
#include "mneme/learning.h"

namespace mneme::internal {
namespace {

Result<int> insert_lesson(const Problem& problem, const Path& path, Database& database,
                          const SolveSettings& settings) {
  auto rows =
      learn_from_paths(problem.robot, problem.scene, std::vector<Path>{path}, settings.decompose);
  if (!rows) return tl::unexpected(rows.error());
  for (Experience& row : *rows) {
    row.provenance = {"mneme " + std::string(version()),
                      "solved problem " + problem.name,
                      settings.plan.seed,
                      {}};
  }
  if (rows->empty()) return 0;
  return database.insert(std::move(*rows)).map([](const auto& ids) {
    return static_cast<int>(ids.size());
  });
}

}  // namespace

Remembered remember(const Problem& problem, const PlanResult& plan, Database& database,
                    const SolveSettings& settings) {
  Remembered remembered;
  const bool is_wanted = settings.remember_after >= 0 && plan.is_solved() &&
                         plan.iterations >= static_cast<std::uint64_t>(settings.remember_after);
  if (!is_wanted) return remembered;
  const Stopwatch stopwatch;
  if (const auto rows = insert_lesson(problem, plan.path, database, settings)) {
    remembered.rows = *rows;
  } else {
    remembered.failure = rows.error().message;
  }
  remembered.time_s = stopwatch.elapsed_s();
  return remembered;
}

}  // namespace mneme::internal
