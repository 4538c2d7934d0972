// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "collision/walking_robots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace mneme::test {
namespace {

using Row = std::vector<float>;

/// The cost of a motion: see MotionCost.
float cost_of(const Row& pace, const Row& a, const Row& b) {
  float sum = 0, most = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const float part = std::abs(b[j] - a[j]) * (pace.empty() ? 1 : pace[j]);
    sum += part * part;
    most = std::max(most, part);
  }
  const float share = pace.empty() ? 0 : MotionCost::kSlowest;
  return share * most + (1 - share) * std::sqrt(sum);
}

/// A path of random waypoints, and what its view refers to.
struct OwnedPath {
  std::vector<Row> waypoints;
  std::vector<float> rows, arc_lengths, directions;
  Row pace;  ///< of every other path

  OwnedPath(const Robot& robot, int count, Rng& rng) {
    for (int j = 0; j < robot.joint_count() && count % 2 == 0; ++j) {
      pace.push_back(static_cast<float>(rng.uniform(0.2, 5)));
    }
    for (int i = 0; i < count; ++i) {
      waypoints.push_back(random_states(robot, 1, rng));
      rows.insert(rows.end(), waypoints.back().begin(), waypoints.back().end());
    }
    arc_lengths.push_back(0);
    for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
      const float length = cost_of(pace, waypoints[i], waypoints[i + 1]);
      arc_lengths.push_back(arc_lengths.back() + length);
      for (std::size_t j = 0; j < waypoints[i].size(); ++j) {
        directions.push_back((waypoints[i + 1][j] - waypoints[i][j]) / length);
      }
    }
    directions.resize(rows.size());
  }

  [[nodiscard]] PathView view() const { return {rows, arc_lengths, directions, {pace}}; }

  [[nodiscard]] Row at(float s) const {
    std::size_t motion = 0;
    while (motion + 2 < waypoints.size() && arc_lengths[motion + 1] <= s) ++motion;
    Row q = waypoints[motion];
    const std::size_t joints = q.size();
    for (std::size_t j = 0; j < joints; ++j) {
      q[j] += (s - arc_lengths[motion]) * directions[motion * joints + j];
    }
    return q;
  }
};

/// `q` with the joints of `subset` at `fraction` of the segment from `a` to `b`.
Row with_straight(Row q, std::uint64_t subset, const Row& a, const Row& b, float fraction) {
  for (std::size_t j = 0; j < q.size(); ++j) {
    if ((subset >> j & 1) != 0) q[j] = a[j] + fraction * (b[j] - a[j]);
  }
  return q;
}

float gain_of(const OwnedPath& path, const Shortcut& shortcut) {
  const Row from = path.at(shortcut.begin), to = path.at(shortcut.end);
  const float whole = shortcut.end - shortcut.begin;
  Row last = from;
  float length = 0;
  for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
    const float s = path.arc_lengths[i];
    if (s <= shortcut.begin || s >= shortcut.end) continue;
    const float fraction = (s - shortcut.begin) / whole;
    const Row next = with_straight(path.waypoints[i], shortcut.joints, from, to, fraction);
    length += cost_of(path.pace, last, next);
    last = next;
  }
  return whole - length - cost_of(path.pace, last, to);
}

Row probe_of(const OwnedPath& path, const Shortcut& shortcut) {
  const float whole = shortcut.end - shortcut.begin;
  return with_straight(path.at(shortcut.begin + shortcut.probe * whole), shortcut.joints,
                       path.at(shortcut.begin), path.at(shortcut.end), shortcut.probe);
}

/// True if a state 1e-4 rad away is judged otherwise, so that rounding may decide this one.
bool is_near_contact(const CollisionChecker& checker, const Row& q) {
  const bool is_valid = checker.is_valid(q);
  for (const float shift : {-1e-4f, 1e-4f}) {
    for (std::size_t j = 0; j < q.size(); ++j) {
      Row moved = q;
      moved[j] += shift;
      if (checker.is_valid(moved) != is_valid) return true;
    }
  }
  return false;
}

