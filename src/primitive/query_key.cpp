// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "mneme/primitive.h"

namespace mneme {
namespace {

bool is_continuous(const Robot& robot, int joint) {
  return robot.group_joint(joint).type == JointType::continuous;
}

void append(const Robot& robot, std::span<const double> q, PrimitiveKey& key) {
  for (int i = 0; i < robot.joint_count(); ++i) {
    const double value = q[static_cast<std::size_t>(i)];
    if (is_continuous(robot, i)) {
      key.insert(key.end(), {std::cos(value), std::sin(value)});
    } else {
      key.push_back(value);
    }
  }
}

}  // namespace

int query_key_size(const Robot& robot) {
  int end_size = 0;
  for (int i = 0; i < robot.joint_count(); ++i) end_size += is_continuous(robot, i) ? 2 : 1;
  return 1 + 2 * end_size;
}

LocalPrimitive make_query_primitive(const Robot& robot, std::span<const double> start,
                                    std::span<const double> goal) {
  LocalPrimitive primitive;
  PrimitiveKey& key = primitive.key;
  key.push_back(0);
  append(robot, start, key);
  const std::size_t end_size = key.size() - 1;
  append(robot, goal, key);
  double sum = 0;
  for (std::size_t i = 1; i <= end_size; ++i) sum += std::pow(key[i + end_size] - key[i], 2);
  key[0] = std::sqrt(sum);
  return primitive;
}

}  // namespace mneme
