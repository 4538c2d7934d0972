// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/local_motions.h"
#include "robot/joint_space.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace mneme::internal {
namespace {

/// Of the coarse search: radians about the axis, or metres along it.
constexpr float kTurnStep = 2 * std::numbers::pi_v<float> / 180, kLiftStep = 0.01f;
/// Fine steps in a coarse one, and searched on either side.
constexpr int kFineSteps = 4, kFineReach = 2;
/// The coarse search deflates the robot by what it may miss between two places.
constexpr double kDeflation = -0.01;
/// A state is near obstacles if it is not free with this extra margin, metres.
constexpr double kNear = 0.015;
/// States of the core that the coarse and the fine search check one by one.
constexpr std::size_t kCoarseStates = 4, kFineStates = 8;
constexpr std::size_t kQuickStates = 16;  ///< whose nearness rules out open places
constexpr double kLeastNearAtOnce = 0.2;  ///< share of them
constexpr double kLeastNear = 0.3;        ///< share of the core
constexpr double kLeastMissed = 0.65;     ///< share of the near misses that are blocked
constexpr int kTriesPerRun = 3;
constexpr int kPartsOfStep = 8;  ///< of a fine step, to refine a place

/// The range from the first tight waypoint to behind the last.
std::pair<std::size_t, std::size_t> core_range(const std::vector<float>& clearances) {
  std::size_t begin = 0, end = clearances.size();
  while (begin < end && !is_tight(clearances[begin])) ++begin;
  while (end > begin && !is_tight(clearances[end - 1])) --end;
  return {begin, end};
}

/// Indices of the core: the tightest first, then always the one farthest from those before, tight
/// ones before others.
std::vector<std::size_t> deciding_order(const RememberedPath& motion) {
  const std::vector<float>& clearances = motion.clearances;
  const auto [begin, end] = core_range(clearances);
  std::vector<std::size_t> order;
  if (begin == end) return order;
  const auto first = clearances.begin();
  const auto span = [&](std::size_t i) { return first + static_cast<std::ptrdiff_t>(i); };
  auto next = static_cast<std::size_t>(std::min_element(span(begin), span(end)) - first);
  std::vector<std::size_t> gap(clearances.size(), clearances.size());
  while (order.size() < end - begin) {
    order.push_back(next);
    std::size_t best = 0;
    for (std::size_t i = begin; i < end; ++i) {
      gap[i] = std::min(gap[i], i > next ? i - next : next - i);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t merit =
          gap[i] == 0 ? 0 : gap[i] + (is_tight(clearances[i]) ? clearances.size() : 0);
      if (merit > best) best = merit, next = i;
    }
  }
  return order;
}

/// `most` positions in a run of `length`, from the middle outwards.
std::vector<std::size_t> outwards(std::size_t length, int most) {
  std::vector<std::size_t> positions;
  for (int t = 0; t < most && t < static_cast<int>(length); ++t) {
    const double side = t % 2 == 0 ? -1 : 1;
    const double share = 0.5 + side * 0.5 * ((t + 1) / 2) / ((most + 1) / 2);
    positions.push_back(
        std::min(length - 1, static_cast<std::size_t>(share * static_cast<double>(length))));
  }
  return positions;
}

}  // namespace

MotionPlaces KnownPlaces::copy() const {
  const std::lock_guard lock(mutex_);
  return places_;
}

bool KnownPlaces::empty() const {
  const std::lock_guard lock(mutex_);
  return places_.empty();
}

void KnownPlaces::add(const MotionPlaces& found) {
  const std::lock_guard lock(mutex_);
  if (places_.size() + found.size() > kMost) places_.clear();
  places_.insert(found.begin(), found.end());
}

MotionFinder::MotionFinder(const CollisionChecker& checker)
    : checker_(checker), joints_(static_cast<std::size_t>(checker.robot().joint_count())) {
  const SymmetricJoints symmetric = find_symmetric_joints(checker.robot());
  carrier_ = symmetric.turn >= 0 ? symmetric.turn : symmetric.lift;
  step_ = symmetric.turn >= 0 ? kTurnStep : kLiftStep;
}

void MotionFinder::read(const RememberedPath& motion) {
  core_.clear();
  for (const std::size_t i : deciding_order(motion)) {
    const auto q = motion.waypoints.begin() + static_cast<std::ptrdiff_t>(i * joints_);
    core_.insert(core_.end(), q, q + static_cast<std::ptrdiff_t>(joints_));
  }
}

std::span<const float> MotionFinder::core(std::size_t first, std::size_t count) const {
  return std::span(core_).subspan(first * joints_, count * joints_);
}

/// All places within the limits; for a joint of more than a turn those near its middle.
std::vector<float> MotionFinder::coarse_places(const RememberedPath& motion) const {
  if (carrier_ < 0) return {0};
  float least = std::numeric_limits<float>::max(), most = -least;
  for (std::size_t i = static_cast<std::size_t>(carrier_); i < motion.waypoints.size();
       i += joints_) {
    least = std::min(least, motion.waypoints[i]);
    most = std::max(most, motion.waypoints[i]);
  }
  const Joint& joint = checker_.robot().group_joint(carrier_);
  constexpr auto kHalfTurn = std::numbers::pi_v<float>;
  float first = -kHalfTurn, last = kHalfTurn;
  if (joint.type != JointType::continuous) {
    const float middle = (least + most) / 2;
    first = static_cast<float>(joint.lower) - least;
    last = static_cast<float>(joint.upper) - most;
    if (joint.type != JointType::prismatic) {
      first = std::max(first, -kHalfTurn - middle);
      last = std::min(last, kHalfTurn - middle);
    }
  }
  std::vector<float> places;
  for (int i = 0; first + static_cast<float>(i) * step_ <= last; ++i) {
    places.push_back(first + static_cast<float>(i) * step_);
  }
  return places;
}

