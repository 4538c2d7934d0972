// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The identity of a robot model.
#pragma once

#include <span>
#include <string>
#include <utility>

#include "mneme/robot.h"

namespace mneme::internal {

/// 16 hexadecimal digits over all that decides whether a configuration is valid. Values count in
/// steps of 1e-9. Databases store the result: whoever changes what goes in changes the version in
/// robot_hash.cpp too.
[[nodiscard]] std::string hash_robot(std::span<const Link> links, std::span<const Joint> joints,
                                     std::span<const int> group,
                                     std::span<const std::pair<int, int>> self_pairs);

}  // namespace mneme::internal
