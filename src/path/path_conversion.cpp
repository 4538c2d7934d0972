// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/path_conversion.h"

namespace mneme::internal {

std::vector<float> to_floats(std::span<const double> q) {
  std::vector<float> result;
  result.reserve(q.size());
  for (const double value : q) result.push_back(static_cast<float>(value));
  return result;
}

std::vector<float> to_rows(const Path& path) {
  std::vector<float> rows;
  for (const Configuration& q : path) rows.insert(rows.end(), q.begin(), q.end());
  return rows;
}

Path to_path(const Robot& robot, const std::vector<std::vector<float>>& path) {
  Path result;
  result.reserve(path.size());
  for (const std::vector<float>& q : path) {
    result.push_back(robot.normalized(Configuration(q.begin(), q.end())));
  }
  return result;
}

}  // namespace mneme::internal
