// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/parted_pairs.h"

#include "base/as_index.h"
#include "check/link_distances.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>

namespace mneme::internal {

std::vector<int> rigid_with(const Robot& robot, int link) {
  const std::vector<int> bodies = find_bodies(robot.joints(), robot.group());
  std::vector<int> rigid;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i] == bodies[as_index(link)]) rigid.push_back(static_cast<int>(i));
  }
  return rigid;
}

std::vector<std::pair<int, int>> parted_pairs(const Robot& wide, const Robot& robot) {
  const std::set<std::pair<int, int>> known(robot.self_pairs().begin(), robot.self_pairs().end());
  std::vector<std::pair<int, int>> pairs;
  std::ranges::copy_if(wide.self_pairs(), std::back_inserter(pairs),
                       [&](const auto& pair) { return !known.contains(pair); });
  return pairs;
}

std::vector<std::pair<int, int>> connected_pairs(const Robot& wide, const Robot& robot) {
  const std::vector<bool> moves = find_moving(wide.joints(), wide.group());
  const std::vector<bool> moved = find_moving(robot.joints(), robot.group());
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (!moves[i] || moved[i]) continue;
    const Joint& joint = wide.joints()[i];
    for (const int parent : rigid_with(wide, joint.parent_link)) {
      for (const int child : rigid_with(wide, joint.child_link)) pairs.emplace_back(parent, child);
    }
  }
  return pairs;
}

std::vector<std::pair<int, int>> linked_pairs(const Robot& wide, const Robot& robot) {
  constexpr int kSamples = 8;
  std::vector<std::pair<int, int>> pairs = parted_pairs(wide, robot);
  const std::vector<std::string> own = robot.joint_names();
  const LinkDistances links(wide);
  for (int i = 0; i < kSamples && !pairs.empty(); ++i) {
    Configuration q;
    for (int j = 0; j < wide.joint_count(); ++j) {
      const Joint& joint = wide.group_joint(j);
      const double share = std::ranges::count(own, joint.name) > 0 ? 0.5 : (i + 0.5) / kSamples;
      q.push_back(joint.lower + share * (joint.upper - joint.lower));
    }
    const PosedLinks posed = links.posed(wide.link_poses(q));
    std::erase_if(pairs, [&](const auto& pair) {
      return links.between(posed, {pair.first, pair.second, true}, 0) > 0;
    });
  }
  return pairs;
}

}  // namespace mneme::internal
