// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The independent second look: exact distances in double precision, which share no code with the
/// kernels.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <span>
#include <string>
#include <vector>

namespace mneme {

/// Two things that overlap, or come closer than the margin.
struct Contact {
  std::string link;
  std::string other;     ///< the name of an obstacle or of another link
  bool is_self = false;  ///< true if `other` is a link
  double distance = 0;   ///< metres between the surfaces; negative by at most the sum of the radii
};

/// True if every state of `path` at `resolution` radians or finer is free, by exact distances in
/// double precision that share no code with the kernels. What CollisionChecker leaves aside is left
/// aside here, too. False for an empty path and for one that leaves the joint limits.
[[nodiscard]] bool is_path_free(const Robot& robot, const Scene& scene,
                                const std::vector<Configuration>& path, double resolution);

}  // namespace mneme
