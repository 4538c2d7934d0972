// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Hashes by which databases know a robot.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <string>
#include <utility>

namespace mneme::internal {

/// 16 hexadecimal digits over all that decides whether a configuration is valid. Values count in
/// steps of 1e-9. Databases store the result: whoever changes what goes in changes the version in
/// identity.cpp too.
[[nodiscard]] std::string hash_robot(std::span<const Link> links, std::span<const Joint> joints,
                                     std::span<const int> group,
                                     std::span<const std::pair<int, int>> self_pairs);

/// 16 hexadecimal digits over what the group's joints do: 8 over the frames that they and the
/// joints that follow them stand in on the way from the root, 8 over their limits. Joints that
/// carry no joint of the group do not count. Values count in steps of 1e-9; databases store the
/// result.
[[nodiscard]] std::string hash_kinematics(std::span<const Joint> joints,
                                          std::span<const int> group);

}  // namespace mneme::internal
