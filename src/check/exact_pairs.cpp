// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/link_distances.h"
#include "base/as_index.h"
#include "check/free_cells.h"
#include "check/solid_pair.h"

#include <algorithm>
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
  FreeCellsOfPairs::Cells cells = {};             ///< tried before the solids
  std::optional<std::pair<int, int>> links = {};  ///< unless it is a link and obstacles

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

  /// True if the pair is apart at states of a share of the motion, about `spacing` shares of the
  /// motion from each other.
  [[nodiscard]] bool is_apart_at_states(std::span<const float> from, std::span<const float> delta,
                                        MotionShare share, double extra, double spacing) const {
    const PartialMotion part(from, delta, share);
    ChainMotion motion(solids.chain, part.from, part.delta);
    // Half of an interval: halving gives 0.7 to 1.4 times the spacing.
    constexpr double kNearest = 0.7072;
    return solids.is_apart_at_states(motion, extra,
                                     kNearest * spacing / (share.last - share.first));
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
                     links.free_cells(robot, pair.first, pair.second),
                     std::pair(pair.first, pair.second)});
  }
  pairs_ = std::make_shared<const std::vector<Pair>>(std::move(pairs));
}

bool ExactPairs::empty() const { return pairs_->empty(); }

void ExactPairs::check_states(std::span<const float> configurations,
                              std::span<std::uint8_t> are_apart, const KnownStates& known) const {
  const std::size_t joints = are_apart.empty() ? 0 : configurations.size() / are_apart.size();
  std::vector<std::uint8_t> is_known(are_apart.size());
  for (const Pair& pair : *pairs_) {
    bool is_told = false;
    for (std::size_t i = 0; i < are_apart.size(); ++i) {
      const auto q = configurations.subspan(i * joints, joints);
      if (are_apart[i] == 0 || !pair.unproven(q, {}, 0)) continue;
      if (!is_told && pair.links && !known(*pair.links, is_known)) std::ranges::fill(is_known, 0);
      is_told = pair.links.has_value();
      if (is_told && is_known[i] != 0) continue;
      are_apart[i] = pair.stays_apart(q, {}, {}, 0) ? 1 : 0;
    }
  }
}

bool ExactPairs::stay_apart(std::span<const float> from, std::span<const float> delta,
                            double extra) const {
  return std::ranges::all_of(*pairs_, [&](const Pair& pair) {
    const auto open = pair.unproven(from, delta, extra);
    return !open || pair.stays_apart(from, delta, *open, extra);
  });
}

namespace {

/// The part of a share of a motion around its states that are not known to be apart, if any.
std::optional<MotionShare> around_unknown(const MotionShare& share,
                                          std::span<const std::uint8_t> apart) {
  const auto first = std::ranges::find(apart, 0);
  if (first == apart.end()) return std::nullopt;
  const auto last = std::find(apart.rbegin(), apart.rend(), 0);
  const auto count = static_cast<double>(apart.size());
  const MotionShare part{
      std::max(share.first, (static_cast<double>(first - apart.begin()) + 0.5) / count),
      std::min(share.last, (static_cast<double>(apart.rend() - last) + 0.5) / count)};
  return part.first <= part.last ? std::optional(part) : std::nullopt;
}

}  // namespace

/// All pairs are checked at few states before any is at all: contact mostly lasts for long.
bool ExactPairs::are_apart_at_states(std::span<const float> from, std::span<const float> delta,
                                     double extra, int count, const KnownStates& known) const {
  constexpr int kFirst = 4;
  std::vector<std::pair<const Pair*, MotionShare>> open;
  std::vector<const Pair*> open_at_end;
  std::vector<std::uint8_t> apart(known ? as_index(count) : 0);
  for (const Pair& pair : *pairs_) {
    auto share = pair.unproven(from, delta, extra);
    if (!share) continue;
    const bool is_known = known && pair.links && known(*pair.links, apart);
    if (!is_known || apart.back() == 0) open_at_end.push_back(&pair);
    if (is_known) share = around_unknown(*share, apart);
    if (share && count > 1) open.emplace_back(&pair, *share);
  }
  const auto are_apart = [&](double spacing) {
    return std::ranges::all_of(open, [&](const auto& part) {
      return part.first->is_apart_at_states(from, delta, part.second, extra, spacing);
    });
  };
  if (count > kFirst && !are_apart(1.0 / kFirst)) return false;
  const PartialMotion end(from, delta, {1, 1});
  return are_apart(1.0 / count) && std::ranges::all_of(open_at_end, [&](const Pair* pair) {
           return pair->stays_apart(end.from, {}, {}, extra);
         });
}

}  // namespace mneme::internal
