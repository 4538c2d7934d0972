// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learns how to get through one gap, then plans in a scene with a similar one, with and without
/// that memory: with rrt, since rrt_connect's walks escape from such a gap without any. The
/// database is the file given, or learned.db.
#include "mneme/mneme.h"

#include <cstdio>

namespace {

/// Two circles that hold an arm threaded between them.
const mneme::PrimitiveKey kLearned = {1.7, 2.3, 1.1, 3.4, 0.5, 1.1};

int fail_with(const mneme::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

mneme::Result<mneme::Database> learn(const mneme::Robot& robot, const char* path) {
  const auto space = mneme::make_signature(robot);
  auto database = mneme::Database::open(path, space, mneme::OpenMode::create);
  if (!database) return database;
  const mneme::PrimitiveKey key = mneme::make_primitive(kLearned).key;
  const auto summary = mneme::learn_primitives(robot, {&key, 1}, *database, {});
  if (!summary) return tl::unexpected(summary.error());
  std::printf("learned %d primitives, %d known before\n", static_cast<int>(summary->learned),
              static_cast<int>(summary->skipped));
  return database;
}

}  // namespace

int main(int argument_count, char** arguments) {
  const auto problem =
      mneme::find_scene("planar/threaded_b0.yaml").and_then([](const std::string& file) {
        return mneme::load_problem(file);
      });
  if (!problem) return fail_with(problem.error());
  auto memory = learn(problem->robot, argument_count > 1 ? arguments[1] : "learned.db");
  if (!memory) return fail_with(memory.error());

  mneme::SolveSettings settings;
  settings.planner = "rrt";
  for (mneme::Database* database : {&*memory, static_cast<mneme::Database*>(nullptr)}) {
    const auto result = mneme::solve(*problem, database, settings);
    if (!result) return fail_with(result.error());
    if (!result->plan.is_solved()) return std::puts(result->plan.message.c_str()), 3;
    std::printf("%s memory: %d samples, %.2f ms\n", database != nullptr ? "with" : "without",
                static_cast<int>(result->plan.iterations), 1e3 * result->planning_time_s);
  }
  return 0;
}
