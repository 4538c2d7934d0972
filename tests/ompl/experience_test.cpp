// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

namespace mneme::test {
namespace {

std::vector<Path> solved_paths(const Problem& problem) {
  SolveSettings settings;
  settings.sampler = "uniform";
  const SolveResult result = require_solved(problem, nullptr, settings);
  return {result.plan.path};
}

Result<void> train(const std::string& name, const Robot& robot, std::span<const Path> paths,
                   const std::string& file) {
  return ompl_planner(name).train(robot, paths, file);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("only Lightning and Thunder have experience") {
    for (const std::string& name : ompl_names()) {
      const bool learns = name == "Lightning" || name == "Thunder";
      CHECK_MESSAGE(static_cast<bool>(ompl_planner(name).train) == learns, name);
    }
  }

  TEST_CASE("paths that are none of the robot's are refused") {
    const Robot robot = gap_problem().robot;
    const TemporaryDirectory directory;
    const std::vector<Path> wrong = {{}, {{0, 0, 0}, {0, 0}}, {{0, 0, 0}, {0, 0, std::nan("")}}};
    for (const Path& path : wrong) {
      for (const char* name : {"Lightning", "Thunder"}) {
        const Error error = require_error(train(name, robot, {&path, 1}, directory / name));
        CHECK(error.code == ErrorCode::invalid);
      }
    }
  }

  TEST_CASE("experience that is missing, or cannot be written, is an error that names the file") {
    const Problem problem = gap_problem();
    SolveSettings settings = settings_for("Lightning");
    settings.plan.experience_path = "no/such/file";
    const Error error = require_error(solve(problem, nullptr, settings));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "no/such/file"));
    const auto trained =
        train("Lightning", problem.robot, solved_paths(problem), "no/such/directory/file");
    REQUIRE(!trained.has_value());
    CHECK(contains(trained.error().message, "no/such/directory/file"));
  }
}

TEST_SUITE("flow") {
  TEST_CASE("Lightning and Thunder solve a problem with the experience of it") {
    const Problem problem = gap_problem();
    const std::vector<Path> paths = solved_paths(problem);
    const TemporaryDirectory directory;
    for (const char* name : {"Lightning", "Thunder"}) {
      CAPTURE(name);
      SolveSettings settings = settings_for(name);
      settings.plan.experience_path = directory / name;
      require(train(name, problem.robot, paths, settings.plan.experience_path));
      CHECK(read_file(settings.plan.experience_path).size() > 100);
      const SolveResult result = require_solved(problem, nullptr, settings);
      CHECK(problem.robot.distance(result.plan.path.back(), problem.goals[0]) < 1e-9);
    }
  }
}

}  // namespace mneme::test
