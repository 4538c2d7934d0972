// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/replay.h"

#include "path/path_conversion.h"
#include "path/waypoints.h"
#include "pipeline/memory_steps.h"
#include "pipeline/push_off.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <ranges>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostPaths = 3;
/// Of known tasks that are looked at, over all goals of a query: some microseconds.
constexpr std::int64_t kMostKeys = 1024;
constexpr std::uint64_t kLocalIterations = 200;  ///< of all local plans of a query
/// Radians of path before and behind what is blocked that are changed with it.
constexpr float kRun = 0.3f, kNudgeRun = 0.2f;
/// Of shortening a repaired path.
constexpr int kRepairPatience = 5;
constexpr int kMostDetours = 6;
constexpr double kNudge = 0.005;  ///< metres to obstacles
/// Radians: of any task that is under the same constraints, whose keys are 1000 apart otherwise.
constexpr double kAnyDistance = 500;
/// Of seeds: what planners and improving derive from theirs comes before.
constexpr std::uint64_t kReplayTask = std::uint64_t{1} << 61;

/// A remembered path near the query.
struct Known {
  const MemoryKind* kind;
  const Configuration* goal;
  Match match;

  [[nodiscard]] double distance() const { return std::sqrt(match.similarity_error); }
};

/// Which states along a path are free.
struct Profile {
  std::vector<std::uint8_t> is_valid;
  float step = 0;  ///< radians from one to the next

  [[nodiscard]] std::ptrdiff_t blocked() const { return std::ranges::count(is_valid, 0); }
  /// One is blocked within `run` radians of `way` from the start.
  [[nodiscard]] bool is_blocked_near(float way, float run) const {
    const auto at = [&](float w) {
      const auto i = static_cast<std::ptrdiff_t>(w / step);
      return is_valid.begin() + std::clamp(i, std::ptrdiff_t{0}, std::ssize(is_valid));
    };
    const auto end = at(way + run + step);
    return std::find(at(way - run), end, 0) != end;
  }
};

/// A part of a path that is not free, as ways from its start.
struct Block {
  float first = 0, last = 0;
};

class Replayer {
 public:
  Replayer(const Query& query, Replay& told)
      : query_(query),
        told_(told),
        verifier_(query.checker, finish_settings(false).verification),
        way_(query.problem.robot) {}

  PlanResult run() {
    Result<std::vector<Known>> known = find();
    // What is wrong with the memory, the search will say.
    if (known) replay(*known);
    told_.time_s = stopwatch_.elapsed_s();
    result_.states_checked = counters_.states;
    result_.motions_checked = counters_.motions;
    result_.planning_time_s =
        told_.time_s - result_.simplification_time_s - result_.verification_time_s;
    return std::move(result_);
  }

 private:
  [[nodiscard]] FinishSettings finish_settings(bool simplify) const {
    FinishSettings settings = query_.settings.plan.finish();
    settings.simplify = simplify;
    settings.patience = std::min(settings.patience, kRepairPatience);
    settings.timeout_s = std::max(0.0, settings.timeout_s - query_.stopwatch.elapsed_s());
    // Nothing has looked at a remembered path before.
    if (settings.verification == Verification::none) settings.verification = Verification::states;
    return settings;
  }

  Result<std::vector<Known>> find();
  Result<std::vector<Known>> find(const KindSettings& kind, double distance, std::size_t count);
  void replay(const std::vector<Known>& known);
  [[nodiscard]] bool is_free(const Path& path);
  void measure(const Path& path);
  [[nodiscard]] Profile look_along(const Path& path);
  [[nodiscard]] float first_blocked(const Profile& profile) const;
  [[nodiscard]] bool repair(Path& path, const Profile& profile);
  [[nodiscard]] bool has_free_waypoints(const Path& path);
  [[nodiscard]] static Block first_block(const Profile& profile);
  [[nodiscard]] bool passes(Path& path, bool simplify);
  [[nodiscard]] bool lead_round(Path& path, const Block& block);
  void splice(Path& path, float first, float last, Path between) const;
  [[nodiscard]] Configuration at(float way) const;
  void take(Path path, const Known& known);

  const Query& query_;
  Replay& told_;
  int invalid_ = -1;  ///< the motion that failed last
  MotionVerifier verifier_;
  Waypoints way_;
  CheckCounters counters_;
  PlanResult result_;
  Stopwatch stopwatch_;
};

