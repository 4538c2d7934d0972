// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Box plots of planning times.
#pragma once

#include <string>
#include <vector>

#include "benchmark/panels.h"

namespace mneme::internal {

/// An SVG figure: one box per series on a logarithmic axis, from the first to the third quartile
/// with the median, whiskers to the shortest and longest time, a dot per run, solved/total above,
/// and a cross at the limit for each time-out. Failures count as longer than any success; what they
/// leave open is dashed. `samplers` gives colours.
[[nodiscard]] std::string box_plot(const Panel& panel, const std::vector<std::string>& samplers);

}  // namespace mneme::internal
