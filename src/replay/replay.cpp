// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/replay.h"

#include "base/threads.h"
#include "path/waypoints.h"
#include "path/push_off.h"

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
/// Keys compared for all goals of a query, and for the report of a miss: microseconds.
constexpr std::int64_t kMostKeys = 1024, kMostFarKeys = 128;
constexpr std::uint64_t kLocalIterations = 200;  ///< iterations of all local plans of a query
/// A repair may take kShareOfPlanning of the time that planning the remembered path took, counted
/// in states. The states of a repair are swept and near obstacles: they take kRepairStateCost times
/// as long. Where tasks repeat, past and present planning costs have one distribution: a repair
/// that fails costs at most half of planning in the mean. Outside this limit are at most kMostPaths
/// verifications and the step that reaches the limit. Rows without a planning cost are repaired
/// within kLocalIterations.
constexpr double kShareOfPlanning = 0.5;
constexpr double kRepairStateCost = 4;
/// States that verifying a path takes per radian of its length, in the median. Paths that planning
/// found with fewer states are planned again.
constexpr double kStatesPerRadian = 48;
/// States that an iteration of a local plan takes, nearly always.
constexpr std::uint64_t kStatesPerIteration = 128;
/// Radians of path before and after a block that are replaced with it.
constexpr float kRun = 0.3f;
/// Radians between a detour and the part that it replaces, at most: a larger detour may pass
/// obstacles on the other side than the remembered path.
constexpr float kFarthestRound = 0.65f;
constexpr float kRoundStep = 0.05f;    ///< radians between the states compared for kFarthestRound
constexpr double kRepairPatience = 5;  ///< for shortening a detour, in vectors of states
constexpr double kAnyDistance = std::numeric_limits<double>::infinity();  ///< radians
/// Seeds of local plans; planners and improvement derive theirs from smaller numbers.
constexpr std::uint64_t kReplayTask = std::uint64_t{1} << 61;

/// A remembered path near the query.
struct Known {
  const Configuration* goal;
  Match match;

  [[nodiscard]] double distance() const { return std::sqrt(match.similarity_error); }
};

/// A path, and per waypoint whether the motion to it has passed verification; always true for the
/// first one.
struct Draft {
  Path path;
  std::vector<std::uint8_t> has_passed;

  explicit Draft(Path new_path) : path(std::move(new_path)), has_passed(path.size(), 0) {
    if (!path.empty()) has_passed.front() = 1;
  }
};

/// A part of a path that is not free, as arc lengths.
struct Block {
  float first = 0, last = 0;
};

class Replayer {
 public:
  Replayer(const ReplayTask& task, Replay& report)
      : task_(task),
        report_(report),
        verifier_(task.checker, verification()),
        waypoints_(task.checker.robot()) {}

  PlanResult run() {
    Result<std::vector<Known>> known = find();
    // If memory fails, the search will report it.
    if (known) replay(*known);
    report_.time_s = stopwatch_.elapsed_s();
    report_.states = result_.states_checked = counters_.states;
    result_.motions_checked = counters_.motions;
    result_.planning_time_s =
        report_.time_s - result_.simplification_time_s - result_.verification_time_s;
    return std::move(result_);
  }

 private:
  /// Never Verification::none, because a remembered path was found in another scene.
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
  Result<std::vector<Known>> find(std::span<const LocalPrimitive> goals, double distance,
                                  std::size_t count, std::int64_t most_keys);
  void replay(const std::vector<Known>& known);
  [[nodiscard]] bool verify(Draft& draft, MotionEnds ends);
  [[nodiscard]] bool prove(std::span<const float> from, std::span<const float> to, MotionEnds ends);
  void measure(const Path& path);
  /// False if planning the remembered path took fewer states than verifying `path` does.
  [[nodiscard]] bool is_worth_verifying(const Path& path, const RememberedPath& remembered);
  [[nodiscard]] std::vector<Block> find_blocks(const Draft& draft);
  void add_blocks(int motion, std::vector<Block>& blocks);
  void limit_repair(const RememberedPath& remembered);
  [[nodiscard]] bool repair(Draft& draft, const std::vector<Block>& blocks);
  [[nodiscard]] Draft lead_round(const Path& blocked, MotionEnds ends);
  [[nodiscard]] Path plan_round(const Configuration& from, const Configuration& to);
  [[nodiscard]] bool is_near(const Path& round, const Path& blocked) const;
  [[nodiscard]] Path cut(const Path& path, const Block& part) const;
  void splice(Draft& draft, const Block& part, const Draft& between) const;
  [[nodiscard]] Configuration at(float arc_length) const;
  void take(Path path, const Known& known);

