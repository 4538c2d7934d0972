// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/goal.h"

#include "base/as_index.h"
#include "goal/any_rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

namespace mneme {
namespace {

using internal::as_index;

/// Seeds for a region in a later call, and at first if there are many regions: one batch of the
/// kernel.
constexpr int kFewSeeds = 16;
/// Factor on the seeds per region while no region of many has a solution.
constexpr int kSeedGrowth = 4;
/// Number of regions, of many, after which the first solution is enough.
constexpr std::size_t kManyTries = 32;
/// Number of regions, of many, that a later call tries.
constexpr std::size_t kFurtherTries = 8;
/// Number of regions that describe_failure() explains.
constexpr std::size_t kMostExplained = 8;
/// Seeds of a search that tells a pose out of reach from an impossible rotation.
constexpr int kSeedsToExplain = 1024;

void sort_by_distance(const Robot& robot, const Configuration& near,
                      std::vector<Configuration>& configurations) {
  std::ranges::stable_sort(configurations, {},
                           [&](const Configuration& q) { return robot.distance(near, q); });
}

}  // namespace

std::optional<double> internal::find_gap_with_any_rotation(const InverseKinematics& kinematics,
                                                           PoseGoal goal,
                                                           std::span<const double> near,
                                                           IkSettings settings) {
  goal.cone = goal.turn = std::numbers::pi;
  settings.solutions = 1;
  settings.seeds = std::min(settings.seeds, kSeedsToExplain);
  const IkResult moved = kinematics.solve(goal, near, settings);
  if (!moved.solutions.empty()) return 0;
  const bool was_ended = moved.seeds < settings.seeds;
  return was_ended ? std::nullopt : std::optional(moved.closest.position);
}

Result<PoseGoalSource> PoseGoalSource::make(const CollisionChecker& checker,
                                            std::span<const PoseGoal> goals, Configuration near,
                                            const IkSettings& settings, double clearance) {
  PoseGoalSource source(checker, std::move(near), settings, clearance);
  for (const PoseGoal& goal : goals) {
    const auto same = std::ranges::find_if(
        source.regions_, [&](const Region& region) { return region.goal.link == goal.link; });
    if (same != source.regions_.end()) {
      source.regions_.push_back({goal, same->kinematics, {}});
      continue;
    }
    auto kinematics = MNEME_TRY(InverseKinematics::make(checker.robot(), goal.link, checker.isa()));
    source.regions_.push_back({goal, std::move(kinematics), {}});
  }
  return source;
}

bool PoseGoalSource::has_many_regions() const {
  return regions_.size() > as_index(settings_.solutions);
}

std::vector<Configuration> PoseGoalSource::find_all() {
  std::vector<Configuration> found;
  for (Region& region : regions_) {
    region.first = region.kinematics.solve(region.goal, near_, settings_, &checker_, clearance_);
    std::ranges::copy(region.first.solutions, std::back_inserter(found));
  }
  sort_by_distance(checker_.robot(), near_, found);
  keep_new(found);
  return found;
}

std::vector<Configuration> PoseGoalSource::more() {
  if (regions_.empty()) return {};
  if (calls_++ > 0) return search_next();
  if (has_many_regions()) return find_first();
  return find_all();
}

std::vector<Configuration> PoseGoalSource::find_first() {
  std::vector<Configuration> found;
  for (int seeds = kFewSeeds; found.empty() && !is_over(); seeds *= kSeedGrowth) {
    found = sweep(std::min(seeds, settings_.seeds));
    if (seeds >= settings_.seeds) break;
  }
  return found;
}

std::vector<Configuration> PoseGoalSource::sweep(int seeds) {
  IkSettings settings = settings_;
  settings.seeds = seeds;
  settings.solutions = 1;
  std::vector<Configuration> found;
  for (next_ = 0; next_ < regions_.size() && !is_over(); ++next_) {
    const bool has_first = !found.empty() && next_ >= kManyTries;
    if (has_first || std::ssize(found) >= settings_.solutions) break;
    Region& region = regions_[next_];
    region.first = region.kinematics.solve(region.goal, near_, settings, &checker_, clearance_);
    std::vector<Configuration> fresh = region.first.solutions;
    keep_new(fresh);
    std::ranges::move(fresh, std::back_inserter(found));
  }
  sort_by_distance(checker_.robot(), near_, found);
  return found;
}

std::vector<Configuration> PoseGoalSource::search_next() {
  IkSettings settings = settings_;
  settings.seeds = kFewSeeds;
  settings.seed = derive_seed(settings_.seed, calls_);
  std::vector<Configuration> found;
  for (std::size_t tries = has_many_regions() ? kFurtherTries : 1; tries > 0; --tries) {
    const Region& region = regions_[next_++ % regions_.size()];
    std::ranges::move(
        region.kinematics.solve(region.goal, near_, settings, &checker_, clearance_).solutions,
        std::back_inserter(found));
  }
  keep_new(found);
  return found;
}

std::vector<Configuration> PoseGoalSource::blocked() const {
  std::vector<Configuration> all;
  for (const Region& region : regions_) {
    std::ranges::copy(region.first.blocked, std::back_inserter(all));
  }
  return all;
}

void PoseGoalSource::keep_new(std::vector<Configuration>& found) {
  std::erase_if(found, [&](const Configuration& q) {
    // Thousands of regions have so many solutions that even this takes seconds.
    const bool is_known =
        !is_over() && std::ranges::any_of(known_, [&](const Configuration& other) {
          return checker_.robot().distance(q, other) < settings_.apart;
        });
    if (!is_known) known_.push_back(q);
    return is_known;
  });
}

namespace {

/// The most frequent contact of a few configurations.
std::string describe_commonest(const CollisionChecker& checker,
                               std::span<const Configuration> blocked) {
  constexpr std::size_t kMostChecked = 4;
  std::map<std::string, int> counts;
  std::string commonest;
  for (const Configuration& q : blocked.first(std::min(kMostChecked, blocked.size()))) {
    std::map<std::string, int> here;
    for (const Contact& contact : checker.contacts(q)) {
      here[fmt::format("{} '{}'", contact.is_self ? "its own link" : "obstacle", contact.other)] =
          1;
    }
    for (const auto& [what, one] : here) counts[what] += one;
  }
  for (const auto& [what, count] : counts) {
    if (commonest.empty() || count > counts[commonest]) commonest = what;
  }
  return commonest.empty() ? "what is close" : commonest;
}

constexpr double kDegrees = 180 / std::numbers::pi;

std::string describe_length(double metres) {
  if (metres >= 1) return fmt::format("{:.2f} m", metres);
  return metres >= 0.01 ? fmt::format("{:.0f} cm", 100 * metres)
                        : fmt::format("{:.1f} mm", 1000 * metres);
}

}  // namespace

std::string PoseGoalSource::describe_failure(const Region& region) const {
  const PoseGoal& goal = region.goal;
  const IkResult& first = region.first;
  if (!first.blocked.empty()) return describe_blocked(region);
  const auto gap = internal::find_gap_with_any_rotation(region.kinematics, goal, near_, settings_);
  if (!gap) {
    return fmt::format("the search for link '{}' ended after {} seeds", goal.link, first.seeds);
  }
  if (*gap > 0) {
    return fmt::format("the pose is out of reach of link '{}' by {}", goal.link,
                       describe_length(*gap));
  }
  return fmt::format(
      "link '{}' reaches this position, but not this rotation: no solution from {} "
      "seeds, the closest is {} and {:.1f} degrees off",
      goal.link, first.seeds, describe_length(first.closest.position),
      kDegrees * first.closest.rotation);
}

std::string PoseGoalSource::describe_blocked(const Region& region) const {
  return fmt::format("link '{}' reaches the pose only in contact with {} ({} seeds tried)",
                     region.goal.link, describe_commonest(checker_, region.first.blocked),
                     region.first.seeds);
}

std::string PoseGoalSource::describe_failure() const {
  std::string text;
  const std::size_t count = std::min(regions_.size(), kMostExplained);
  for (std::size_t i = 0; i < count; ++i) {
    text += i == 0 ? "" : "; ";
    text += regions_.size() == 1 ? "goal pose: " : fmt::format("goal pose {}: ", i);
    text += describe_failure(regions_[i]);
  }
  if (count < regions_.size()) {
    text += fmt::format("; no configuration for {} more goal poses", regions_.size() - count);
  }
  return text;
}

std::vector<std::string> PoseGoalSource::describe_unreached() const {
  if (has_many_regions()) {
    const auto reached = std::ranges::count_if(
        regions_, [](const Region& region) { return !region.first.solutions.empty(); });
    return {fmt::format("planning began with configurations for {} of {} goal poses; {} were tried",
                        reached, regions_.size(), next_)};
  }
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const Region& region = regions_[i];
    if (!region.first.solutions.empty()) continue;
    const std::string why =
        region.first.blocked.empty()
            ? fmt::format(
                  "no configuration from {} seeds, the closest is {} and {:.1f} degrees off",
                  region.first.seeds, describe_length(region.first.closest.position),
                  kDegrees * region.first.closest.rotation)
            : describe_blocked(region);
    sentences.push_back(fmt::format("goal pose {}: {}", i, why));
  }
  return sentences;
}

