// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/check_settings.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {
namespace {

template <class Settings>
Result<void> check_part(const Settings& settings) {
  std::string problem;
  visit_settings(
      settings, [&](const char* name, const auto& value, auto least, auto most, const char*) {
        // Written so that a value that is not a number fails too.
        if (problem.empty() && !(value >= least && value <= most)) {
          problem = fmt::format("setting '{}' is {}: expected {} to {}", name, value, least, most);
        }
      });
  if (!problem.empty()) return fail(ErrorCode::invalid, problem);
  return {};
}

}  // namespace

std::string join(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

Result<void> check_ranges(const SolveSettings& settings) {
  for (const auto& checked : {check_part(settings), check_part(settings.plan),
                              check_part(settings.decompose), check_part(settings.learn)}) {
    if (!checked) return checked;
  }
  return {};
}

Result<void> check_verification(const PlanSettings& settings) {
  if (settings.verify || !settings.continuous) return {};
  return fail(ErrorCode::invalid,
              "setting 'continuous' is a way to verify: expected it with 'verify' only");
}

Result<void> check_sampler(const SolveSettings& settings, std::span<const std::string_view> names) {
  if (std::find(names.begin(), names.end(), settings.sampler) != names.end()) return {};
  return fail(ErrorCode::invalid,
              "unknown sampler '" + settings.sampler + "': expected one of " + join(names));
}

}  // namespace mneme::internal
