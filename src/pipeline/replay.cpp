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
constexpr std::uint64_t kLocalIterations = 100;
/// Radians of path before and behind what is blocked that are planned anew with it.
constexpr float kRun = 0.3f;
/// Of shortening a repaired path.
constexpr int kRepairPatience = 5;
/// Radians of path before and behind what is blocked that are nudged with it, and metres to
/// obstacles that this wins.
constexpr float kNudgeRun = 0.2f;
constexpr double kNudge = 0.005;
constexpr double kAnyDistance = 1e6;
/// Of seeds: what planners and improving derive from theirs comes before.
constexpr std::uint64_t kReplayTask = std::uint64_t{1} << 61;

/// A remembered path near the query.
struct Known {
  const MemoryKind* kind;
  const Configuration* goal;
  Match match;

  [[nodiscard]] double distance() const { return std::sqrt(match.similarity_error); }
};

/// The part of a path that is not free, as ways from its start.
struct Block {
  float first = 0, last = 0;
  /// None of the states that were looked at is blocked: it is so between two of them.
  bool is_between = false;
  std::vector<std::uint8_t> is_valid = {};  ///< of states along the path
  float step = 0;                           ///< from one to the next

  [[nodiscard]] float length() const { return last - first; }
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
  Result<void> find(const KindSettings& kind, double distance, int count,
                    std::vector<Known>& known);
  void replay(const std::vector<Known>& known);
  [[nodiscard]] bool is_free(const Path& path);
  void measure(const Path& path);
  [[nodiscard]] Block find_block(const Path& path);
  [[nodiscard]] bool repair(Path& path, const Block& block);
  [[nodiscard]] bool passes(Path& path, bool simplify);
  [[nodiscard]] bool nudge(Path& path, const Block& block);
  void splice(Path& path, float first, float last, Path between) const;
  [[nodiscard]] bool lead_round(Path& path, const Block& block);
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

Result<void> Replayer::find(const KindSettings& kind, double distance, int count,
                            std::vector<Known>& known) {
  const auto primitives = decompose(query_, kind);
  if (!primitives) return tl::unexpected(primitives.error());
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    auto matches = find_matches(*query_.database, *kind.kind, (*primitives)[i].primitive,
                                distance * distance, count);
    if (!matches) return tl::unexpected(matches.error());
    for (Match& match : *matches) {
      known.push_back({kind.kind, &query_.ends.goals[i], std::move(match)});
    }
  }
  std::ranges::stable_sort(known, {}, &Known::distance);
  return {};
}

/// Those that are tried, nearest first.
Result<std::vector<Known>> Replayer::find() {
  std::vector<Known> known;
  for (const KindSettings& kind : query_.kinds) {
    if (!(kind.replay > 0)) continue;
    auto found = find(kind, kind.replay, kMostPaths, known);
    if (!found) return tl::unexpected(found.error());
    if (!known.empty()) continue;
    std::vector<Known> nearest;
    found = find(kind, kAnyDistance, 1, nearest);
    if (!found) return tl::unexpected(found.error());
    if (!nearest.empty()) told_.nearest = nearest.front().distance();
  }
  if (known.size() > kMostPaths) known.erase(known.begin() + kMostPaths, known.end());
  return known;
}

void Replayer::replay(const std::vector<Known>& known) {
  struct Blocked {
    Path path;
    Block block;
    const Known* known;
  };
  std::optional<Blocked> least;
  for (const Known& task : known) {
    Path path = task.kind->bend(query_.query, *task.goal, *task.match.experience);
    if (path.empty() || query_.is_over()) continue;
    if (is_free(path)) return take(std::move(path), task);
    Block block = find_block(path);
    told_.blocked.push_back(
        {task.match.experience->id, task.distance(), block.first / way_.length(), at(block.first)});
    if (least && least->block.length() <= block.length()) continue;
    least = {std::move(path), std::move(block), &task};
  }
  if (!least || !repair(least->path, least->block)) return;
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

/// Of a path that is_free() refused.
Block Replayer::find_block(const Path& path) {
  measure(path);
  const auto joints = static_cast<std::size_t>(way_.joint_count());
  const auto parts = static_cast<std::size_t>(way_.length() / query_.checker.resolution()) + 1;
  const float step = way_.length() / static_cast<float>(parts);
  std::vector<float> states((parts + 1) * joints);
  std::vector<std::uint8_t> is_valid(parts + 1);
  for (std::size_t i = 0; i <= parts; ++i) {
    way_.write(way_.locate(step * static_cast<float>(i)), states.data() + i * joints);
  }
  counters_.states += is_valid.size();
  query_.checker.check_states(states, is_valid);
  const auto first = std::ranges::find(is_valid, 0) - is_valid.begin();
  if (first == std::ssize(is_valid)) {
    const float middle = 0.5f * (way_.way_to(invalid_) + way_.way_to(invalid_ + 1));
    return {middle, middle, true};
  }
  const auto last = std::ranges::find(std::views::reverse(is_valid), 0).base() - is_valid.begin();
  return {step * static_cast<float>(first), step * static_cast<float>(last - 1), false,
          std::move(is_valid), step};
}

Configuration Replayer::at(float way) const {
  std::vector<float> q(static_cast<std::size_t>(way_.joint_count()));
  way_.write(way_.locate(way), q.data());
  return query_.problem.robot.normalized(Configuration(q.begin(), q.end()));
}

bool Replayer::repair(Path& path, const Block& block) {
  if (block.is_between) return passes(path, false);
  Path nudged = path;
  if (nudge(nudged, block) && passes(nudged, true)) {
    path = std::move(nudged);
    return true;
  }
  return lead_round(path, block) && passes(path, true);
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

/// Pushes the path off what it touches, where it does and a little before and behind.
bool Replayer::nudge(Path& path, const Block& block) {
  const auto is_near = [&](float way) {
    const auto run = static_cast<int>(kNudgeRun / block.step);
    const int here = static_cast<int>(way / block.step);
    const int end = std::min(here + run + 1, static_cast<int>(block.is_valid.size()));
    return std::find(block.is_valid.begin() + std::max(here - run, 0), block.is_valid.begin() + end,
                     0) != block.is_valid.begin() + end;
  };
  path = push_off(query_.checker, path, kNudge, is_near);
  std::vector<float> states;
  for (const Configuration& q : path) states.insert(states.end(), q.begin(), q.end());
  std::vector<std::uint8_t> is_valid(path.size());
  counters_.states += is_valid.size();
  query_.checker.check_states(states, is_valid);
  return std::ranges::find(is_valid, 0) == is_valid.end();
}

/// Plans anew between states before and behind the block.
bool Replayer::lead_round(Path& path, const Block& block) {
  measure(path);
  const float first = std::max(0.0f, block.first - kRun);
  const float last = std::min(way_.length(), block.last + kRun);
  const PlanQuery ends = {first > 0 ? at(first) : path.front(),
                          {last < way_.length() ? at(last) : path.back()}};
  PlanSettings settings = query_.settings.plan;
  settings.seed = derive_seed(settings.seed, kReplayTask);
  settings.timeout_s = finish_settings(false).timeout_s;
  settings.max_iterations =
      std::min(kLocalIterations, settings.max_iterations.value_or(kLocalIterations));
  settings.simplify = settings.verify = false;
  settings.observer = nullptr;
  const auto sampler = make_uniform_sampler(query_.problem.robot);
  PlanResult local = plan_with(rrt_connect, query_.checker, ends, *sampler, settings);
  told_.iterations = local.iterations;
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
