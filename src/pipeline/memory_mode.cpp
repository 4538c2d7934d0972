// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include <fmt/format.h>

namespace mneme {

std::string_view to_string(MemoryMode mode) {
  switch (mode) {
    case MemoryMode::automatic:
      return "auto";
    case MemoryMode::off:
      return "off";
    case MemoryMode::paper:
      break;
  }
  return "paper";
}

Result<MemoryMode> parse_memory_mode(std::string_view name) {
  for (const MemoryMode mode : {MemoryMode::automatic, MemoryMode::off, MemoryMode::paper}) {
    if (name == to_string(mode)) return mode;
  }
  return fail(ErrorCode::invalid,
              fmt::format("memory is '{}': expected auto, off or paper (as in the paper)", name));
}

SolveSettings with_memory_mode(SolveSettings settings) {
  if (settings.memory_mode != MemoryMode::paper) return settings;
  const auto set = [](auto& setting, auto value) {
    if (!setting) setting = value;
  };
  set(settings.lambda, 0.5);
  set(settings.least_lambda, *settings.lambda);
  set(settings.sigma, 0.1);
  set(settings.similarity, 3.0);
  set(settings.max_matches, 1000000);
  set(settings.mirror, false);
  set(settings.drop_invalid_means, false);
  set(settings.retarget, false);
  set(settings.retrieve_after, 0);
  set(settings.replay, 0.0);
  set(settings.first_components, 1e9);
  set(settings.plan.walk, 0.0);
  set(settings.plan.anchor, 0.0);
  set(settings.learn.walks, false);
  return settings;
}

}  // namespace mneme
