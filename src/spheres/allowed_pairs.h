// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Pairs of links that need no check.
#pragma once

#include "mneme/robot.h"

#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The checked pairs of links that touch in each of many random configurations: no configuration
/// would be valid. Costs a few configurations where there are none.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> find_inseparable_pairs(
    const Robot& robot);

}  // namespace mneme::internal
