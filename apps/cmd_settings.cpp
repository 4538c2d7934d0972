// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme settings: the declarations of all settings as JSON; tools/generate_settings.py reads it.
#include "mneme/cell.h"
#include "mneme/line.h"
#include "mneme/pipeline.h"

#include "commands.h"
#include "console.h"
#include "options.h"

#include <nlohmann/json.hpp>

#include <limits>
#include <memory>
#include <type_traits>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
constexpr const char* kTypeName = std::is_same_v<Value, bool> ? "bool"
                                  : std::is_integral_v<Value> ? "int"
                                                              : "float";

/// The settings that `Settings` declares, with their defaults.
template <class Settings>
Json settings_of() {
  Json all = Json::array();
  const Settings defaults;
  visit_settings(defaults, [&](const char* name, const auto& value, auto least, auto most,
                               const char* meaning) {
    using Setting = std::remove_cvref_t<decltype(value)>;
    using Value = SettingValue<Setting>;
    constexpr bool kIsOptional = SettingTraits<Setting>::kIsOptional;
    Json& setting = all.emplace_back(
        Json{{"name", name}, {"type", kTypeName<Value>}, {"optional", kIsOptional}});
    if constexpr (kIsOptional) {
      setting["default"] = nullptr;
    } else {
      setting["default"] = value;
    }
    if constexpr (!std::is_same_v<Value, bool>) {
      setting["least"] = static_cast<Value>(least);
      const bool is_bounded = static_cast<Value>(most) != std::numeric_limits<Value>::max();
      setting["most"] = is_bounded ? Json(static_cast<Value>(most)) : Json();
    }
    setting["meaning"] = meaning;
  });
  return all;
}

/// The defaults that depend on the kind of memory.
Json kinds() {
  Json names = Json::array(), rows = Json::array();
  for (const MemoryKind* kind : memory_kinds()) names.push_back(kind->name);
  for (const KindDefault& row : kind_defaults()) {
    rows.push_back({{"name", row.setting}, {"values", row.values}});
  }
  return {{"group", "kinds"}, {"kinds", names}, {"settings", rows}};
}

}  // namespace

void add_settings_list(CLI::App& program, Action& action) {
  const auto is_json = std::make_shared<bool>();
  const auto run = [](const bool&) -> Result<ExitCode> {
    print_json({{{"group", "plan"}, {"settings", settings_of<PlanSettings>()}},
                {{"group", "solve"}, {"settings", settings_of<SolveSettings>()}},
                {{"group", "memory"}, {"settings", settings_of<MemorySettings>()}},
                kinds(),
                {{"group", "learn"}, {"settings", settings_of<LearnSettings>()}},
                {{"group", "trajectory"}, {"settings", settings_of<TrajectorySettings>()}},
                {{"group", "ik"}, {"settings", settings_of<IkSettings>()}},
                {{"group", "line"}, {"settings", settings_of<LineSettings>()}},
                {{"group", "cell"}, {"settings", settings_of<CellSettings>()}}});
    return ExitCode::done;
  };
  CLI::App& command =
      add_command<bool>(program, action, "settings", "Print all settings, defaults and ranges",
                        "settings > settings.json", is_json, run);
  command.add_flag("--json", *is_json, "the only format, and the default");
}

}  // namespace mneme::app
