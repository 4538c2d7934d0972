// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/task_file.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace mneme {
namespace {

using Json = nlohmann::ordered_json;

Json dropped_json(const std::vector<Dropped>& all) {
  Json list = Json::array();
  for (const Dropped& dropped : all) {
    list.push_back(
        {{"reason", to_string(dropped.reason)}, {"count", dropped.count}, {"what", dropped.what}});
  }
  return list;
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
            {"preparation_time_s", result.preparation_time_s},
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