/// The places around `coarse` ones on the fine grid, ascending and each once.
std::vector<float> MotionFinder::fine_places(std::span<const float> coarse) const {
  if (carrier_ < 0) return {coarse.begin(), coarse.end()};
  const float fine_step = step_ / kFineSteps;
  std::vector<float> places;
  for (const float place : coarse) {
    for (int i = -kFineReach; i <= kFineReach; ++i) {
      const float fine = place + static_cast<float>(i) * fine_step;
      if (places.empty() || fine > places.back() + fine_step / 2) places.push_back(fine);
    }
  }
  return places;
}

/// Keeps the places at which this state of the core is free, or is not, with the extra margin.
void MotionFinder::keep(std::vector<float>& places, std::size_t state, double extra_margin,
                        bool is_free) {
  const std::span<const float> q = core(state, 1);
  rows_.clear();
  for (const float place : places) {
    rows_.insert(rows_.end(), q.begin(), q.end());
    if (carrier_ >= 0) rows_[rows_.size() - joints_ + static_cast<std::size_t>(carrier_)] += place;
  }
  is_free_.resize(places.size());
  checker_.check_states(rows_, is_free_, counters_, extra_margin);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if ((is_free_[i] != 0) == is_free) places[kept++] = places[i];
  }
  places.resize(kept);
}

/// Share of the states that are free at `place`; 0 without any.
double MotionFinder::free_share(std::span<const float> rows, float place, double extra_margin) {
  if (rows.empty()) return 0;
  rows_.assign(rows.begin(), rows.end());
  if (carrier_ >= 0) {
    for (auto i = static_cast<std::size_t>(carrier_); i < rows_.size(); i += joints_) {
      rows_[i] += place;
    }
  }
  is_free_.resize(rows.size() / joints_);
  checker_.check_states(rows_, is_free_, counters_, extra_margin);
  const auto free = std::ranges::count_if(is_free_, [](std::uint8_t one) { return one != 0; });
  return static_cast<double>(free) / static_cast<double>(is_free_.size());
}

bool MotionFinder::fits(const RememberedPath& motion, float place) {
  const std::size_t size = core_size();
  const auto near = [&](std::size_t count) { return 1 - free_share(core(0, count), place, kNear); };
  if (near(std::min(size, kQuickStates)) < kLeastNearAtOnce) return false;
  return free_share(core(0, size), place, 0) == 1 && near(size) >= kLeastNear &&
         1 - free_share(motion.near_misses, place, 0) >= kLeastMissed;
}

/// The place nearest to `place` at which the core is free between its states, too; `place` without
/// one. A step of the fine search is as wide as a passage.
float MotionFinder::refined(const RememberedPath& motion, float place) {
  if (carrier_ < 0) return place;
  const float step = step_ / kFineSteps / kPartsOfStep;
  const auto [first, last] = core_range(motion.clearances);
  for (int i = 0; i <= kPartsOfStep; ++i) {
    const float part = static_cast<float>((i + 1) / 2) * (i % 2 == 0 ? -step : step);
    const std::vector<float> rows = placed(motion, place + part);
    if (checker_.is_chain_valid(std::span(rows).subspan(first * joints_, (last - first) * joints_),
                                counters_)) {
      return place + part;
    }
  }
  return place;
}

std::vector<float> MotionFinder::find(const RememberedPath& motion, CheckCounters& counters) {
  std::vector<float> found;
  counters_ = {};
  read(motion);
  std::vector<float> places = core_.empty() ? std::vector<float>() : coarse_places(motion);
  for (std::size_t i = 0; i < std::min(core_size(), kCoarseStates) && !places.empty(); ++i) {
    keep(places, i, kDeflation, true);
    if (i == 0 && !places.empty()) keep(places, i, kNear, false);
  }
  places = fine_places(places);
  for (std::size_t i = 0; i < std::min(core_size(), kFineStates) && !places.empty(); ++i) {
    keep(places, i, 0, true);
  }
  const float neighbours = 1.5f * step_ / kFineSteps;
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    for (end = begin + 1; end < places.size() && places[end] - places[end - 1] < neighbours;) ++end;
    for (const std::size_t i : outwards(end - begin, kTriesPerRun)) {
      if (!fits(motion, places[begin + i])) continue;
      found.push_back(refined(motion, places[begin + i]));
      break;
    }
  }
  counters.states += counters_.states;
  counters.work += counters_.work;
  return found;
}

std::vector<float> MotionFinder::placed(const RememberedPath& motion, float place) const {
  std::vector<float> rows = motion.waypoints;
  const JointSpace space(checker_.robot());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto joint = static_cast<int>(i % joints_);
    rows[i] = space.into_limits(joint, joint == carrier_ ? rows[i] + place : rows[i]);
  }
  return rows;
}

}  // namespace mneme::internal
