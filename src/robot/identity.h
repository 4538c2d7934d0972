// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Hashes that identify a robot in databases.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <string>
#include <utility>

namespace mneme::internal {

/// See Robot::hash(). Values are rounded to 1e-9. Databases store the result: a change of the
/// content needs a new version in identity.cpp.
[[nodiscard]] std::string hash_robot(std::span<const Link> links, std::span<const Joint> joints,
                                     std::span<const int> group,
                                     std::span<const std::pair<int, int>> self_pairs,
                                     std::span<const std::pair<int, int>> exact_pairs = {});

/// See Robot::kinematics_hash(): the group's joints, their followers that carry one of them, and
/// the frames of both. Values are rounded to 1e-9. Databases store the result.
[[nodiscard]] std::string hash_kinematics(std::span<const Joint> joints,
                                          std::span<const int> group);

}  // namespace mneme::internal
