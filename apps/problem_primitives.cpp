// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "problem_primitives.h"

#include "console.h"

#include <fmt/format.h>

namespace mneme::app {
namespace {

Result<std::vector<LocalPrimitive>> find_queries(const Problem& problem) {
  const Robot& robot = problem.robot;
  std::vector<LocalPrimitive> queries;
  auto violation = robot.describe_violation(problem.start, "start");
  for (const Configuration& goal : problem.goals) {
    if (!violation) violation = robot.describe_violation(goal, "goal");
    if (violation) return fail(ErrorCode::invalid, *violation);
    queries.push_back(make_query_primitive(robot, problem.start, goal));
  }
  return queries;
}

}  // namespace

Result<std::vector<LocalPrimitive>> find_primitives(const Problem& problem,
                                                    const DecomposeSettings& settings) {
  if (settings.decomposer == "paths") return find_queries(problem);
  return decompose(problem.robot, problem.scene, settings);
}

bool is_query(const LocalPrimitive& primitive) { return primitive.obstacles.empty(); }

std::string describe(const Scene& scene, const LocalPrimitive& primitive, std::size_t index) {
  if (is_query(primitive)) return fmt::format("query to goal {}", index + 1);
  std::string names;
  for (const int obstacle : primitive.obstacles) {
    names += names.empty() ? "" : " and ";
    names += printable(scene.obstacles.at(static_cast<std::size_t>(obstacle)).name);
  }
  return names;
}

std::string_view unit_of_error(const LocalPrimitive& primitive) {
  return is_query(primitive) ? "rad^2" : "m^2";
}

}  // namespace mneme::app
