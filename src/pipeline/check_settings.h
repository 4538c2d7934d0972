// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "mneme/pipeline.h"

namespace mneme::internal {

/// "a, b, c", for messages.
[[nodiscard]] std::string join(std::span<const std::string_view> names);

/// Every number of the settings and of their parts within its declared range.
[[nodiscard]] Result<void> check_ranges(const SolveSettings& settings);

/// That continuous verification is not asked for together with none.
[[nodiscard]] Result<void> check_verification(const PlanSettings& settings);

/// That `settings.sampler` is one of `names`.
[[nodiscard]] Result<void> check_sampler(const SolveSettings& settings,
                                         std::span<const std::string_view> names);

}  // namespace mneme::internal