/// The nearest first. Goals share the keys that may be looked at.
Result<std::vector<Known>> Replayer::find(const KindSettings& kind, double distance,
                                          std::size_t count) {
  const auto primitives = decompose(query_, kind);
  if (!primitives) return tl::unexpected(primitives.error());
  std::vector<Known> known;
  const auto goals = static_cast<std::int64_t>(primitives->size());
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    const std::int64_t keys = std::max(kMostKeys / goals, std::int64_t{1});
    std::int64_t keys_left = keys;
    auto matches = find_matches(*query_.database, *kind.kind, (*primitives)[i].primitive,
                                distance * distance, static_cast<int>(count), &keys_left);
    if (!matches) return tl::unexpected(matches.error());
    told_.keys += static_cast<std::uint64_t>(keys - keys_left);
    for (Match& match : *matches) {
      known.push_back({kind.kind, &query_.ends.goals[i], std::move(match)});
    }
  }
  std::ranges::stable_sort(known, {}, &Known::distance);
  if (known.size() > count) known.resize(count);
  return known;
}

/// Those that are tried.
Result<std::vector<Known>> Replayer::find() {
  std::vector<Known> all;
  for (const KindSettings& kind : query_.kinds) {
    if (!(kind.replay > 0)) continue;
    auto known = find(kind, kind.replay, kMostPaths);
    if (!known) return known;
    std::ranges::move(*known, std::back_inserter(all));
    if (!all.empty()) continue;
    known = find(kind, kAnyDistance, 1);
    if (!known) return known;
    if (!known->empty()) told_.nearest = known->front().distance();
  }
  return all;
}

void Replayer::replay(const std::vector<Known>& known) {
  struct Blocked {
    Path path;
    Profile profile;
    const Known* known;
  };
  std::optional<Blocked> least;
  for (const Known& task : known) {
    Path path = task.kind->bend(query_.query, *task.goal, *task.match.experience);
    if (path.empty() || query_.is_over()) continue;
    if (is_free(path)) return take(std::move(path), task);
    Profile profile = look_along(path);
    const float first = first_blocked(profile);
    told_.blocked.push_back(
        {task.match.experience->id, task.distance(), first / way_.length(), at(first)});
    if (least && least->profile.blocked() <= profile.blocked()) continue;
    least = {std::move(path), std::move(profile), &task};
  }
  if (!least || !repair(least->path, least->profile)) return;
  told_.is_repaired = true;
  take(std::move(least->path), *least->known);
}

bool Replayer::is_free(const Path& path) {
  const Stopwatch stopwatch;
  invalid_ = verifier_.find_invalid_motion(path, counters_);
  result_.verification_time_s += stopwatch.elapsed_s();
  return invalid_ < 0;
}

void Replayer::measure(const Path& path) {
  std::vector<float> rows;
  for (const Configuration& q : path) rows.insert(rows.end(), q.begin(), q.end());
  way_.assign(std::move(rows));
}

Profile Replayer::look_along(const Path& path) {
  measure(path);
  const auto joints = static_cast<std::size_t>(way_.joint_count());
  const auto parts = static_cast<std::size_t>(way_.length() / query_.checker.resolution()) + 1;
  Profile profile{std::vector<std::uint8_t>(parts + 1), way_.length() / static_cast<float>(parts)};
  std::vector<float> states((parts + 1) * joints);
  for (std::size_t i = 0; i <= parts; ++i) {
    way_.write(way_.locate(profile.step * static_cast<float>(i)), states.data() + i * joints);
  }
  counters_.states += profile.is_valid.size();
  query_.checker.check_states(states, profile.is_valid);
  return profile;
}

/// Of a path that is_free() refused: between states that are free if it must be there.
float Replayer::first_blocked(const Profile& profile) const {
  const auto first = std::ranges::find(profile.is_valid, 0) - profile.is_valid.begin();
  if (first < std::ssize(profile.is_valid)) return profile.step * static_cast<float>(first);
  return 0.5f * (way_.way_to(invalid_) + way_.way_to(invalid_ + 1));
}

Configuration Replayer::at(float way) const {
  std::vector<float> q(static_cast<std::size_t>(way_.joint_count()));
  way_.write(way_.locate(way), q.data());
  return query_.problem.robot.normalized(Configuration(q.begin(), q.end()));
}

