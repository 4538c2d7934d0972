// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Checks the parts of a robot, sorts them into tree order, derives the pairs of links to check,
/// and hashes what identifies a robot in databases.
#pragma once

#include "mneme/robot.h"

#include <tl/expected.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Returns the index of the link of this name, if there is one.
[[nodiscard]] std::optional<int> find_link(std::span<const Link> links, std::string_view name);

/// Resolves chains of mimic joints, so that every leader is free; drops the mimic of fixed joints.
/// Returns the first faulty joint and why: a loop, a missing leader, numbers that are not finite.
[[nodiscard]] std::optional<std::pair<int, std::string>> fold_mimics(std::vector<Joint>& joints);

/// Returns the fault in the spheres and capsules of a link, if any: numbers that are not finite or
/// beyond 1e6 m, radii below 0.
[[nodiscard]] std::optional<std::string> describe_shape_fault(const Link& link);

/// A fault in a robot's parts, with the index of the link or joint that has it, or -1.
struct PartsFault {
  std::string message;
  int link = -1;
  int joint = -1;
};

/// Checks names, numbers and the tree, makes axes unit vectors, resolves chains of mimic joints,
/// and sorts links and joints depth first, so that joint `i` carries link `i + 1`. Idempotent.
[[nodiscard]] tl::expected<Robot::Parts, PartsFault> sort_tree(Robot::Parts parts);

using LinkPairs = std::vector<std::pair<int, int>>;

/// Returns the pairs of links with shapes that a joint joins directly or through links without
/// shapes: each link and the nearest link with shapes that carries it, unless more than
/// `most_moving` joints that move lie between them. Links and joints are in tree order. A link that
/// is fixed to a neighbour is no neighbour.
[[nodiscard]] LinkPairs find_neighbours(std::span<const Link> links, std::span<const Joint> joints,
                                        std::span<const int> group, int most_moving = 1);

/// Returns pairs of links with shapes, first < second, that move relative to each other, except
/// `allowed` ones (in any order). Joints that do not move weld links into bodies. Only pairs whose
/// second link is `first_second` or later. Ends after more than `most` pairs.
[[nodiscard]] LinkPairs derive_self_pairs(std::span<const Link> links,
                                          std::span<const Joint> joints, std::span<const int> group,
                                          const LinkPairs& allowed, int first_second = 0,
                                          std::size_t most = SIZE_MAX);

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
