// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "check/link_distances.h"
#include "robot/kinematics.h"
#include "robot/robot_tree.h"
#include "spheres/approximate_robot.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace mneme {
namespace {

using internal::as_index, internal::LinkDistances, internal::PosedLinks;
using Pair = std::pair<int, int>;

/// The robot with all independent joints in its planning group. It checks all pairs of links that
/// move against each other. Continuous joints take the values of one turn.
Result<Robot> make_whole(Robot::Parts parts) {
  RobotOptions options;
  for (Joint& joint : parts.joints) {
    if (internal::is_free(joint)) options.joints.push_back(joint.name);
    if (joint.type != JointType::continuous) continue;
    joint.type = JointType::revolute;
    joint.lower = -std::numbers::pi;
    joint.upper = std::numbers::pi;
  }
  parts.allowed_pairs.emplace();
  parts.exact_pairs.clear();
  if (!options.joints.empty()) return make_robot(std::move(parts), options);
  return fail(ErrorCode::invalid,
              "robot '{}': there is no joint that can move, so that no pair of links needs a check",
              parts.name);
}

struct Record {
  Pair links;
  bool has_touched = false;
  bool has_been_apart = false;
  bool touches_at_rest = false;
};

std::vector<Pair> pairs_with_shapes(const Robot& robot) {
  std::vector<Pair> pairs;
  const int count = static_cast<int>(robot.links().size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      if (internal::has_shapes(robot.links()[as_index(i)]) &&
          internal::has_shapes(robot.links()[as_index(j)])) {
        pairs.emplace_back(i, j);
      }
    }
  }
  return pairs;
}

/// Links with coinciding faces touch, although rounding may part them.
bool touch(const LinkDistances& links, const PosedLinks& posed, const Pair& pair, bool is_exact) {
  constexpr double kRounding = 1e-6;  // metres
  return links.between(posed, {pair.first, pair.second, is_exact}, kRounding) <= kRounding;
}

/// Checks each pair at random configurations until its record `is_settled`.
template <class IsSettled>
void sample(const Robot& robot, const LinkDistances& links, const PairSettings& settings,
            std::vector<Record>& records, const IsSettled& is_settled) {
  Rng rng(settings.seed);
  std::vector<Record*> open;
  for (Record& record : records) open.push_back(&record);
  for (int i = 0; i < settings.samples && !open.empty(); ++i) {
    const PosedLinks posed =
        links.posed(robot.link_poses(internal::random_configuration(robot, rng)));
    for (Record* record : open) {
      (touch(links, posed, record->links, settings.is_exact) ? record->has_touched
                                                             : record->has_been_apart) = true;
    }
    std::erase_if(open, [&](const Record* record) { return is_settled(*record); });
  }
}

bool has_approximation(const Robot& robot, const Pair& pair) {
  return robot.links()[as_index(pair.first)].approximation.has_value() ||
         robot.links()[as_index(pair.second)].approximation.has_value();
}

/// Tries to part two links whose spheres touched in all samples: their exact geometry at random
/// configurations, then on a random search for the largest distance between their spheres.
bool can_part(const Robot& robot, const LinkDistances& links, const Pair& pair) {
  if (!has_approximation(robot, pair)) return false;
  constexpr int kSamples = 1000, kSteps = 500;
  Rng rng(1);
  Configuration best, q(as_index(robot.joint_count()));
  double largest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSamples + kSteps; ++i) {
    const double width = i < kSamples ? 1 : std::pow(0.99, i - kSamples) / 4;
    for (int j = 0; j < robot.joint_count(); ++j) {
      const auto [lower, upper] = std::pair(robot.group_joint(j).lower, robot.group_joint(j).upper);
      double& value = q[as_index(j)];
      value = i < kSamples
                  ? rng.uniform(lower, upper)
                  : std::clamp(best[as_index(j)] + rng.uniform(-width, width) * (upper - lower),
                               lower, upper);
    }
    const PosedLinks posed = links.posed(robot.link_poses(q));
    const double distance = links.between_spheres(posed, pair.first, pair.second, 0);
    const bool is_largest = distance > largest;
    if (i >= kSamples && !is_largest) continue;
    if (is_largest) {
      largest = distance;
      best = q;
    }
    if (!touch(links, posed, pair, true)) return true;
  }
  return false;
}

std::optional<AllowedReason> reason_for(const Record& record, bool allow_at_rest) {
  if (!record.has_been_apart) return AllowedReason::always;
  if (!record.has_touched) return AllowedReason::never;
  if (allow_at_rest && record.touches_at_rest) return AllowedReason::at_rest;
  return std::nullopt;
}

}  // namespace

std::string_view to_string(AllowedReason reason) {
  switch (reason) {
    case AllowedReason::adjacent:
      return "Adjacent";
    case AllowedReason::always:
      return "Always";
    case AllowedReason::never:
      return "Never";
    case AllowedReason::at_rest:
      return "Default";
  }
  return "";
}

