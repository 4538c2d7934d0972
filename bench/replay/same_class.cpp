// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_same_class TASKS.json REPEATS.json MEMORY.db
//
// Counts the replayed and the planned paths that are of the same homotopy class as the path in
// memory of the same task. A path counts if it can be deformed into the stored one without contact
// while the obstacles move from their present to their former poses. The name of a problem of
// REPEATS, up to an underscore, is that of a problem of TASKS.
#include "mneme/benchmark.h"
#include "mneme/mneme.h"

#include "support/deformation.h"
#include "take.h"

#include <cstdio>
#include <map>
#include <string>
#include <utility>

namespace mneme::bench {
namespace {

struct Task {
  Problem problem;
  Path path;
};

std::string task_of(const std::string& problem) { return problem.substr(0, problem.find('_')); }

std::vector<LoadedProblem> load(const std::string& file) {
  return take(load_bench_problems({{file, "", "", "", ""}}, {}, {}));
}

/// With the path that the memory has of each.
std::map<std::string, Task> load_tasks(const std::string& file, const Database& database) {
  std::map<std::string, Task> tasks;
  for (LoadedProblem& loaded : load(file)) {
    const std::string name = task_of(loaded.problem.name);
    tasks.try_emplace(name, Task{std::move(loaded.problem), {}});
  }
  for (std::int64_t i = 0; i < database.size(); ++i) {
    const Experience row = take(database.get(i));
    for (auto& [name, task] : tasks) {
      if (!row.provenance.settings.starts_with("solved problem " + name + "_")) continue;
      const auto joints = static_cast<std::size_t>(row.path().joint_count);
      for (auto q = row.path().waypoints.begin(); q != row.path().waypoints.end();
           q += static_cast<std::ptrdiff_t>(joints)) {
        task.path.emplace_back(q, q + static_cast<std::ptrdiff_t>(joints));
      }
    }
  }
  return tasks;
}

struct Tally {
  int paths = 0, same = 0;

  void add(const Task& task, const Problem& problem, const Path& path) {
    ++paths;
    test::Deformation deformation(problem.robot, task.problem.scene, problem.scene);
    same += deformation.find(task.path, path);
  }
  void print(const char* what) const {
    std::printf("%-9s %6d paths, %6d of the remembered path's class: %.2f %%\n", what, paths, same,
                100.0 * same / std::max(paths, 1));
  }
};

int run(const std::string& tasks_file, const std::string& repeats_file, const std::string& memory) {
  const std::vector<LoadedProblem> problems = load(repeats_file);
  Database database = take(
      Database::open(memory, make_signature(problems.front().problem.robot), OpenMode::read_only));
  const std::map<std::string, Task> tasks = load_tasks(tasks_file, database);
  Tally replayed, planned;
  SolveSettings settings;
  settings.replay = 0.5;
  settings.plan.timeout_s = 1;
  for (const LoadedProblem& loaded : problems) {
    const auto found = tasks.find(task_of(loaded.problem.name));
    if (found == tasks.end() || found->second.path.empty()) continue;
    const SolveResult with = take(solve(loaded.problem, &database, settings));
    if (with.replay.is_hit()) replayed.add(found->second, loaded.problem, with.plan.path);
    const SolveResult without = take(solve(loaded.problem, nullptr, settings));
    if (without.plan.is_solved()) planned.add(found->second, loaded.problem, without.plan.path);
  }
  std::printf("%zu problems of %zu tasks\n", problems.size(), tasks.size());
  replayed.print("replayed");
  planned.print("planned");
  return 0;
}

}  // namespace
}  // namespace mneme::bench

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: mneme_same_class TASKS.json REPEATS.json MEMORY.db\n");
    return 2;
  }
  return mneme::bench::run(argv[1], argv[2], argv[3]);
}
