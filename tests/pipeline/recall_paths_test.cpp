// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/recall_paths.h"

#include "pipeline/complete_settings.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

struct PathMemory {
  Problem problem = planar_problem("threaded_b4");
  TemporaryDirectory directory;
  Database database =
      Database::open(directory / "m.db", make_space(problem.robot), OpenMode::create).value();

  void remember(const std::vector<Path>& paths) {
    REQUIRE(database.insert(learn_whole_paths(problem.robot, paths)).has_value());
  }
  [[nodiscard]] GlSampler recall(const SolveSettings& settings = {}) {
    return *internal::recall_paths(problem, database,
                                   internal::complete_settings(settings, problem.robot, &database));
  }
};

Path bent(const Configuration& start, const Configuration& goal, double bend) {
  Configuration middle;
  for (std::size_t i = 0; i < start.size(); ++i) {
    middle.push_back(0.5 * (start[i] + goal[i]) + bend);
  }
  return {start, middle, goal};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the paths of the most similar queries come first, at most max-matches of them") {
    PathMemory memory;
    const Configuration& start = memory.problem.start;
    const Configuration& goal = memory.problem.goals[0];
    Configuration near = goal, far = goal;
    near[3] += 0.1;
    far[3] += 0.4;
    memory.remember({bent(start, far, 0.1), bent(start, near, 0.2), bent(goal, start, 0.3)});
    SolveSettings settings;
    settings.max_matches = 2;
    const GlSampler gl = memory.recall(settings);
    REQUIRE(gl.primitives.size() == 1);
    REQUIRE(gl.primitives[0].matches.size() == 2);
    CHECK(gl.primitives[0].matches[0].similarity_error == doctest::Approx(0));
    CHECK(gl.primitives[0].matches[1].experience->id == 2);
    CHECK(gl.mixture->component_count() == 4);
    CHECK(memory.recall().mixture->component_count() == 6);
  }

  TEST_CASE("each goal is asked for") {
    PathMemory memory;
    const Configuration goal = memory.problem.goals[0];
    memory.problem.goals.push_back(memory.problem.start);
    memory.remember({bent(memory.problem.start, goal, 0.1)});
    const GlSampler gl = memory.recall();
    REQUIRE(gl.primitives.size() == 2);
    CHECK(gl.mixture->origins == std::vector<Origin>{0, 0, 1, 1});
  }

  TEST_CASE("an empty memory has nothing to say") {
    PathMemory memory;
    CHECK(memory.recall().mixture->component_count() == 0);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a problem is solved with fewer samples once its paths are remembered") {
    PathMemory memory;
    SolveSettings settings;
    settings.sampler = "uniform";
    const auto first = solve(memory.problem, nullptr, settings);
    REQUIRE(first.has_value());
    REQUIRE(first->plan.is_solved());
    memory.remember({first->plan.path});
    settings.sampler = "gl";
    settings.retrieve_after = 0;
    std::uint64_t with_memory = 0, without = 0;
    for (int seed = 2; seed < 7; ++seed) {
      settings.plan.seed = static_cast<std::uint64_t>(seed);
      const auto with = solve(memory.problem, &memory.database, settings);
      const auto uniform = solve(memory.problem, nullptr, settings);
      REQUIRE(with.has_value());
      REQUIRE(uniform.has_value());
      CHECK(with->plan.is_solved());
      CHECK(with->gl.primitives.size() == 1);
      with_memory += with->plan.iterations;
      without += uniform->plan.iterations;
    }
    CHECK(2 * with_memory < without);
  }

  TEST_CASE("a scene without a query cannot ask a memory of paths") {
    PathMemory memory;
    SolveSettings settings;
    settings.decompose.decomposer = "paths";
    const auto gl =
        create_gl_sampler(memory.problem.robot, memory.problem.scene, memory.database, settings);
    REQUIRE_FALSE(gl.has_value());
    CHECK(gl.error().code == ErrorCode::invalid);
    CHECK(gl.error().message.find("start and goal") != std::string::npos);
  }
}

}  // namespace mneme::test
