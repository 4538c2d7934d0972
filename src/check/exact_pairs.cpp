// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/link_distances.h"
#include "base/as_index.h"
#include "check/free_cells.h"
#include "check/solid_pair.h"

#include <algorithm>
#include <map>
#include <optional>

namespace mneme::internal {

struct ExactPairs::Pair {
  SolidPair solids;
  FreeCellsOfPairs::Cells cells = {};  ///< tried before the solids

  [[nodiscard]] bool stays_apart(std::span<const float> from, std::span<const float> delta,
                                 double extra) const {
    // Cells must not call apart what the solids may call in contact.
    constexpr double kUncertain = 5e-5;
    MotionShare share;
    for (const auto& proofs : cells) {
      if (extra + kUncertain > kCellSpare) break;
      const auto rest = proofs->unproven(from, delta, share);
      if (!rest) return true;
      share = *rest;
    }
    if (share.first == 0 && share.last == 1) {
      ChainMotion motion(solids.chain, from, delta);
      return solids.stays_apart(motion, extra);
    }
    std::vector<float> begin(from.begin(), from.end()), change(delta.begin(), delta.end());
    for (std::size_t i = 0; i < change.size(); ++i) {
      begin[i] += static_cast<float>(share.first * change[i]);
      change[i] *= static_cast<float>(share.last - share.first);
    }
    ChainMotion motion(solids.chain, begin, change);
    return solids.stays_apart(motion, extra);
  }
};

ExactPairs::ExactPairs(const Robot& robot, const LinkDistances& links, const Scene& scene,
                       double margin) {
  std::vector<Pair> pairs;
  std::map<int, std::vector<Shape>> obstacles;
  for (const ObstacleShape& obstacle : obstacle_shapes(robot, scene)) {
    for (const int link : obstacle.exact_links) {
      const bool may_touch = std::ranges::count(obstacle.may_touch, link) > 0;
      if (links.is_moving(link) && !may_touch) obstacles[link].push_back(*obstacle.shape);
    }
  }
  for (auto& [link, shapes] : obstacles) {
    pairs.push_back(
        {SolidPair({robot, link, std::nullopt}, links.exact(link), std::move(shapes), margin)});
  }
  for (const LinkPair& pair : link_pairs(robot, scene)) {
    if (!pair.is_exact) continue;
    pairs.push_back({SolidPair({robot, pair.first, pair.second}, links.exact(pair.first),
                               links.exact(pair.second)),
                     links.free_cells(robot, pair.first, pair.second)});
  }
  pairs_ = std::make_shared<const std::vector<Pair>>(std::move(pairs));
}

bool ExactPairs::empty() const { return pairs_->empty(); }

bool ExactPairs::are_apart(std::span<const float> q) const { return stay_apart(q, {}, 0); }

bool ExactPairs::stay_apart(std::span<const float> from, std::span<const float> delta,
                            double extra) const {
  return std::ranges::all_of(
      *pairs_, [&](const Pair& pair) { return pair.stays_apart(from, delta, extra); });
}

}  // namespace mneme::internal
