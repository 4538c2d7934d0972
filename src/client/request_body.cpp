// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "client/request_body.h"

#include "pipeline/settings_input.h"

#include <string_view>

namespace mneme::internal {
namespace {

using Json = nlohmann::json;

/// Those that are set, by name.
class SettingsWriter {
 public:
  explicit SettingsWriter(Json& map) : map_(map) {}

  template <class T>
  void operator()(std::string_view name, const T& value, SettingValue<T>, SettingValue<T>,
                  std::string_view) const {
    if constexpr (SettingTraits<T>::kIsOptional) {
      if (value) map_[std::string(name)] = *value;
    } else {
      map_[std::string(name)] = value;
    }
  }

 private:
  Json& map_;
};

Json all_of(const SolveSettings& settings) {
  Json map = {{"planner", settings.planner}, {"sampler", settings.sampler}};
  if (settings.memory.kind) map["kind"] = *settings.memory.kind;
  visit_all_settings(settings, SettingsWriter(map));
  return map;
}

Json all_of(const IkSettings& settings) {
  Json map = {{"seed", settings.seed}};
  visit_settings(settings, SettingsWriter(map));
  return map;
}

/// The service's own defaults count for what is left as it was.
template <class Settings>
Json changed(const Settings& settings) {
  const Json before = all_of(Settings()), after = all_of(settings);
  Json map = Json::object();
  for (const auto& [name, value] : after.items()) {
    if (!before.contains(name) || before[name] != value) map[name] = value;
  }
  return map;
}

/// The only problem of a compact file.
Json problem_of(const std::string& compact_file) {
  return Json::parse(compact_file)["problems"][0];
}

}  // namespace

Json scene_body(const Scene& scene) {
  Json body = problem_of(to_compact_json({scene, ""}));
  body.erase("name");
  return body;
}

Json plan_body(const Problem& problem, const std::string& scene_id, const SolveSettings& settings) {
  Json body = problem_of(to_compact_json(problem, ""));
  if (!scene_id.empty()) {
    for (const char* key : {"obstacles", "circles", "allow"}) body.erase(key);
    body["scene"] = scene_id;
  }
  for (int i = 0; i < problem.robot.joint_count(); ++i) {
    body["joints"].push_back(problem.robot.group_joint(i).name);
  }
  body["settings"] = changed(settings);
  return body;
}

Json ik_body(std::span<const PoseGoal> goals, const Configuration& near, const Scene& scene,
             const IkSettings& settings) {
  Json body = scene_body(scene);
  body["near"] = near;
  body["goals"] = Json::array();
  for (const PoseGoal& goal : goals) body["goals"].push_back(Json::parse(to_json(goal)));
  body["settings"] = changed(settings);
  return body;
}

}  // namespace mneme::internal
