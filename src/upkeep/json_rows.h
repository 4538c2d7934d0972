// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Experience as lines of JSON.
#pragma once

#include "mneme/store.h"

#include <string>
#include <string_view>

namespace mneme::internal {

/// The first line of a file: the robot signature.
[[nodiscard]] std::string json_of(const RobotSignature& signature);
/// The line of one row, without its id.
[[nodiscard]] std::string json_of(const Experience& row);

// Errors: parse, without file and line.
[[nodiscard]] Result<RobotSignature> parse_signature(std::string_view line);
/// Array sizes are not checked against a signature.
[[nodiscard]] Result<Experience> parse_row(std::string_view line);

}  // namespace mneme::internal