  const ReplayTask& task_;
  Replay& report_;
  MotionVerifier verifier_;
  ProvenMotions* proven_ = nullptr;       ///< by the query's cell; null without one
  std::shared_ptr<ProvenMotions> links_;  ///< motions on which links keep apart; may be null
  Waypoints waypoints_;                   ///< the current draft
  CheckCounters counters_;
  std::uint64_t states_limit_ = 0;  ///< counters_.states at which repair ends; 0 before repair
  PlanResult result_;
  Stopwatch stopwatch_;
};

/// The tasks to try.
Result<std::vector<Known>> Replayer::find() {
  const auto goals = MNEME_TRY(task_.kind.decompose(task_.memory_query, task_.max_gap));
  auto known = MNEME_TRY(find(goals, task_.distance, kMostPaths, kMostKeys));
  if (!known.empty()) return known;
  const auto far = MNEME_TRY(find(goals, kAnyDistance, 1, kMostFarKeys));
  if (!far.empty()) report_.nearest = far.front().distance();
  return known;
}

/// The known tasks within `distance`, nearest first. Goals share the budget of keys. Leaves out
/// the goals from where time is up.
Result<std::vector<Known>> Replayer::find(std::span<const LocalPrimitive> goals, double distance,
                                          std::size_t count, std::int64_t most_keys) {
  std::vector<Known> known;
  const auto share = most_keys / std::max(std::ssize(goals), std::ptrdiff_t{1});
  const std::int64_t keys = std::max(std::int64_t{share}, std::int64_t{1});
  for (std::size_t i = 0; i < goals.size() && !is_over(); ++i) {
    std::int64_t keys_left = keys;
    auto matches = MNEME_TRY(find_matches(
        task_.database, task_.kind, goals[i],
        {.similarity = distance * distance, .max_matches = static_cast<int>(count)}, &keys_left));
    report_.keys += static_cast<std::uint64_t>(keys - keys_left);
    for (Match& match : matches) known.push_back({&task_.ends.goals[i], std::move(match)});
  }
  std::ranges::stable_sort(known, {}, &Known::distance);
  if (known.size() > count) known.resize(count);
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
    if (!is_worth_verifying(draft.path, task.match.experience->path())) {
      if (!report_.cheap_row) report_.cheap_row = task.match.experience->id;
      continue;
    }
    if (verify(draft, {true, true})) return take(std::move(draft.path), task);
    std::vector<Block> blocks = find_blocks(draft);
    const float first = blocks.front().first;
    const float share = waypoints_.length() > 0 ? first / waypoints_.length() : 0;
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

/// Verifies the motions that have not passed yet; true if all have then. `ends`: whether the path
/// begins at the query's start and ends at its goal.
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
  // A repair uses no earlier proofs: its cost in states must not depend on earlier queries.
  const bool may_know = states_limit_ == 0;
  if (may_know && proven_ != nullptr && proven_->contain(from, to, ends)) return true;
  const bool are_links_apart = may_know && links_ != nullptr && links_->contain(from, to, ends);
  if (!verifier_.is_free(from, to, ends, counters_, are_links_apart)) return false;
  if (proven_ != nullptr) proven_->add(from, to, ends);
  if (links_ != nullptr && !are_links_apart) links_->add(from, to, ends);
  return true;
}

void Replayer::measure(const Path& path) { waypoints_.assign(to_rows(path)); }

bool Replayer::is_worth_verifying(const Path& path, const RememberedPath& remembered) {
  if (!remembered.planning_states) return true;
  measure(path);
  return kStatesPerRadian * waypoints_.length() <= static_cast<double>(*remembered.planning_states);
}

/// The blocks of motions that have not passed, at least one. Blocks closer than two runs are
/// merged.
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

/// A motion that failed though its states are free is blocked as a whole.
void Replayer::add_blocks(int motion, std::vector<Block>& blocks) {
  const auto joints = static_cast<std::size_t>(waypoints_.joint_count());
  const float begin = waypoints_.arc_length(motion),
              length = waypoints_.arc_length(motion + 1) - begin;
  const auto parts = static_cast<std::size_t>(length / task_.checker.resolution()) + 1;
  const float step = length / static_cast<float>(parts);
  std::vector<float> states((parts + 1) * joints);
  for (std::size_t i = 0; i <= parts; ++i) {
    waypoints_.write({motion, static_cast<float>(i) / static_cast<float>(parts)},
                     states.data() + i * joints);
  }
  std::vector<std::uint8_t> is_valid(parts + 1);
  task_.checker.check_states(states, is_valid, counters_);
  const std::size_t before = blocks.size();
  for (std::size_t i = 0; i <= parts; ++i) {
    const float here = begin + step * static_cast<float>(i);
    if (is_valid[i] == 0) blocks.push_back({here, here});
  }
  if (blocks.size() == before) blocks.push_back({begin, begin + length});
}

