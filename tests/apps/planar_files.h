// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems, robots and databases of the planar arm as files.
#pragma once

#include "apps/run_program.h"

#include <nlohmann/json.hpp>

namespace mneme::test {

/// Runs a command with --json.
inline nlohmann::json run_json(std::vector<std::string> arguments, int exit_code = 0) {
  arguments.emplace_back("--json");
  const ProgramRun run = run_program(arguments);
  REQUIRE_MESSAGE(run.exit_code == exit_code, run.err);
  return nlohmann::json::parse(run.out);
}

/// The geometry of the paper's first scenario: two circles with a gap of 1 m.
inline const std::vector<std::array<double, 3>> kTwoCircles = {{-5.75, -1.15, 1.73},
                                                               {-2.1, -2.85, 1.88}};
inline const Configuration kStart = {2.677, 1.211, 0.015, 0.374, -0.388, 0.592, -0.726, 1.724};
inline const Configuration kGoal = {-3.1, -1.349, 2.054, 0.563, -3.021, 0.76, 0.434, -0.002};

inline std::string planar_problem_text(
    const std::vector<std::array<double, 3>>& circles = kTwoCircles) {
  const Robot robot = planar8();
  const Problem problem{.name = "two",
                        .robot = robot,
                        .robot_path = source_file("robots/planar8.urdf"),
                        .scene = make_circle_scene("two", circles),
                        .start = kStart,
                        .goals = {kGoal}};
  return to_yaml(problem, source_file("robots/planar8.urdf"));
}

/// A directory with problem.yaml, and whatever a test adds.
class PlanarFiles {
 public:
  PlanarFiles() { write_file(directory_ / "problem.yaml", planar_problem_text()); }
  [[nodiscard]] std::string operator/(const std::string& name) const { return directory_ / name; }
  [[nodiscard]] std::string problem() const { return directory_ / "problem.yaml"; }

  /// A database that has learned the problem's one primitive.
  [[nodiscard]] std::string database() const {
    const std::string path = directory_ / "memory.db";
    if (std::filesystem::exists(path)) return path;
    require_run({"learn", "--robot", "planar8", "--scenes", problem(), "--db", path,
                 "--starts-per-link", "1", "--paths-per-start", "1", "--jobs", "1"});
    return path;
  }

  /// The same problem for an arm of three links.
  [[nodiscard]] std::string short_arm_problem() const {
    const auto urdf = require(planar_arm_urdf("short", std::vector<double>{1, 1, 1}));
    write_file(directory_ / "short.urdf", urdf);
    const auto robot = require(load_robot(directory_ / "short.urdf"));
    const Problem problem{.name = "short",
                          .robot = robot,
                          .robot_path = directory_ / "short.urdf",
                          .scene = make_circle_scene("two", kTwoCircles),
                          .start = {0, 0, 0},
                          .goals = {{1, 1, 1}}};
    write_file(directory_ / "short.yaml", to_yaml(problem, directory_ / "short.urdf"));
    return directory_ / "short.yaml";
  }

 private:
  TemporaryDirectory directory_;
};

}  // namespace mneme::test