Result<std::vector<AllowedPair>> derive_allowed_pairs(const Robot::Parts& parts,
                                                      const PairSettings& settings) {
  if (settings.samples <= 0) {
    return fail(ErrorCode::invalid, "the number of samples is {}, expected 1 or more",
                settings.samples);
  }
  const Robot robot = MNEME_TRY(make_whole(parts));
  const std::vector<Pair> pairs = pairs_with_shapes(robot);
  std::vector<Record> records;
  const auto neighbours =
      internal::find_neighbours(robot.links(), robot.joints(), robot.group(), INT_MAX);
  const std::set<Pair> adjacent(neighbours.begin(), neighbours.end());
  for (const Pair& pair : robot.self_pairs()) {
    if (!adjacent.contains(pair)) records.push_back({pair});
  }
  const LinkDistances links(robot);
  const Configuration rest = robot.normalized(Configuration(as_index(robot.joint_count()), 0.0));
  const PosedLinks at_rest = links.posed(robot.link_poses(rest));
  for (Record& record : records) {
    record.touches_at_rest = touch(links, at_rest, record.links, settings.is_exact);
  }
  sample(robot, links, settings, records,
         [](const Record& record) { return record.has_touched && record.has_been_apart; });
  for (Record& record : records) {
    if (settings.is_exact && !record.has_been_apart) {
      record.has_been_apart = can_part(robot, links, record.links);
    }
  }

  std::vector<AllowedPair> allowed;
  auto record = records.begin();
  for (const Pair& pair : pairs) {
    std::optional<AllowedReason> reason = AllowedReason::adjacent;
    if (record != records.end() && record->links == pair) {
      reason = reason_for(*record++, settings.allow_at_rest);
    }
    if (!reason) continue;
    const auto name = [&](int link) { return robot.links()[as_index(link)].name; };
    allowed.push_back({name(pair.first), name(pair.second), *reason});
  }
  return allowed;
}

namespace {

/// How often the spheres of two links overlap, and at which samples they first did.
struct Overlaps {
  Pair links;
  int samples = 0, count = 0;
  std::vector<std::size_t> first = {};

  [[nodiscard]] double share() const { return static_cast<double>(count) / samples; }
};

/// Counts at up to 1000 random configurations, per pair until its spheres rarely overlap. Returns
/// the configurations.
std::vector<Configuration> count_overlaps(const Robot& robot, const LinkDistances& links,
                                          std::vector<Overlaps>& overlaps) {
  constexpr int kSamples = 1000, kFew = 100, kSome = 400, kKept = 20;
  Rng rng(1);
  std::vector<Configuration> sampled;
  std::vector<Overlaps*> open;
  for (Overlaps& pair : overlaps) open.push_back(&pair);
  for (std::size_t i = 0; i < kSamples && !open.empty(); ++i) {
    sampled.push_back(internal::random_configuration(robot, rng));
    const PosedLinks posed = links.posed(robot.link_poses(sampled.back()));
    for (Overlaps* pair : open) {
      ++pair->samples;
      if (!touch(links, posed, pair->links, false)) continue;
      ++pair->count;
      if (pair->first.size() < kKept) pair->first.push_back(i);
    }
    std::erase_if(open, [](const Overlaps* pair) {
      return pair->count < pair->samples &&
             (pair->samples >= kSome || (pair->samples >= kFew && pair->count == 0));
    });
  }
  return sampled;
}

/// The share of configurations in which only the spheres of a pair overlap.
double share_of_spheres_alone(const Robot& robot, const LinkDistances& links,
                              const std::vector<Configuration>& sampled, const Overlaps& overlaps) {
  const auto are_apart = [&](std::size_t i) {
    return !touch(links, links.posed(robot.link_poses(sampled[i])), overlaps.links, true);
  };
  return overlaps.share() * static_cast<double>(std::ranges::count_if(overlaps.first, are_apart)) /
         static_cast<double>(overlaps.first.size());
}

}  // namespace

internal::InseparablePairs internal::find_inseparable_pairs(const Robot& robot) {
  constexpr double kOften = 0.02;
  std::vector<Overlaps> overlaps;
  for (const Pair& pair : robot.self_pairs()) overlaps.push_back({pair});
  const LinkDistances links(robot);
  const std::vector<Configuration> sampled = count_overlaps(robot, links, overlaps);
  InseparablePairs result;
  for (const Overlaps& pair : overlaps) {
    if (pair.count == 0 || pair.share() < kOften) continue;
    const auto names = std::pair(robot.links()[as_index(pair.links.first)].name,
                                 robot.links()[as_index(pair.links.second)].name);
    if (pair.count == pair.samples) {
      (can_part(robot, links, pair.links) ? result.only_spheres : result.always).push_back(names);
    } else if (has_approximation(robot, pair.links) &&
               share_of_spheres_alone(robot, links, sampled, pair) >= kOften) {
      result.often_spheres.push_back(names);
    }
  }
  return result;
}

}  // namespace mneme
