// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/replay.h"

#include "base/threads.h"
#include "path/waypoints.h"
#include "replay/push_off.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostPaths = 3;
/// Of known tasks that are looked at, over all goals of a query: some microseconds.
constexpr std::int64_t kMostKeys = 1024;
/// Of all local plans of a query.
constexpr std::uint64_t kLocalIterations = 200;
/// What repairing may cost, in states that are looked at: kStatesOfGrace, and kShareOfPlanning of
/// what planning the remembered path has cost. Where tasks repeat, that and what planning costs now
/// are draws from one distribution: so a repair that fails costs at most half of planning in the
/// mean, and a query at most 1.5 times planning plus a constant, however replaying it ends. What no
/// limit stops is bounded, too: at most kMostPaths verifications, and the stage that runs when the
/// limit is reached (a push, an iteration, a step of shortening, a verification). A row that does
/// not say what its path has cost is repaired within kLocalIterations.
constexpr std::uint64_t kStatesOfGrace = 2000;
constexpr double kShareOfPlanning = 0.5;
/// Of an iteration of a local plan: most take fewer.
constexpr std::uint64_t kStatesPerIteration = 128;
/// Radians of path before and behind what is blocked that are changed with it.
constexpr float kRun = 0.3f;
/// Radians that a way round may be from what it replaces: farther off it may go another way round
/// obstacles than the path that is remembered.
constexpr float kFarthestRound = 0.65f;
/// Of states that are held against each other for that.
constexpr float kRoundStep = 0.05f;
/// Of shortening a way round, in vectors of states.
constexpr double kRepairPatience = 5;
/// Radians: of any task under the same constraints.
constexpr double kAnyDistance = std::numeric_limits<double>::infinity();
/// Of seeds: what planners and improving derive from theirs comes before.
constexpr std::uint64_t kReplayTask = std::uint64_t{1} << 61;

/// A remembered path near the query.
struct Known {
  const Configuration* goal;
  Match match;

  [[nodiscard]] double distance() const { return std::sqrt(match.similarity_error); }
};

/// A path, and per waypoint whether the motion to it has passed verification; there is none to the
/// first.
struct Draft {
  Path path;
  std::vector<std::uint8_t> has_passed;

  explicit Draft(Path new_path) : path(std::move(new_path)), has_passed(path.size(), 0) {
    if (!path.empty()) has_passed.front() = 1;
  }
};

/// A part of a path that is not free, as ways from its start.
struct Block {
  float first = 0, last = 0;
};

class Replayer {
 public:
  Replayer(const ReplayTask& task, Replay& report)
      : task_(task),
        report_(report),
        verifier_(task.checker, verification()),
        way_(task.checker.robot()) {}

  PlanResult run() {
    Result<std::vector<Known>> known = find();
    // What is wrong with the memory, the search will say.
    if (known) replay(*known);
    report_.time_s = stopwatch_.elapsed_s();
    result_.states_checked = counters_.states;
    result_.motions_checked = counters_.motions;
    result_.planning_time_s =
        report_.time_s - result_.simplification_time_s - result_.verification_time_s;
    return std::move(result_);
  }

 private:
  /// Nothing has looked at a remembered path before.
  [[nodiscard]] Verification verification() const {
    const Verification wanted = task_.settings.verification();
    return wanted == Verification::none ? Verification::states : wanted;
  }
  [[nodiscard]] std::uint64_t states_left() const {
    return states_limit_ - std::min(states_limit_, counters_.states);
  }
  [[nodiscard]] bool is_over() const {
    return is_set(task_.settings.cancel) || stopwatch_.elapsed_s() >= task_.settings.timeout_s;
  }
  [[nodiscard]] bool must_stop() const { return states_left() == 0 || is_over(); }