namespace {

/// True if `link` stands rigidly behind `before`.
bool follows_rigidly(const Robot& robot, int link, int before) {
  while (link > before) {
    const Joint& joint = robot.joints()[as_index(robot.links()[as_index(link)].parent_joint)];
    if (joint.type != JointType::fixed) return false;
    link = joint.parent_link;
  }
  return link == before;
}

}  // namespace

std::vector<std::string> find_tips(const Robot& robot) {
  const std::span<const Joint> joints = robot.joints();
  const std::size_t count = robot.links().size();
  std::vector<std::vector<std::size_t>> children(count);
  std::vector<bool> leads_on(count, false), is_of_group(joints.size(), false);
  for (const int joint : robot.group()) is_of_group[as_index(joint)] = true;
  // From the tips inwards: joints are in tree order.
  for (std::size_t i = joints.size(); i-- > 0;) {
    const auto parent = as_index(joints[i].parent_link), child = as_index(joints[i].child_link);
    children[parent].push_back(i);
    if (is_of_group[i] || leads_on[child]) leads_on[parent] = true;
  }
  std::vector<std::string> tips;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    auto link = as_index(joints[i].child_link);
    if (!is_of_group[i] || leads_on[link]) continue;
    while (children[link].size() == 1 && joints[children[link][0]].type == JointType::fixed) {
      link = as_index(joints[children[link][0]].child_link);
    }
    const auto named = robot.find_link(robot.tip());
    if (named && follows_rigidly(robot, *named, static_cast<int>(link))) link = as_index(*named);
    tips.push_back(robot.links()[link].name);
  }
  return tips;
}

}  // namespace mneme