std::uint64_t random_subset(const Robot& robot, Rng& rng) {
  const std::uint64_t all = (std::uint64_t{1} << robot.joint_count()) - 1;
  return std::max<std::uint64_t>(1, rng.next() & all);
}

TEST_SUITE("oracle") {
  TEST_CASE("shortcuts are rated as a plain loop rates them") {
    Rng rng(21);
    int free_count = 0, blocked_count = 0;
    for (int round = 0; round < rounds(60); ++round) {
      INFO("round ", round);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 10, rng, small_shape);
      const OwnedPath path(robot, 2 + round % 6, rng);
      std::array<Shortcut, kShortcuts> sampled;
      for (Shortcut& shortcut : sampled) {
        const float length = path.arc_lengths.back();
        const auto a = static_cast<float>(rng.uniform()) * length;
        const auto b = static_cast<float>(rng.uniform()) * length;
        const bool is_straight = round % 3 == 0;
        shortcut = {
            std::min(a, b), std::max(a, b),
            is_straight ? (std::uint64_t{1} << robot.joint_count()) - 1 : random_subset(robot, rng),
            0.1f + 0.8f * static_cast<float>(rng.uniform())};
      }
      for (const Isa isa : available_isas()) {
        const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
        std::array<Shortcut, kShortcuts> shortcuts = sampled;
        constexpr float kLeast = 0.05f;
        checker.rate_shortcuts(path.view(), kLeast, shortcuts);
        for (const Shortcut& shortcut : shortcuts) {
          const float gain = gain_of(path, shortcut);
          CHECK(shortcut.gain == doctest::Approx(gain).epsilon(1e-3));
          const Row probe = probe_of(path, shortcut);
          if (std::abs(gain - kLeast) < 1e-3f || is_near_contact(checker, probe)) continue;
          const bool is_free = checker.is_valid(probe);
          (is_free ? free_count : blocked_count) += gain > kLeast;
          CHECK(shortcut.is_promising == (gain > kLeast && is_free));
        }
      }
    }
    CHECK(free_count > 50);
    CHECK(blocked_count > 50);
  }

  TEST_CASE("relaxations are rated as a plain loop rates them") {
    Rng rng(22);
    int free_count = 0, blocked_count = 0;
    for (int round = 0; round < rounds(60); ++round) {
      INFO("round ", round);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 10, rng, small_shape);
      const OwnedPath path(robot, 5, rng);
      Relaxation relaxation{1 + round % 3, {}};
      for (std::uint64_t& subset : relaxation.subsets) subset = random_subset(robot, rng);
      const auto k = static_cast<std::size_t>(relaxation.waypoint);
      const Row &a = path.waypoints[k - 1], &q = path.waypoints[k], &b = path.waypoints[k + 1];
      const float before = path.arc_lengths[k + 1] - path.arc_lengths[k - 1];
      const float fraction = (path.arc_lengths[k] - path.arc_lengths[k - 1]) / before;
      Row foot(q.size());
      for (std::size_t j = 0; j < q.size(); ++j) foot[j] = a[j] + fraction * (b[j] - a[j]);
      for (const Isa isa : available_isas()) {
        const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
        std::array<float, kShortcuts> gains;
        checker.rate_relaxations(path.view(), relaxation, gains);
        const float best = *std::ranges::max_element(gains);
        for (int i = 0; i < kShortcuts; ++i) {
          const Row moved = with_straight(q, relaxation.subset(i), q, foot, relaxation.step(i));
          if (is_near_contact(checker, moved)) continue;
          const bool is_free = checker.is_valid(moved);
          ++(is_free ? free_count : blocked_count);
          const float after = cost_of(path.pace, a, moved) + cost_of(path.pace, moved, b);
          const float gain = is_free ? before - after : 0;
          const float rated = gains[static_cast<std::size_t>(i)];
          if (rated == 0) {
            CHECK(gain < best + 1e-3f);
          } else {
            CHECK(std::abs(rated - gain) < 1e-3f);
          }
        }
      }
    }
    CHECK(free_count > 50);
    CHECK(blocked_count > 50);
  }
}

}  // namespace
}  // namespace mneme::test
