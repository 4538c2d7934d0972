// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/link_distances.h"
#include "base/as_index.h"
#include "check/free_cells.h"
#include "check/solid_pair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {

namespace {

/// A part of a motion as a motion.
struct PartialMotion {
  PartialMotion(std::span<const float> start, std::span<const float> change, MotionShare share)
      : from(start.begin(), start.end()), delta(change.begin(), change.end()) {
    for (std::size_t i = 0; i < delta.size(); ++i) {
      from[i] += static_cast<float>(share.first * delta[i]);
      delta[i] *= static_cast<float>(share.last - share.first);
    }
  }

  std::vector<float> from, delta;
};

}  // namespace

struct ExactPairs::Pair {
  SolidPair solids;
  FreeCellsOfPairs::Cells cells = {};  ///< tried before the solids

  /// The share of the motion around what no cell proves, if any.
  [[nodiscard]] std::optional<MotionShare> unproven(std::span<const float> from,
                                                    std::span<const float> delta,
                                                    double extra) const {
    // Cells must not call apart what the solids may call in contact.
    constexpr double kUncertain = 5e-5;
    std::optional<MotionShare> open = MotionShare{};
    if (extra + kUncertain > kCellSpare) return open;
    for (const auto& proofs : cells) {
      open = proofs->unproven(from, delta, *open);
      if (!open) break;
    }
    return open;
  }

  /// True if the pair is apart at some states of a share of the motion, from coarse to fine: where
  /// it touches, one of them mostly tells so long before a sweep does.
  [[nodiscard]] bool may_stay_apart(std::span<const float> from, std::span<const float> delta,
                                    MotionShare share, double extra) const {
    constexpr double kSpacing = 0.5;  // radians or metres
    constexpr int kMostSplits = 3;
    float change = 0;
    for (const auto& step : solids.chain.steps()) {
      change = std::max(change, std::abs(delta[as_index(step.joint)]));
    }
    const double length = change * (share.last - share.first);
    double spacing = 1;
    for (int split = 0; split < kMostSplits; ++split) {
      for (double at = 0.5 * spacing; at < 1; at += spacing) {
        const double middle = share.first + at * (share.last - share.first);
        const PartialMotion state(from, delta, {middle, middle});
        ChainMotion motion(solids.chain, state.from, {});
        if (!solids.stays_apart(motion, extra)) return false;
      }
      spacing *= 0.5;
      if (length * spacing < kSpacing) break;
    }
    return true;
  }

  [[nodiscard]] bool stays_apart(std::span<const float> from, std::span<const float> delta,
                                 MotionShare share, double extra) const {
    if (share.first == 0 && share.last == 1) {
      ChainMotion motion(solids.chain, from, delta);
      return solids.stays_apart(motion, extra);
    }
    const PartialMotion part(from, delta, share);
    ChainMotion motion(solids.chain, part.from, part.delta);
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

/// Single states of all pairs are tried before any pair is swept.
bool ExactPairs::stay_apart(std::span<const float> from, std::span<const float> delta,
                            double extra) const {
  std::vector<std::pair<const Pair*, MotionShare>> open;
  for (const Pair& pair : *pairs_) {
    const auto share = pair.unproven(from, delta, extra);
    if (!share) continue;
    if (!delta.empty() && !pair.may_stay_apart(from, delta, *share, extra)) return false;
    open.emplace_back(&pair, *share);
  }
  return std::ranges::all_of(open, [&](const auto& part) {
    return part.first->stays_apart(from, delta, part.second, extra);
  });
}

}  // namespace mneme::internal
