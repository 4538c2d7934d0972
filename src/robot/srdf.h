// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What an SRDF says about a robot.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mneme/robot.h"

namespace mneme::internal {

/// Adds the groups, allowed pairs and warnings of an SRDF to `parts`, which are in tree order.
/// Names that the robot lacks are left aside with one warning each. Returns what is malformed.
[[nodiscard]] std::optional<Error> apply_srdf(std::string_view text, const std::string& source,
                                              Robot::Parts& parts);

}  // namespace mneme::internal
