// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Settings of solve() in files and requests, by their names.
#pragma once

#include "mneme/pipeline.h"

#include "scene/input.h"

#include <fmt/format.h>

#include <string_view>
#include <type_traits>

namespace mneme::internal {

/// All settings of solve(), as visit_settings tells them.
template <class Settings, class Visitor>
void visit_all_settings(Settings& settings, const Visitor& visitor) {
  visit_settings(settings, visitor);
  visit_settings(settings.plan, visitor);
  visit_settings(settings.memory, visitor);
  visit_settings(settings.learn, visitor);
  visit_settings(settings.ik, visitor);
}

/// Reads each of its settings that `map` has, for visit_settings. Throws InputFailure.
class SettingsReader {
 public:
  explicit SettingsReader(const Input& map) : map_(map) {}

  template <class T>
  void operator()(std::string_view name, T& value, SettingValue<T> least, SettingValue<T> most,
                  std::string_view) const {
    using Value = SettingValue<T>;
    const auto input = map_.find(name);
    if (!input) return;
    if constexpr (std::is_same_v<Value, bool>) {
      value = input->boolean();
    } else {
      const double number = input->number();
      // Written so that a NaN is out of range.
      const bool is_inside =
          number >= static_cast<double>(least) && number <= static_cast<double>(most);
      constexpr bool kIsWhole = std::is_integral_v<Value>;
      const bool is_whole = !kIsWhole || number == static_cast<double>(to<Value>(number));
      if (!is_inside || !is_whole) {
        input->fail_expecting(
            fmt::format("{} from {} to {}", kIsWhole ? "a whole number" : "a number", least, most));
      }
      value = to<Value>(number);
    }
  }

 private:
  /// A cast of a number that T cannot hold would be undefined.
  template <class T>
  static T to(double number) {
    if (!(number > -1e18 && number < 1e18)) return T{};
    return static_cast<T>(number);
  }

  const Input& map_;
};

}  // namespace mneme::internal
