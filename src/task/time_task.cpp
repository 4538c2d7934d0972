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

std::string to_json(const Task& task, const TaskResult& result) {
  Json stages = Json::array();
  for (const StageResult& stage : result.stages) {
    Json one{{"name", stage.name}, {"kind", to_string(stage.kind)}, {"time_s", stage.time_s}};
    if (stage.alternatives > 0) one["alternatives"] = stage.alternatives;
    if (stage.alternative >= 0) one["alternative"] = stage.alternative;
    one["dropped"] = dropped_json(stage.dropped);
    one["states_checked"] = stage.states_checked;
    one["path"] = stage.path;
    stages.push_back(std::move(one));
  }
  const Json json{{"task", task.name},
                  {"status", to_string(result.status)},
                  {"message", result.message},
                  {"duration_s", result.duration_s},
                  {"first_duration_s", result.first_duration_s},
                  {"first_plan_time_s", result.first_plan_time_s},
                  {"total_time_s", result.total_time_s},
                  {"states_checked", result.states_checked},
                  {"plans", result.plans},
                  {"remembered_rows", result.remembered_rows},
                  {"stages", stages},
                  {"notes", result.notes}};
  // Names may hold bytes that are not UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mneme
