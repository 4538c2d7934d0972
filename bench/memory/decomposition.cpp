// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_decomposition MEMORY.db PROBLEM...
//
// Tells why means that the paper's rules retrieve are in contact. Blocked by the two obstacles of
// their own primitive: the match is another primitive (the paper's similarity error). Free among
// these two and blocked in the scene: other obstacles are near (its decomposition error).
#include "mneme/benchmark.h"
#include "mneme/mneme.h"

#include "take.h"

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace mneme::bench {
namespace {

/// Flags of the means that are free among these obstacles.
std::vector<std::uint8_t> find_free(const Robot& robot, Scene scene, const GaussianMixture& means) {
  const auto checker = take(CollisionChecker::make(robot, std::move(scene), {}));
  std::vector<std::uint8_t> is_free(static_cast<std::size_t>(means.component_count()));
  checker.check_states(means.means, is_free);
  return is_free;
}

Scene only(const Scene& scene, const std::vector<int>& obstacles) {
  Scene part{scene.name, {}};
  for (const int i : obstacles)
    part.obstacles.push_back(scene.obstacles[static_cast<std::size_t>(i)]);
  return part;
}

void print_shares(const Problem& problem, Database& database) {
  SolveSettings settings;
  settings.memory_mode = MemoryMode::paper;
  const SolveResult result = take(solve(problem, &database, settings));
  const auto& mixture = result.gl.mixture;
  if (mixture == nullptr || mixture->component_count() == 0) {
    std::printf("%-12s nothing retrieved\n", problem.name.c_str());
    return;
  }
  const auto is_free = find_free(problem.robot, problem.scene, *mixture);
  std::size_t free = 0, similarity = 0, decomposition = 0;
  for (std::size_t p = 0; p < result.gl.primitives.size(); ++p) {
    const auto& obstacles = result.gl.primitives[p].primitive.obstacles;
    const auto is_free_of_pair = find_free(problem.robot, only(problem.scene, obstacles), *mixture);
    for (std::size_t i = 0; i < is_free.size(); ++i) {
      if (mixture->sources[i] != static_cast<SampleSource>(p)) continue;
      free += is_free[i];
      similarity += is_free_of_pair[i] == 0;
      decomposition += is_free_of_pair[i] != 0 && is_free[i] == 0;
    }
  }
  const double percent = 100.0 / mixture->component_count();
  std::printf(
      "%-10s %2zu primitives %7d means: %4.1f %% free, %4.1f %% touch their own, %4.1f %% others\n",
      problem.name.c_str(), result.gl.primitives.size(), mixture->component_count(),
      percent * static_cast<double>(free), percent * static_cast<double>(similarity),
      percent * static_cast<double>(decomposition));
}

}  // namespace
}  // namespace mneme::bench

int main(int argc, char** argv) {
  using namespace mneme;
  if (argc < 3) {
    std::fprintf(stderr, "usage: mneme_decomposition MEMORY.db PROBLEM...\n");
    return 2;
  }
  std::vector<SuiteProblems> files;
  for (int i = 2; i < argc; ++i) files.push_back({argv[i]});
  const auto problems = bench::take(load_bench_problems(files, {}, {}));
  const Robot& robot = problems.front().problem.robot;
  Database database =
      bench::take(Database::open(argv[1], make_signature(robot), OpenMode::read_only));
  for (const LoadedProblem& loaded : problems) bench::print_shares(loaded.problem, database);
  return 0;
}