  Result<std::vector<Known>> find();
  Result<std::vector<Known>> find(double distance, std::size_t count);
  void replay(const std::vector<Known>& known);
  [[nodiscard]] bool verify(Draft& draft, MotionEnds ends);
  [[nodiscard]] bool prove(std::span<const float> from, std::span<const float> to, MotionEnds ends);
  void measure(const Path& path);
  [[nodiscard]] std::vector<Block> find_blocks(const Draft& draft);
  void add_blocks(int motion, std::vector<Block>& blocks);
  void limit_repair(const RememberedPath& remembered);
  [[nodiscard]] bool repair(Draft& draft, const std::vector<Block>& blocks);
  [[nodiscard]] Draft lead_round(const Path& blocked, MotionEnds ends);
  [[nodiscard]] Path plan_round(const Configuration& from, const Configuration& to);
  [[nodiscard]] bool is_near(const Path& round, const Path& blocked) const;
  [[nodiscard]] Path cut(const Path& path, const Block& part) const;
  void splice(Draft& draft, const Block& part, const Draft& between) const;
  [[nodiscard]] Configuration at(float way) const;
  void take(Path path, const Known& known);

  const ReplayTask& task_;
  Replay& report_;
  MotionVerifier verifier_;
  ProvenMotions* proven_ = nullptr;       ///< of the query's cell, if it has one
  std::shared_ptr<ProvenMotions> links_;  ///< those on which links keep apart; may be null
  Waypoints way_;                         ///< the path that is looked at
  CheckCounters counters_;
  std::uint64_t states_limit_ = 0;  ///< of counters_, when repairing ends; 0 before it begins
  PlanResult result_;
  Stopwatch stopwatch_;
};

/// The nearest known tasks, nearest first. Goals share the keys that may be compared.
Result<std::vector<Known>> Replayer::find(double distance, std::size_t count) {
  const auto primitives = MNEME_TRY(task_.kind.decompose(task_.memory_query, task_.max_gap));
  std::vector<Known> known;
  const auto goals = static_cast<std::int64_t>(primitives.size());
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::int64_t keys = std::max(kMostKeys / goals, std::int64_t{1});
    std::int64_t keys_left = keys;
    auto matches =
        MNEME_TRY(find_matches(task_.database, task_.kind, primitives[i], distance * distance,
                               static_cast<int>(count), &keys_left));
    report_.keys += static_cast<std::uint64_t>(keys - keys_left);
    for (Match& match : matches) known.push_back({&task_.ends.goals[i], std::move(match)});
  }
  std::ranges::stable_sort(known, {}, &Known::distance);
  if (known.size() > count) known.resize(count);
  return known;
}

/// The tasks that are tried.
Result<std::vector<Known>> Replayer::find() {
  auto known = MNEME_TRY(find(task_.distance, kMostPaths));
  if (!known.empty()) return known;
  const auto far = MNEME_TRY(find(kAnyDistance, 1));
  if (!far.empty()) report_.nearest = far.front().distance();
  return known;
}

void Replayer::replay(const std::vector<Known>& known) {
  struct Blocked {
    Draft draft;
    std::vector<Block> blocks;
    const Known* known;
    float length;
  };
  std::optional<Blocked> least;
  if (!known.empty()) {
    if (task_.cell != nullptr) proven_ = &task_.cell->motions(verification());
    links_ = ProvenMotions::of_links(task_.checker, verification());
  }
  for (const Known& task : known) {
    Draft draft(task_.kind.bend(task_.memory_query, *task.goal, *task.match.experience));
    if (draft.path.empty() || is_over()) continue;
    if (verify(draft, {true, true})) return take(std::move(draft.path), task);
    std::vector<Block> blocks = find_blocks(draft);
    const float first = blocks.front().first;
    const float share = way_.length() > 0 ? first / way_.length() : 0;
    report_.blocked.push_back({task.match.experience->id, task.distance(), share, at(first)});
    float length = 0;
    for (const Block& block : blocks) length += block.last - block.first;
    if (least && least->length <= length) continue;
    least = {std::move(draft), std::move(blocks), &task, length};
  }
  if (!least) return;
  limit_repair(least->known->match.experience->path());
  if (!repair(least->draft, least->blocks)) return;
  report_.is_repaired = true;
  take(std::move(least->draft.path), *least->known);
}

/// Looks at what has not passed yet. True if all has then. `ends`: which of the query's the path
/// has.
bool Replayer::verify(Draft& draft, MotionEnds ends) {
  const Stopwatch stopwatch;
  const std::size_t count = draft.path.size();
  for (std::size_t i = 1; i < count; ++i) {
    if (draft.has_passed[i] != 0) continue;
    draft.has_passed[i] = prove(to_floats(draft.path[i - 1]), to_floats(draft.path[i]),
                                {ends.is_first && i == 1, ends.is_last && i + 1 == count});
  }
  result_.verification_time_s += stopwatch.elapsed_s();
  return std::ranges::find(draft.has_passed, 0) == draft.has_passed.end();
}

