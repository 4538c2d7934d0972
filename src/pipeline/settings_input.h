// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Settings of solve() by name, for files and requests.
#pragma once

#include "mneme/pipeline.h"

#include "input/input.h"

#include <fmt/format.h>

#include <string_view>
#include <type_traits>
#include <utility>

namespace mneme::internal {

/// Visits all settings of solve().
template <class Settings, class Visitor>
void visit_all_settings(Settings& settings, const Visitor& visitor) {
  visit_settings(settings, visitor);
  visit_settings(settings.plan, visitor);
  visit_settings(settings.memory, visitor);
  visit_settings(settings.learn, visitor);
  visit_settings(settings.ik, visitor);
}

/// Visitor that reads the settings in `map`. Throws InputFailure.
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
    } else if constexpr (std::is_integral_v<Value>) {
      const auto number = input->whole_number();
      if (!number || std::cmp_less(*number, least) || std::cmp_greater(*number, most)) {
        input->fail_expecting(fmt::format("a whole number from {} to {}", least, most));
      }
      value = static_cast<Value>(*number);
    } else {
      const double number = input->number();
      // Written so that a NaN is out of range.
      if (!(number >= least && number <= most)) {
        input->fail_expecting(fmt::format("a number from {} to {}", least, most));
      }
      value = number;
    }
  }

 private:
  const Input& map_;
};

}  // namespace mneme::internal
