// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/inseparable_pairs.h"

#include "check/link_distances.h"

namespace mneme::internal {

std::vector<std::pair<std::string, std::string>> find_inseparable_pairs(const Robot& robot) {
  constexpr int kSamples = 1000;
  std::vector<std::pair<int, int>> pairs(robot.self_pairs().begin(), robot.self_pairs().end());
  const LinkDistances links(robot);
  Rng rng(1);
  Configuration q(static_cast<std::size_t>(robot.joint_count()));
  for (int i = 0; i < kSamples && !pairs.empty(); ++i) {
    for (int j = 0; j < robot.joint_count(); ++j) {
      const Joint& joint = robot.group_joint(j);
      q[static_cast<std::size_t>(j)] = rng.uniform(joint.lower, joint.upper);
    }
    const PosedLinks posed = links.posed(robot.link_poses(q));
    std::erase_if(pairs, [&](const auto& pair) {
      return links.between(posed, pair.first, pair.second, 0) > 0;
    });
  }
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [first, second] : pairs) {
    names.emplace_back(robot.links()[static_cast<std::size_t>(first)].name,
                       robot.links()[static_cast<std::size_t>(second)].name);
  }
  return names;
}

}  // namespace mneme::internal
