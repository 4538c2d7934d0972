// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/task.h"

#include <nlohmann/json.hpp>

#include <iterator>
#include <utility>

namespace mneme {
namespace {

/// Radians of L2 joint distance by which a timed line may leave its path.
constexpr double kLineTolerance = 2e-4;

using Json = nlohmann::ordered_json;

Json dropped_json(const std::vector<Dropped>& all) {
  Json list = Json::array();
  for (const Dropped& dropped : all) {
    list.push_back(
        {{"reason", to_string(dropped.reason)}, {"count", dropped.count}, {"what", dropped.what}});
  }
  return list;
}

/// The fingers move as fast as their own limits allow.
Result<Trajectory> time_gripper(const GripperMotion& gripper, const SolveSettings& settings,
                                const TrajectorySettings& timing, double speed) {
  RateLimits limits = MNEME_TRY(find_rate_limits(gripper.world->robot, timing));
  for (double& value : limits.velocity) value *= speed;
  return make_trajectory(*gripper.world, settings, gripper.path, limits, timing);
}

Json gripper_json(const GripperMotion& gripper) {
  Json json = Json::object();
  const std::vector<std::string> names = gripper.world->robot.joint_names();
  const Configuration &from = gripper.path.front(), &to = gripper.path.back();
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (from[j] != to[j]) json[names[j]] = {from[j], to[j]};
  }
  return json;
}

}  // namespace

Result<TaskMotion> time_task(const Task& task, const TaskResult& result,
                             const SolveSettings& settings, const RateLimits& limits,
                             const TrajectorySettings& timing) {
  std::vector<Trajectory::Stretch> stretches;
  std::vector<double> begins_s;
  std::vector<std::optional<Trajectory>> stages;
  double end_s = 0;
  for (std::size_t i = 0; i < result.stages.size(); ++i) {
    const StageResult& stage = result.stages[i];
    begins_s.push_back(end_s);
    stages.emplace_back();
    if (stage.gripper) {
      Trajectory motion =
          MNEME_TRY(time_gripper(*stage.gripper, settings, timing, task.stages[i].speed));
      stretches.push_back({end_s, stage.path.back()});  // the group rests
      end_s += motion.duration_s();
      stages.back() = std::move(motion);
      continue;
    }
    if (stage.path.size() < 2) continue;
    RateLimits slower = limits;
    for (double& value : slower.velocity) value *= task.stages[i].speed;
    TrajectorySettings near_path = timing;
    if (stage.kind == StageKind::line) {
      near_path.path_tolerance = std::min(timing.path_tolerance, kLineTolerance);
      near_path.time_rounds = 0;
    }
    Trajectory motion =
        MNEME_TRY(make_trajectory(*stage.world, settings, stage.path, slower, near_path));
    for (Trajectory::Stretch stretch : motion.stretches()) {
      stretch.begin_s += end_s;
      stretches.push_back(std::move(stretch));
    }
    end_s += motion.duration_s();
    stages.back() = std::move(motion);
  }
  return TaskMotion{Trajectory(std::move(stretches), result.stages.back().path.back(), end_s),
                    std::move(begins_s), std::move(stages)};
}

std::string to_json(const Task& task, const TaskResult& result, const TaskMotion* motion) {
  Json stages = Json::array();
  for (std::size_t i = 0; i < result.stages.size(); ++i) {
    const StageResult& stage = result.stages[i];
    Json one{
        {"name", stage.name}, {"kind", to_string(stage.kind)}, {"path_time_s", stage.path_time_s}};
    if (motion != nullptr) one["begin_s"] = motion->begins_s[i];
    if (stage.alternatives > 0) one["alternatives"] = stage.alternatives;
    if (stage.alternative >= 0) one["alternative"] = stage.alternative;
    one["dropped"] = dropped_json(stage.dropped);
    one["states_checked"] = stage.states_checked;
    one["path"] = stage.path;
    if (stage.gripper) one["gripper"] = gripper_json(*stage.gripper);
    stages.push_back(std::move(one));
  }
  Json json{{"task", task.name},
            {"status", to_string(result.status)},
            {"message", result.message},
            {"path_time_s", result.path_time_s},
            {"first_path_time_s", result.first_path_time_s},
            {"first_plan_time_s", result.first_plan_time_s},
            {"total_time_s", result.total_time_s},
            {"states_checked", result.states_checked},
            {"plans", result.plans},
            {"remembered_rows", result.remembered_rows},
            {"stages", stages},
            {"notes", result.notes}};
  if (motion != nullptr) json["duration_s"] = motion->trajectory.duration_s();
  // Names may hold bytes that are not UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mneme
