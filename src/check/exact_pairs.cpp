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

  [[nodiscard]] bool stays_apart(std::span<const float> from, std::span<const float> delta,
                                 MotionShare share, double extra) const {
    const PartialMotion part(from, delta, share);
    ChainMotion motion(solids.chain, part.from, part.delta);
    return solids.stays_apart(motion, extra);
  }

  /// True if the pair is apart at states of a share of the motion, `spacing` shares from each
  /// other.
  [[nodiscard]] bool is_apart_at_states(std::span<const float> from, std::span<const float> delta,
                                        MotionShare share, double extra, double spacing) const {
    const PartialMotion part(from, delta, share);
    ChainMotion motion(solids.chain, part.from, part.delta);
    return solids.is_apart_at_states(motion, extra, 0.5 * spacing / (share.last - share.first));
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
  return std::ranges::all_of(*pairs_, [&](const Pair& pair) {
    const auto open = pair.unproven(from, delta, extra);
    return !open || pair.stays_apart(from, delta, *open, extra);
  });
}

/// All pairs are checked at few states before any is at all: contact mostly lasts for long.
bool ExactPairs::are_apart_at_states(std::span<const float> from, std::span<const float> delta,
                                     double extra, int count) const {
  constexpr int kFirst = 4;
  if (empty()) return true;
  const PartialMotion end(from, delta, {1, 1});
  if (count <= 1) return stay_apart(end.from, {}, extra);
  std::vector<std::pair<const Pair*, MotionShare>> open;
  for (const Pair& pair : *pairs_) {
    if (const auto share = pair.unproven(from, delta, extra)) open.emplace_back(&pair, *share);
  }
  const auto are_apart = [&](double spacing) {
    return std::ranges::all_of(open, [&](const auto& part) {
      return part.first->is_apart_at_states(from, delta, part.second, extra, spacing);
    });
  };
  if (open.empty()) return true;
  if (count > kFirst && !are_apart(1.0 / kFirst)) return false;
  return are_apart(1.0 / count) && stay_apart(end.from, {}, extra);
}

}  // namespace mneme::internal
