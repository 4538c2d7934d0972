// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Curves of how many runs were solved after a time.
#pragma once

#include <string>
#include <vector>

#include "benchmark/panels.h"

namespace mneme::internal {

/// An SVG figure: a diagram per planner, in it a curve per series, which rises at each planning
/// time of a success on a logarithmic axis. Colours tell samplers, dashes settings.
[[nodiscard]] std::string solved_curves(const Panel& panel,
                                        const std::vector<std::string>& samplers);

}  // namespace mneme::internal