bool Replayer::prove(std::span<const float> from, std::span<const float> to, MotionEnds ends) {
  // What a repair may cost is counted in states: none that earlier queries saved lead it farther.
  const bool may_know = states_limit_ == 0;
  if (may_know && proven_ != nullptr && proven_->contain(from, to, ends)) return true;
  const bool are_links_apart = may_know && links_ != nullptr && links_->contain(from, to, ends);
  if (!verifier_.is_free(from, to, ends, counters_, are_links_apart)) return false;
  if (proven_ != nullptr) proven_->add(from, to, ends);
  if (links_ != nullptr && !are_links_apart) links_->add(from, to, ends);
  return true;
}

void Replayer::measure(const Path& path) { way_.assign(to_rows(path)); }

/// Those of motions that have not passed, at least one; what follows so closely that it is changed
/// together is one.
std::vector<Block> Replayer::find_blocks(const Draft& draft) {
  measure(draft.path);
  std::vector<Block> blocks;
  for (std::size_t i = 1; i < draft.has_passed.size(); ++i) {
    if (draft.has_passed[i] == 0) add_blocks(static_cast<int>(i) - 1, blocks);
  }
  std::vector<Block> merged = {blocks.front()};
  for (const Block& block : blocks) {
    if (block.first - merged.back().last > 2 * kRun) {
      merged.push_back(block);
    } else {
      merged.back().last = block.last;
    }
  }
  return merged;
}

/// A motion that failed between states that are free is blocked as a whole.
void Replayer::add_blocks(int motion, std::vector<Block>& blocks) {
  const auto joints = static_cast<std::size_t>(way_.joint_count());
  const float begin = way_.way_to(motion), length = way_.way_to(motion + 1) - begin;
  const auto parts = static_cast<std::size_t>(length / task_.checker.resolution()) + 1;
  const float step = length / static_cast<float>(parts);
  std::vector<float> states((parts + 1) * joints);
  for (std::size_t i = 0; i <= parts; ++i) {
    way_.write({motion, static_cast<float>(i) / static_cast<float>(parts)},
               states.data() + i * joints);
  }
  std::vector<std::uint8_t> is_valid(parts + 1);
  counters_.states += is_valid.size();
  task_.checker.check_states(states, is_valid);
  const std::size_t before = blocks.size();
  for (std::size_t i = 0; i <= parts; ++i) {
    const float way = begin + step * static_cast<float>(i);
    if (is_valid[i] == 0) blocks.push_back({way, way});
  }
  if (blocks.size() == before) blocks.push_back({begin, begin + length});
}

Configuration Replayer::at(float way) const {
  std::vector<float> q(static_cast<std::size_t>(way_.joint_count()));
  way_.write(way_.locate(way), q.data());
  return task_.checker.robot().normalized(Configuration(q.begin(), q.end()));
}

void Replayer::limit_repair(const RememberedPath& remembered) {
  states_limit_ = ~std::uint64_t{0};
  if (const auto states = remembered.planning_states) {
    const auto share = static_cast<std::uint64_t>(kShareOfPlanning * static_cast<double>(*states));
    states_limit_ = counters_.states + kStatesOfGrace + share;
  }
}

/// Leads the path round each block, the last one first: what comes before stays where it is.
bool Replayer::repair(Draft& draft, const std::vector<Block>& blocks) {
  measure(draft.path);
  for (auto block = blocks.rbegin(); block != blocks.rend(); ++block) {
    const Block part{std::max(0.0f, block->first - kRun),
                     std::min(way_.length(), block->last + kRun)};
    const MotionEnds ends{part.first == 0, part.last == way_.length()};
    const Draft round = lead_round(cut(draft.path, part), ends);
    if (round.path.empty()) return false;
    splice(draft, part, round);
  }
  return verify(draft, {true, true});
}

/// Pushed off what it touches; where that is not enough, planned anew. Empty if neither leads
/// round.
Draft Replayer::lead_round(const Path& blocked, MotionEnds ends) {
  if (must_stop()) return Draft({});
  Draft pushed(push_off(task_.checker, blocked, counters_));
  if (!pushed.path.empty() && verify(pushed, ends)) return pushed;
  Path round = plan_round(blocked.front(), blocked.back());
  return Draft(is_near(round, blocked) ? std::move(round) : Path());
}

