// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/self_pairs.h"

#include <algorithm>
#include <set>

namespace mneme::internal {
namespace {

/// The body of each link: the index of the body's topmost link.
std::vector<int> weld(std::span<const Link> links, std::span<const Joint> joints,
                      std::span<const int> group) {
  std::vector<bool> is_moving(joints.size(), false);
  for (const int joint : group) is_moving[static_cast<std::size_t>(joint)] = true;
  std::vector<int> bodies(links.size(), 0);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    bodies[static_cast<std::size_t>(joints[i].child_link)] =
        is_moving[i] ? joints[i].child_link
                     : bodies[static_cast<std::size_t>(joints[i].parent_link)];
  }
  return bodies;
}

bool has_shapes(const Link& link) { return !link.spheres.empty() || !link.capsules.empty(); }

}  // namespace

std::vector<std::pair<int, int>> derive_self_pairs(std::span<const Link> links,
                                                   std::span<const Joint> joints,
                                                   std::span<const int> group) {
  const std::vector<int> bodies = weld(links, joints, group);
  std::set<std::pair<int, int>> neighbours;
  for (const int i : group) {
    const Joint& joint = joints[static_cast<std::size_t>(i)];
    neighbours.insert(std::minmax({bodies[static_cast<std::size_t>(joint.parent_link)],
                                   bodies[static_cast<std::size_t>(joint.child_link)]}));
  }
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t a = 0; a < links.size(); ++a) {
    if (!has_shapes(links[a])) continue;
    for (std::size_t b = a + 1; b < links.size(); ++b) {
      if (!has_shapes(links[b]) || bodies[a] == bodies[b]) continue;
      if (neighbours.contains(std::minmax({bodies[a], bodies[b]}))) continue;
      pairs.emplace_back(static_cast<int>(a), static_cast<int>(b));
    }
  }
  return pairs;
}

}  // namespace mneme::internal
