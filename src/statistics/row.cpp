// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include <fmt/chrono.h>

#include <sys/utsname.h>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>

namespace mneme {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t value = line.find(": ");
    if (line.starts_with("model name") && value != std::string::npos) return line.substr(value + 2);
  }
  return "unknown processor";
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang++ {}.{}", __clang_major__, __clang_minor__);
#else
  return fmt::format("g++ {}.{}", __GNUC__, __GNUC_MINOR__);
#endif
}

constexpr double kSameConfiguration = 1e-4;
/// Pose tolerances in metres and radians, those of IkSettings.
constexpr double kSamePosition = 1e-4, kSameRotation = 1e-3;

bool is_path_valid(const CollisionChecker& checker, const Problem& problem,
                   const EndTolerances& tolerances, const SolveResult& result) {
  const Robot& robot = problem.robot;
  const Path& path = result.plan.path;
  const Scene& scene = result.scene ? *result.scene : checker.scene();
  const auto is_goal = [&](const Configuration& goal) {
    return robot.distance(path.back(), goal) < kSameConfiguration;
  };
  const auto is_pose_reached = [&](const PoseGoal& goal) {
    const PoseError error = pose_error(robot, goal, path.back());
    return error.position < kSamePosition && error.rotation < kSameRotation;
  };
  const double resolution = checker.resolution() / kVerificationRefinement;
  const auto is_kept = [&](const OrientationConstraint& constraint) {
    return keeps_cone(robot, constraint, path, resolution, tolerances);
  };
  return !path.empty() && robot.distance(path.front(), problem.start) < kSameConfiguration &&
         (std::ranges::any_of(problem.goals, is_goal) ||
          std::ranges::any_of(problem.pose_goals, is_pose_reached)) &&
         std::ranges::all_of(problem.constraints, is_kept) &&
         is_path_free(robot, scene, path, resolution, tolerances);
}

/// Seconds; 0 if the path has no trajectory.
double duration_of(const Problem& problem, const SolveSettings& settings, const Path& path) {
  return find_rate_limits(problem.robot)
      .and_then([&](const RateLimits& limits) {
        return make_trajectory(problem, settings, path, limits);
      })
      .map([](const Trajectory& trajectory) { return trajectory.duration_s(); })
      .value_or(0.0);
}

}  // namespace

std::string describe_machine() {
  utsname system{};
  uname(&system);
  return fmt::format("{}, {} hardware threads, {} {}", processor(),
                     std::thread::hardware_concurrency(), system.sysname, system.release);
}

std::string describe_build() { return fmt::format("mneme {}, {}", version(), compiler()); }

std::string current_time() {
  const auto now = std::chrono::system_clock::now();
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

BenchmarkRow make_row(const Problem& problem, const SolveSettings& settings,
                      const SolveResult& result, const CollisionChecker& checker) {
  const PlanResult& plan = result.plan;
  BenchmarkRow row;
  row.problem = problem.name;
  row.planner = result.planner;
  row.sampler = result.sampler;
  row.seed = result.seed;
  row.timeout_s = settings.plan.timeout_s;
  const bool is_late = plan.is_solved() && plan.planning_time_s > row.timeout_s;
  row.status = is_late ? PlanStatus::timeout : plan.status;
  row.is_solved = plan.is_solved() && !is_late;
  row.is_path_valid =
      row.is_solved && is_path_valid(checker, problem, end_tolerances(settings), result);
  row.planning_time_s = row.is_solved ? plan.planning_time_s : row.timeout_s;
  row.total_time_s = result.total_time_s;
  row.retrieval_time_s = result.gl.retrieval_time_s;
  row.simplification_time_s = plan.simplification_time_s;
  row.verification_time_s = plan.verification_time_s;
  row.iterations = plan.iterations;
  row.states_checked = plan.states_checked;
  row.motions_checked = plan.motions_checked;
  row.nodes = plan.nodes;
  row.path_length = row.is_solved ? path_length(problem.robot, plan.path) : 0;
  if (row.is_solved) row.improvements = result.improvements;
  row.replayed = static_cast<std::uint64_t>(result.replay.row);
  if (row.is_solved) row.duration_s = duration_of(problem, settings, plan.path);
  row.learning_time_s = result.gl.learning_time_s;
  row.isa = to_string(result.isa);
  row.components = result.gl.mixture ? result.gl.mixture->component_count() : 0;
  return row;
}

}  // namespace mneme