/// Shortened a little.
Path Replayer::plan_round(const Configuration& from, const Configuration& to) {
  const std::uint64_t left =
      std::min(kLocalIterations - report_.iterations, states_left() / kStatesPerIteration);
  if (left == 0) return {};
  PlanSettings settings = task_.settings;
  settings.seed = derive_seed(settings.seed, kReplayTask);
  settings.timeout_s = std::max(0.0, settings.timeout_s - stopwatch_.elapsed_s());
  settings.max_iterations = std::min(left, settings.max_iterations.value_or(left));
  settings.walk_after = 0;
  settings.simplify = settings.verify = false;
  settings.observer = nullptr;
  const auto sampler = make_uniform_sampler(task_.checker.robot());
  PlanResult local = plan_with(rrt_connect, task_.checker, {from, {to}}, *sampler, settings);
  report_.iterations += local.iterations;
  result_.iterations += local.iterations;
  counters_.states += local.states_checked;
  counters_.motions += local.motions_checked;
  if (!local.is_solved()) return {};
  const Stopwatch stopwatch;
  shorten(task_.checker, local.path, settings.seed, {kRepairPatience}, nullptr, counters_,
          [this] { return must_stop(); });
  result_.simplification_time_s += stopwatch.elapsed_s();
  return std::move(local.path);
}

/// States of a path, row by row.
std::vector<float> spread(const Robot& robot, const Path& path) {
  Waypoints way(robot);
  way.assign(to_rows(path));
  const auto joints = static_cast<std::size_t>(way.joint_count());
  const auto parts = static_cast<std::size_t>(way.length() / kRoundStep) + 1;
  std::vector<float> rows((parts + 1) * joints);
  for (std::size_t i = 0; i <= parts; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(parts);
    way.write(way.locate(share * way.length()), rows.data() + i * joints);
  }
  return rows;
}

bool Replayer::is_near(const Path& round, const Path& blocked) const {
  if (round.empty()) return false;
  const Robot& robot = task_.checker.robot();
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  const std::vector<float> states = spread(robot, round), others = spread(robot, blocked);
  for (std::size_t i = 0; i < states.size(); i += joints) {
    bool is_state_near = false;
    for (std::size_t k = 0; k < others.size() && !is_state_near; k += joints) {
      is_state_near = way_.distance(&states[i], &others[k]) <= kFarthestRound;
    }
    if (!is_state_near) return false;
  }
  return true;
}

/// The part of a path, as measured.
Path Replayer::cut(const Path& path, const Block& part) const {
  Path cut = {part.first > 0 ? at(part.first) : path.front()};
  const int last = part.last < way_.length() ? way_.locate(part.last).motion : way_.count() - 2;
  for (int i = way_.locate(part.first).motion + 1; i <= last; ++i) {
    cut.push_back(path[static_cast<std::size_t>(i)]);
  }
  cut.push_back(part.last < way_.length() ? at(part.last) : path.back());
  return cut;
}

/// Puts `between` in the place of a part; what lies before it is as measured.
void Replayer::splice(Draft& draft, const Block& part, const Draft& between) const {
  const auto replace = [&](auto& all, const auto& by) {
    const auto begin = all.begin() + (part.first > 0 ? way_.locate(part.first).motion + 1 : 0);
    const auto end =
        part.last < way_.length() ? all.begin() + way_.locate(part.last).motion + 1 : all.end();
    const auto behind = all.insert(all.erase(begin, end), by.begin(), by.end());
    return behind + std::ssize(by);
  };
  replace(draft.path, between.path);
  const auto behind = replace(draft.has_passed, between.has_passed);
  // The motions to it and from it are new.
  if (behind != draft.has_passed.end()) *behind = 0;
  if (part.first > 0) *(behind - std::ssize(between.path)) = 0;
}

void Replayer::take(Path path, const Known& known) {
  result_.status = PlanStatus::solved;
  result_.path = std::move(path);
  report_.row = known.match.experience->id;
  report_.distance = known.distance();
}

}  // namespace

PlanResult replay(const ReplayTask& task, Replay& report) { return Replayer(task, report).run(); }

}  // namespace mneme::internal
