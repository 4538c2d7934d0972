// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The table of decomposers. To add one: a function of this signature in a file of its own, and a
/// row in decompose.cpp. The version changes whenever the meaning of its keys does.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "mneme/primitive.h"

namespace mneme::internal {

/// The key size of a decomposer whose keys hold configurations: query_key_size().
inline constexpr int kSizeOfRobot = 0;

struct Decomposer {
  std::string_view name;
  std::string_view version;  ///< name and number, such as "pairs/1"
  int key_size = kSizeOfRobot;
  double default_gap = 0;  ///< metres
  Result<std::vector<LocalPrimitive>> (*decompose)(const Robot&, const Scene&,
                                                   const DecomposeSettings&);
};

/// The decomposer of that name; an unknown name is an error that lists those there are.
[[nodiscard]] Result<const Decomposer*> find_decomposer(std::string_view name);

/// Pairs of circles, for planar arms: the paper's decomposition.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose_into_circle_pairs(
    const Robot& robot, const Scene& scene, const DecomposeSettings& settings);
/// Pairs of obstacles of any shapes, for arms in space.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose_into_body_pairs(
    const Robot& robot, const Scene& scene, const DecomposeSettings& settings);

/// Passages between two obstacles, with what bounds them, for arms in space.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose_into_gaps(
    const Robot& robot, const Scene& scene, const DecomposeSettings& settings);

}  // namespace mneme::internal
