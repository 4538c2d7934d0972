// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Between the planners' single precision and the public double precision.
#pragma once

#include "mneme/path.h"

#include <span>
#include <vector>

namespace mneme::internal {

[[nodiscard]] std::vector<float> to_floats(std::span<const double> q);
/// Row by row.
[[nodiscard]] std::vector<float> to_rows(const Path& path);
/// Within the limits, which floats may miss by rounding.
[[nodiscard]] Path to_path(const Robot& robot, const std::vector<std::vector<float>>& path);

}  // namespace mneme::internal
