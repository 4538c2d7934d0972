// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "robot/kinematics.h"
#include "robot/robot_tree.h"

#include <algorithm>
#include <set>

namespace mneme::internal {

LinkPairs find_neighbours(std::span<const Link> links, std::span<const Joint> joints,
                          std::span<const int> group, int most_moving) {
  const std::vector<bool> is_moving = find_moving(joints, group);
  LinkPairs neighbours;
  for (std::size_t link = 1; link < links.size(); ++link) {
    if (!has_shapes(links[link])) continue;
    int above = joints[link - 1].parent_link;
    int moving = is_moving[link - 1] ? 1 : 0;
    while (above > 0 && !has_shapes(links[as_index(above)])) {
      moving += is_moving[as_index(above - 1)] ? 1 : 0;
      above = joints[as_index(above - 1)].parent_link;
    }
    const bool is_near = moving <= most_moving && has_shapes(links[as_index(above)]);
    if (is_near) neighbours.emplace_back(above, static_cast<int>(link));
  }
  return neighbours;
}

LinkPairs derive_self_pairs(std::span<const Link> links, std::span<const Joint> joints,
                            std::span<const int> group, const LinkPairs& allowed, int first_second,
                            std::size_t most) {
  const std::vector<int> bodies = find_bodies(joints, group);
  std::set<std::pair<int, int>> may_touch;
  for (const auto& [a, b] : allowed) may_touch.insert(std::minmax({a, b}));
  // The link after a run of links of one body, such as many attached objects.
  std::vector<std::size_t> after(links.size());
  for (std::size_t i = links.size(); i-- > 0;) {
    after[i] = i + 1 < links.size() && bodies[i + 1] == bodies[i] ? after[i + 1] : i + 1;
  }
  LinkPairs pairs;
  for (std::size_t a = 0; a < links.size() && pairs.size() <= most; ++a) {
    if (!has_shapes(links[a])) continue;
    std::size_t b = std::max(a + 1, as_index(first_second));
    while (b < links.size()) {
      const std::pair pair(static_cast<int>(a), static_cast<int>(b));
      const bool is_one_body = bodies[a] == bodies[b];
      if (!is_one_body && has_shapes(links[b]) && !may_touch.contains(pair)) pairs.push_back(pair);
      b = is_one_body ? after[b] : b + 1;
    }
  }
  return pairs;
}

}  // namespace mneme::internal
