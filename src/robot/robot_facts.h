// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What follows from links, joints and group: the plane, the pairs to check, the identity.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// True if all joints of the group, and all that follow them, turn about the z axis of a frame
/// whose z axis is parallel to the root's, and all shapes are centred in z = 0; to within 1e-9. It
/// is enough to look at one configuration, since such joints keep z.
[[nodiscard]] bool moves_in_plane(std::span<const Link> links, std::span<const Joint> joints,
                                  std::span<const int> group);

using LinkPairs = std::vector<std::pair<int, int>>;

/// Pairs of links whose rigid bodies one moving joint connects.
[[nodiscard]] LinkPairs find_neighbours(std::span<const Link> links, std::span<const Joint> joints,
                                        std::span<const int> group);

/// Pairs of links with shapes, first < second, that the joints of `group` and those that follow
/// them move against each other, except `allowed` ones (in any order); only those whose second link
/// is `first_second` or a later one. Other joints weld links into bodies.
[[nodiscard]] LinkPairs derive_self_pairs(std::span<const Link> links,
                                          std::span<const Joint> joints, std::span<const int> group,
                                          const LinkPairs& allowed, int first_second = 0);

/// 16 hexadecimal digits over all that decides whether a configuration is valid. Values count in
/// steps of 1e-9. Databases store the result: whoever changes what goes in changes the version in
/// robot_facts.cpp too.
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