/// Pushes the path off what it touches; where that is not enough, plans round it.
bool Replayer::repair(Path& path, const Profile& profile) {
  if (profile.blocked() == 0) return passes(path, false);
  path = push_off(query_.checker, path, kNudge,
                  [&](float way) { return profile.is_blocked_near(way, kNudgeRun); });
  Path nudged = path;
  if (has_free_waypoints(nudged) && passes(nudged, true)) {
    path = std::move(nudged);
    return true;
  }
  for (int i = 0; i < kMostDetours; ++i) {
    const Profile left = look_along(path);
    if (left.blocked() == 0) break;
    if (!lead_round(path, first_block(left))) return false;
  }
  return passes(path, true);
}

bool Replayer::has_free_waypoints(const Path& path) {
  std::vector<float> states;
  for (const Configuration& q : path) states.insert(states.end(), q.begin(), q.end());
  std::vector<std::uint8_t> is_valid(path.size());
  counters_.states += is_valid.size();
  query_.checker.check_states(states, is_valid);
  return std::ranges::find(is_valid, 0) == is_valid.end();
}

/// With those that follow so closely that they are led round together.
Block Replayer::first_block(const Profile& profile) {
  const auto invalid = [&](std::ptrdiff_t i) {
    return profile.is_valid[static_cast<std::size_t>(i)] == 0;
  };
  const auto gap = static_cast<std::ptrdiff_t>(2 * kRun / profile.step);
  const std::ptrdiff_t first = std::ranges::find(profile.is_valid, 0) - profile.is_valid.begin();
  std::ptrdiff_t last = first;
  for (std::ptrdiff_t i = first; i < std::ssize(profile.is_valid) && i <= last + gap; ++i) {
    if (invalid(i)) last = i;
  }
  return {profile.step * static_cast<float>(first), profile.step * static_cast<float>(last)};
}

/// Shortened a little if that is wanted, and mended where verification alone refuses it.
bool Replayer::passes(Path& path, bool simplify) {
  PathFinisher finisher(query_.checker, finish_settings(simplify));
  const bool is_free = finisher(path, counters_) < 0;
  result_.simplification_time_s += finisher.simplification_time_s();
  result_.verification_time_s += finisher.verification_time_s();
  return is_free;
}

/// Puts `between` in the place of what lies between two ways from the start.
void Replayer::splice(Path& path, float first, float last, Path between) const {
  const auto before = path.begin() + (first > 0 ? way_.locate(first).motion + 1 : 0);
  const auto behind =
      last < way_.length() ? path.begin() + way_.locate(last).motion + 1 : path.end();
  Path spliced(path.begin(), before);
  std::ranges::move(between, std::back_inserter(spliced));
  spliced.insert(spliced.end(), behind, path.end());
  path = std::move(spliced);
}

/// Plans anew between states before and behind the block.
bool Replayer::lead_round(Path& path, const Block& block) {
  if (told_.iterations >= kLocalIterations) return false;
  const float first = std::max(0.0f, block.first - kRun);
  const float last = std::min(way_.length(), block.last + kRun);
  const PlanQuery ends = {first > 0 ? at(first) : path.front(),
                          {last < way_.length() ? at(last) : path.back()}};
  PlanSettings settings = query_.settings.plan;
  settings.seed = derive_seed(settings.seed, kReplayTask);
  settings.timeout_s = finish_settings(false).timeout_s;
  const std::uint64_t left = kLocalIterations - told_.iterations;
  settings.max_iterations = std::min(left, settings.max_iterations.value_or(left));
  settings.walk_after = 0;
  settings.simplify = settings.verify = false;
  settings.observer = nullptr;
  const auto sampler = make_uniform_sampler(query_.problem.robot);
  PlanResult local = plan_with(rrt_connect, query_.checker, ends, *sampler, settings);
  told_.iterations += local.iterations;
  result_.iterations += local.iterations;
  counters_.states += local.states_checked;
  counters_.motions += local.motions_checked;
  if (!local.is_solved()) return false;
  splice(path, first, last, std::move(local.path));
  return true;
}

void Replayer::take(Path path, const Known& known) {
  result_.status = PlanStatus::solved;
  result_.path = std::move(path);
  told_.row = known.match.experience->id;
  told_.distance = known.distance();
}

}  // namespace

PlanResult replay(const Query& query, Replay& told) {
  const auto replays = [](const KindSettings& kind) { return kind.replay > 0; };
  if (query.settings.plan.timeout_s <= 0 || std::ranges::none_of(query.kinds, replays)) return {};
  return Replayer(query, told).run();
}

}  // namespace mneme::internal
