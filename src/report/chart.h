// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The chart of planning times in an HTML report.
#pragma once

#include <span>
#include <string>

#include "report/summary.h"

namespace mneme::internal {

/// An SVG with a row per group on a logarithmic time axis: a bar from p50 to p95, a whisker to the
/// maximum and solved/total. What is censored is dashed. Colours are those of the classes sampler-0
/// to sampler-5, in order of the samplers' appearance; the page defines them, for light and dark.
/// Empty if there are no groups.
[[nodiscard]] std::string time_chart(std::span<const RunGroup> groups);

inline constexpr int kChartColors = 6;

}  // namespace mneme::internal
