// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Checks settings against the ranges that their visit_settings declares.
#pragma once

#include "mneme/base.h"

#include <fmt/format.h>

#include <string>
#include <type_traits>

namespace mneme::internal {

/// Error: invalid; names the first setting outside its range.
template <class Settings>
[[nodiscard]] Result<void> check_ranges(const Settings& settings) {
  std::string problem;
  const auto check = [&](const char* name, const auto& value, auto least, auto most) {
    // NaN fails, too.
    if (problem.empty() && !(value >= least && value <= most)) {
      problem = fmt::format("setting '{}' is {}: expected {} to {}", name, value, least, most);
    }
  };
  visit_settings(settings,
                 [&](const char* name, const auto& value, auto least, auto most, const char*) {
                   if constexpr (SettingTraits<std::remove_cvref_t<decltype(value)>>::kIsOptional) {
                     if (value) check(name, *value, least, most);
                   } else {
                     check(name, value, least, most);
                   }
                 });
  if (!problem.empty()) return fail(ErrorCode::invalid, problem);
  return {};
}

}  // namespace mneme::internal
