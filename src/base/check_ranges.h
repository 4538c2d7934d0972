// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Settings against the ranges that visit_settings declares beside them.
#pragma once

#include "mneme/base.h"

#include <fmt/format.h>

#include <string>
#include <type_traits>

namespace mneme::internal {

/// Error: invalid, naming the first setting that is not within its declared range.
template <class Settings>
[[nodiscard]] Result<void> check_ranges(const Settings& settings) {
  std::string problem;
  const auto check = [&](const char* name, const auto& value, auto least, auto most) {
    // Written so that a value that is not a number fails too.
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
