// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/learning.h"

namespace mneme {

std::vector<Experience> learn_whole_paths(const Robot& robot, std::span<const Path> paths) {
  std::vector<Experience> rows;
  for (const Path& path : paths) {
    if (path.empty()) continue;
    Experience& row = rows.emplace_back();
    row.kind = decomposer_version("paths").value();
    row.key = make_query_primitive(robot, path.front(), path.back()).key;
    row.sampler.joint_count = robot.joint_count();
    for (const Configuration& q : path) {
      row.sampler.means.insert(row.sampler.means.end(), q.begin(), q.end());
    }
  }
  return rows;
}

}  // namespace mneme