Configuration Replayer::at(float arc_length) const {
  std::vector<float> q(static_cast<std::size_t>(waypoints_.joint_count()));
  waypoints_.write(waypoints_.locate(arc_length), q.data());
  return task_.checker.robot().normalized(Configuration(q.begin(), q.end()));
}

void Replayer::limit_repair(const RememberedPath& remembered) {
  states_limit_ = ~std::uint64_t{0};
  if (const auto states = remembered.planning_states) {
    const double share = kShareOfPlanning / kRepairStateCost;
    states_limit_ =
        counters_.states + static_cast<std::uint64_t>(share * static_cast<double>(*states));
  }
}

/// Replaces each block by a detour, the last one first, so that earlier arc lengths stay valid.
bool Replayer::repair(Draft& draft, const std::vector<Block>& blocks) {
  measure(draft.path);
  for (auto block = blocks.rbegin(); block != blocks.rend(); ++block) {
    const Block part{std::max(0.0f, block->first - kRun),
                     std::min(waypoints_.length(), block->last + kRun)};
    const MotionEnds ends{part.first == 0, part.last == waypoints_.length()};
    const Draft round = lead_round(cut(draft.path, part), ends);
    if (round.path.empty()) return false;
    splice(draft, part, round);
  }
  return verify(draft, {true, true});
}

/// Pushes the part off obstacles; if that fails, plans a detour. Empty if both fail.
Draft Replayer::lead_round(const Path& blocked, MotionEnds ends) {
  if (must_stop()) return Draft({});
  Draft pushed(push_off(task_.checker, blocked, counters_));
  if (!pushed.path.empty() && verify(pushed, ends)) return pushed;
  Path round = plan_round(blocked.front(), blocked.back());
  return Draft(is_near(round, blocked) ? std::move(round) : Path());
}

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
  shorten(task_.checker, local.path, settings.seed, {kRepairPatience}, &verifier_, counters_,
          [this] { return must_stop(); });
  result_.simplification_time_s += stopwatch.elapsed_s();
  return std::move(local.path);
}

/// Equidistant states of a path, row by row.
std::vector<float> spread(const Robot& robot, const Path& path) {
  Waypoints waypoints(robot);
  waypoints.assign(to_rows(path));
  const auto joints = static_cast<std::size_t>(waypoints.joint_count());
  const auto parts = static_cast<std::size_t>(waypoints.length() / kRoundStep) + 1;
  std::vector<float> rows((parts + 1) * joints);
  for (std::size_t i = 0; i <= parts; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(parts);
    waypoints.write(waypoints.locate(share * waypoints.length()), rows.data() + i * joints);
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
      is_state_near = waypoints_.distance(&states[i], &others[k]) <= kFarthestRound;
    }
    if (!is_state_near) return false;
  }
  return true;
}

/// The part of the measured path.
Path Replayer::cut(const Path& path, const Block& part) const {
  Path cut = {part.first > 0 ? at(part.first) : path.front()};
  const int last = part.last < waypoints_.length() ? waypoints_.locate(part.last).motion
                                                   : waypoints_.count() - 2;
  for (int i = waypoints_.locate(part.first).motion + 1; i <= last; ++i) {
    cut.push_back(path[static_cast<std::size_t>(i)]);
  }
  cut.push_back(part.last < waypoints_.length() ? at(part.last) : path.back());
  return cut;
}

/// Replaces a part by `between`. Before the part the draft must be as measured.
void Replayer::splice(Draft& draft, const Block& part, const Draft& between) const {
  const auto replace = [&](auto& all, const auto& by) {
    const auto begin =
        all.begin() + (part.first > 0 ? waypoints_.locate(part.first).motion + 1 : 0);
    const auto end = part.last < waypoints_.length()
                         ? all.begin() + waypoints_.locate(part.last).motion + 1
                         : all.end();
    const auto behind = all.insert(all.erase(begin, end), by.begin(), by.end());
    return behind + std::ssize(by);
  };
  replace(draft.path, between.path);
  const auto behind = replace(draft.has_passed, between.has_passed);
  // The motions that join it to the draft are new.
  if (behind != draft.has_passed.end()) *behind = 0;
  if (part.first > 0) *(behind - std::ssize(between.path)) = 0;
}

void Replayer::take(Path path, const Known& known) {
  result_.status = PlanStatus::solved;
  result_.path = std::move(path);
  report_.row = known.match.experience->id;
  report_.distance = known.distance();
  report_.planning_states = known.match.experience->path().planning_states.value_or(0);
}

}  // namespace

PlanResult replay(const ReplayTask& task, Replay& report) { return Replayer(task, report).run(); }

}  // namespace mneme::internal
