// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/suite_settings.h"

#include "mneme/benchmark.h"

#include <algorithm>

namespace mneme {
namespace {

/// Names and values of settings as text, in order of declaration.
template <class Settings>
void append_texts(const Settings& settings,
                  std::vector<std::pair<std::string, std::string>>& texts) {
  visit_settings(settings,
                 [&](std::string_view name, const auto& value, auto, auto, std::string_view) {
                   if constexpr (SettingTraits<std::remove_cvref_t<decltype(value)>>::is_optional) {
                     texts.emplace_back(name, value ? fmt::format("{}", *value) : "");
                   } else {
                     texts.emplace_back(name, fmt::format("{}", value));
                   }
                 });
}

std::vector<std::pair<std::string, std::string>> all_texts(const SolveSettings& settings) {
  std::vector<std::pair<std::string, std::string>> texts;
  append_texts(settings, texts);
  append_texts(settings.plan, texts);
  append_texts(settings.memory, texts);
  append_texts(settings.learn, texts);
  return texts;
}

}  // namespace

namespace internal {

void read_solve_settings(const Input& map, SolveSettings& settings) {
  const SettingsReader reader(map);
  visit_settings(settings, reader);
  visit_settings(settings.plan, reader);
  visit_settings(settings.memory, reader);
  visit_settings(settings.learn, reader);
}

std::vector<std::string_view> solve_setting_names() {
  std::vector<std::string_view> names = setting_names<SolveSettings>();
  for (const auto& more : {setting_names<PlanSettings>(), setting_names<MemorySettings>(),
                           setting_names<LearnSettings>()}) {
    names.insert(names.end(), more.begin(), more.end());
  }
  std::erase(names, "seed");
  return names;
}

}  // namespace internal

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

}  // namespace mneme
