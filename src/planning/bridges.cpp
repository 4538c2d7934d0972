// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/bridges.h"

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

/// Iterations before the first motion: easy problems do not pay for memory. Fewer if places are
/// known.
constexpr double kFirstBridge = 1000, kFirstKnown = 100;
/// Probability of appending a motion instead of growing a tree: at first, and where motions were
/// tried in vain.
constexpr double kBridgeShare = 0.1, kLeastBridgeShare = 0.01;
/// A motion tried n times in vain is chosen 1 / (1 + kVain n) times as often.
constexpr double kVain = 0.1;
/// Largest share of the search's work that finding motions takes; the smaller one once kMostMisses
/// motions in a row fitted nowhere.
constexpr double kFindingShare = 0.3, kLeastFindingShare = 0.03;
constexpr int kMostMisses = 16;

}  // namespace

Bridges::Bridges(PlannerRun& run)
    : run_(run),
      rng_(run.make_rng(RngStream::bridges)),
      is_more_left_(run.motions() != nullptr),
      trust_(is_more_left_ ? run.motions()->trust() : 0),
      first_iteration_(is_more_left_ && run.motions()->knows_places() ? kFirstKnown
                                                                      : kFirstBridge) {}

bool Bridges::is_due() {
  if (static_cast<double>(run_.iterations()) * trust_ < first_iteration_) return false;
  const double share = misses_ < kMostMisses ? kFindingShare : kLeastFindingShare;
  const double allowed = share * trust_ * static_cast<double>(run_.work());
  if (is_more_left_ && static_cast<double>(finding_) < allowed) find_more();
  return !motions_.empty() && rng_.uniform() < share_;
}

/// The more often all motions were tried in vain, the rarer are tries; none once all are appended.
void Bridges::adapt_share() {
  double best = 0;
  for (const Motion& motion : motions_) {
    best = std::max({best, motion.weights[0], motion.weights[1]});
  }
  share_ = best > 0 ? std::max(kLeastBridgeShare, kBridgeShare * best) : 0;
}

void Bridges::find_more() {
  const std::uint64_t before = run_.work();
  std::vector<PlacedMotion> found;
  CheckCounters counters;
  is_more_left_ = run_.motions()->find_more(found, counters);
  run_.count(counters);
  for (const PlacedMotion& placed : found) add_free_stretches(placed);
  finding_ += run_.work() - before;
  found_with_ += counters.states;
  misses_ = found.empty() ? misses_ + 1 : 0;
  if (!found.empty()) adapt_share();
}

/// Cuts a motion where it is in contact.
void Bridges::add_free_stretches(const PlacedMotion& placed) {
  const std::span<const float> rows(placed.rows);
  const std::size_t joints = run_.start().size();
  std::vector<std::uint8_t> is_free(rows.size() / joints);
  run_.check_states(rows, is_free);
  FloatPath states;
  const auto finish = [&] {
    if (states.size() > 1) motions_.push_back({.row = placed.row, .states = std::move(states)});
    states.clear();
  };
  for (std::size_t i = 0; i < is_free.size(); ++i) {
    const std::span<const float> q = rows.subspan(i * joints, joints);
    if (!states.empty() && (is_free[i] == 0 || !run_.is_motion_valid(states.back(), q))) finish();
    if (is_free[i] != 0) states.emplace_back(q.begin(), q.end());
  }
  finish();
}

/// A random motion that the tree does not hold, by weight; null without one.
Bridges::Motion* Bridges::choose(std::size_t graph) {
  double sum = 0;
  for (const Motion& motion : motions_) sum += motion.weights[graph];
  double left = rng_.uniform() * sum;
  for (Motion& motion : motions_) {
    left -= motion.weights[graph];
    if (left < 0) return &motion;
  }
  return nullptr;
}

void Bridges::report(const FloatPath& path) const {
  if (run_.motions() == nullptr) return;
  std::vector<int> followed;
  for (const Motion& motion : motions_) {
    const std::vector<float>& middle = motion.states[motion.states.size() / 2];
    if (std::ranges::find(path, middle) != path.end()) followed.push_back(motion.row);
  }
  run_.motions()->report(found_with_, followed);
}

int Bridges::append(Tree& tree, int graph) {
  const auto in_tree = static_cast<std::size_t>(graph);
  Motion* const motion = choose(in_tree);
  if (motion == nullptr) return -1;
  const bool is_reversed = rng_.uniform() < 0.5;
  const FloatPath& states = motion->states;
  const std::vector<float>& end = is_reversed ? states.back() : states.front();
  double& weight = motion->weights[in_tree];
  int node = tree.connect(tree.nearest(end), end);
  if (node < 0) {
    weight /= 1 + kVain * weight;  // 1 / (1 + kVain n) after n failures
    adapt_share();
    return -1;
  }
  weight = 0;
  adapt_share();
  for (std::size_t i = 0; i < states.size(); ++i) {
    node = tree.add(states[is_reversed ? states.size() - 1 - i : i], node);
  }
  return node;
}

}  // namespace mneme::internal
