// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "pipeline/settings_input.h"

#include <fmt/format.h>

#include <sys/utsname.h>
#include <algorithm>
#include <fstream>
#include <thread>
#include <type_traits>
#include <utility>

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

bool check_path(const CollisionChecker& checker, const Problem& problem,
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

using SettingTexts = std::vector<std::pair<std::string, std::string>>;

/// Names and values of all settings, in order of declaration.
SettingTexts all_texts(const SolveSettings& settings) {
  SettingTexts texts;
  internal::visit_all_settings(
      settings, [&](std::string_view name, const auto& value, auto, auto, std::string_view) {
        if constexpr (SettingTraits<std::remove_cvref_t<decltype(value)>>::kIsOptional) {
          texts.emplace_back(name, value ? fmt::format("{}", *value) : "");
        } else {
          texts.emplace_back(name, fmt::format("{}", value));
        }
      });
  return texts;
}

}  // namespace

std::string describe_machine() {
  utsname system{};
  uname(&system);
  return fmt::format("{}, {} hardware threads, {} {}", processor(),
                     std::thread::hardware_concurrency(), system.sysname, system.release);
}

std::string describe_build() { return fmt::format("mneme {}, {}", version(), compiler()); }

std::string describe_settings(const SolveSettings& settings) {
  const auto texts = all_texts(settings);
  const auto defaults = all_texts(SolveSettings{});
  std::string text;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto& [name, value] = texts[i];
    if (value == defaults[i].second || name == "timeout" || name == "seed") continue;
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, value);
  }
  return text;
}

BenchmarkRow make_row(const Problem& problem, const SolveSettings& settings,
                      const SolveResult& result, const CollisionChecker& checker,
                      std::optional<bool> is_path_valid) {
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
  if (row.is_solved && !is_path_valid) {
    is_path_valid = check_path(checker, problem, end_tolerances(settings), result);
  }
  row.is_path_valid = row.is_solved && *is_path_valid;
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
