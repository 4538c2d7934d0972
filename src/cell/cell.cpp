// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell.h"
#include "mneme/goal.h"
#include "mneme/path.h"
#include "mneme/planning.h"
#include "mneme/sampling.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "cell/branch.h"
#include "cell/cell_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace mneme {

using internal::as_index;
using internal::CellBox;
using internal::JointVector;
using internal::StartCell;

Result<std::shared_ptr<internal::CellData>> internal::make_cell_data(const CellRegion& region,
                                                                     double margin) {
  const Problem& problem = region.problem;
  LinkChain chain = MNEME_TRY(LinkChain::make(problem.robot, region.middle().link));
  return std::make_shared<CellData>(
      CellData{region, std::move(chain), TaskFrame(region), margin, hash_world(problem)});
}

const Result<internal::CellTools>& internal::CellData::make_tools() const {
  std::call_once(made->once, [&] {
    const Problem& problem = region.problem;
    made->tools = [&]() -> Result<CellTools> {
      auto kinematics = MNEME_TRY(InverseKinematics::make(problem.robot, region.middle().link));
      auto checker = MNEME_TRY(CollisionChecker::make(problem.robot, problem.scene));
      return CellTools{std::move(kinematics), std::move(checker)};
    }();
  });
  return *made->tools;
}

void internal::StartCell::drop_hints() {
  if (std::ranges::all_of(boxes, &CellBox::is_proven)) return;
  std::vector<int> index(boxes.size(), -1);
  std::vector<CellBox> kept;
  std::vector<bool> is_lost(tree.nodes.size());
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    SplitNode& node = tree.nodes[i];
    const int first = node.first, count = node.count;
    node.first = static_cast<int>(kept.size());
    for (int k = first; k < first + count; ++k) {
      if (!boxes[as_index(k)].is_proven) continue;
      index[as_index(k)] = static_cast<int>(kept.size());
      kept.push_back(std::move(boxes[as_index(k)]));
    }
    node.count = static_cast<std::uint16_t>(static_cast<int>(kept.size()) - node.first);
    is_lost[i] = is_lost[i] || node.count < count;
    for (int side = 0; side < 2 && !node.is_leaf(); ++side) {
      is_lost[as_index(node.below + side)] = is_lost[i];
    }
    if (!node.is_leaf() || !is_lost[i] || (node.has_gap && !node.gap.is_lost)) continue;
    node.has_gap = true;
    node.gap = {};
    node.gap.is_examined = node.count > 0;
  }
  boxes = std::move(kept);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const int origin = index[as_index(boxes[i].origin)];
    boxes[i].origin = origin < 0 ? static_cast<int>(i) : origin;
  }
}

internal::NearestBoxes::NearestBoxes(const StartCell& cell, const TaskFrame& frame,
                                     const CellTask& task)
    : cell_(cell), frame_(frame), task_(task) {
  open(frame.whole(), 0);
}

/// A half may seem nearer than its node's box by a rounding error, which kRounding covers.
int internal::NearestBoxes::next() {
  constexpr double kRounding = 1e-9;
  while (!open_.empty() &&
         (found_.empty() || open_.top().distance2 <= (1 + kRounding) * found_.top().first)) {
    const Place place = open_.top();
    open_.pop();
    const SplitNode& node = cell_.tree.nodes[as_index(place.node)];
    for (int i = node.first; i < node.first + node.count; ++i) {
      found_.emplace(frame_.distance2(cell_.boxes[as_index(i)].tasks, task_), i);
    }
    for (int side = 0; side < 2 && !node.is_leaf(); ++side) {
      open(node.half(place.box, side), node.below + side);
    }
  }
  if (found_.empty()) return -1;
  const int index = found_.top().second;
  found_.pop();
  return index;
}

std::string_view to_string(CellTier tier) {
  constexpr std::array<std::string_view, 4> kNames = {"none", "certified", "verified", "planned"};
  return kNames.at(static_cast<std::size_t>(tier));
}

std::string_view to_string(CellGap gap) {
  constexpr std::array<std::string_view, kCellGaps> kSentences = {
      "the link is in contact in all tasks (proven)",
      "no free inverse kinematics found",
      "joint limits",
      "inverse kinematics bends too much",
      "too close to contact",
      "no path found",
      "the build ended before anything was decided",
      "robot, scene or allowed contacts have changed since it was proven"};
  return kSentences.at(static_cast<std::size_t>(gap));
}

namespace {

/// Newton steps and accuracy of an answer, metres.
constexpr int kSteps = 6;
constexpr double kNear = 1e-7;
/// Configurations modelled farther beyond a limit than this are not tried, radians.
constexpr double kLimitRoom = 0.01;

/// Writes the box's path to its goal plus `change`. Returns false if it leaves the joint limits, or
/// turns a continuous joint so far that its direction is not unique.
bool write_path(const internal::LinkChain& chain, const CellBox& box, const JointVector& change,
                const Configuration& start, Path& path) {
  path.resize(box.path.size());
  path.front() = start;
  JointVector before = box.path.waypoint(0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const JointVector q = box.path.waypoint(i, change);
    if (!chain.keeps_limits(q) || !internal::has_unique_turns(chain, before, q)) return false;
    before = q;
    path[i].assign(q.data(), q.data() + q.size());
  }
  return true;
}

/// Looks one task up.
class LookUp {
 public:
  LookUp(const internal::CellData& data, const CellTask& task, std::size_t start,
         CellAnswer& answer)
      : data_(data),
        task_(task),
        start_(data.region.starts[start].q),
        boxes_(data.starts[start].boxes),
        answer_(answer) {}

  /// Returns true if the box has an answer.
  bool try_box(int index) {
    const CellBox& box = boxes_[as_index(index)];
    if (!box.is_proven || !box.tasks.contains(task_)) return false;
    const auto u = box.tasks.place_of(data_.frame.varying(), task_);
    const JointVector middle = box.path.goal(), modelled = internal::evaluate(box.shift, u.data());
    JointVector q = middle + modelled;
    const auto& chain = data_.chain;
    if (((q - chain.upper()).array() > kLimitRoom).any()) return false;
    if (((chain.lower() - q).array() > kLimitRoom).any()) return false;
    if (!pose_) pose_ = data_.frame.pose(task_);
    if (!chain.reach(*pose_, chain.directions(middle), kSteps, kNear, q)) return false;
    const JointVector change = q - middle;
    for (Eigen::Index j = 0; j < change.size(); ++j) {
      // The proof holds for changes this close to the model.
      if (!(std::abs(change[j] - modelled[j]) <= box.shift.rest[static_cast<std::size_t>(j)])) {
        return false;
      }
    }
    if (!internal::takes_nearest_turns(box.path, chain, q)) return false;
    if (!write_path(chain, box, change, start_, answer_.path)) return false;
    answer_.tier = CellTier::certified;
    answer_.box = index;
    return true;
  }

 private:
  const internal::CellData& data_;
  const CellTask& task_;
  const Configuration& start_;
  const std::vector<CellBox>& boxes_;
  CellAnswer& answer_;
  std::optional<Transform> pose_;  ///< of the task, once a box needs it
};

}  // namespace

const CellRegion& Cell::region() const { return data_->region; }
double Cell::margin() const { return data_->margin; }
bool Cell::is_of_this_world() const { return data_->is_of_this_world; }
bool Cell::is_of(const Problem& problem) const {
  return internal::hash_world(problem) == data_->world;
}
const std::vector<CellProgress>& Cell::progress() const { return data_->progress; }

void Cell::prepare() const { static_cast<void>(data_->make_tools()); }

std::size_t Cell::box_count() const {
  std::size_t count = 0;
  for (const StartCell& start : data_->starts) count += start.boxes.size();
  return count;
}

std::size_t Cell::proven_count() const {
  std::size_t count = 0;
  for (const StartCell& start : data_->starts) {
    count += as_index(static_cast<int>(std::ranges::count(start.boxes, true, &CellBox::is_proven)));
  }
  return count;
}

std::size_t Cell::path_count() const {
  std::size_t count = 0;
  for (const StartCell& start : data_->starts) {
    std::set<int> origins;
    for (const CellBox& box : start.boxes) origins.insert(box.origin);
    count += origins.size();
  }
  return count;
}

void Cell::look_up(const CellTask& task, CellAnswer& answer, std::size_t start) const {
  answer.tier = CellTier::none;
  answer.box = -1;
  answer.start = start;
  answer.cell = data_->hash;
  LookUp look_up(*data_, task, start, answer);
  data_->starts[start].visit_boxes(task, [&](int box) { return look_up.try_box(box); });
  if (answer.tier == CellTier::none) answer.path.clear();
}

namespace {

/// Paths of near boxes, bent to a task or extended to it, and verified as far as they are not
/// proven.
class PathBender {
 public:
  PathBender(const internal::CellData& data, const CellTask& task, std::size_t start,
             CellAnswer& answer)
      : data_(data),
        task_(task),
        start_(data.region.starts[start].q),
        cell_(data.starts[start]),
        answer_(answer) {}

  /// Writes the path of the nearest box that leads to the task. Returns true if there is one.
  bool run() {
    internal::NearestBoxes nearest(cell_, data_.frame, task_);
    const Transform pose = data_.frame.pose(task_);
    for (int i = 0, tried = 0; i < kNearest && tried < kTries; ++i) {
      const int index = nearest.next();
      if (index < 0) return false;
      const CellBox& box = cell_.boxes[as_index(index)];
      const JointVector middle = box.path.goal(), inside = change_towards(box);
      JointVector q = middle + inside;
      if (!data_.chain.reach(pose, data_.chain.directions(middle), kFarSteps, kNear, q)) continue;
      if (!data_.chain.keeps_limits(q) || !is_worth_trying(q, box.origin)) continue;
      ++tried;
      if (bend(index, q - middle) || extend(index, inside, internal::to_configuration(q))) {
        return true;
      }
    }
    return false;
  }

  /// The same with configurations of other branches, which paths of near boxes lead up to.
  bool run(const std::vector<Configuration>& goals) {
    constexpr int kMostBoxes = 6;
    for (const Configuration& goal : goals) {
      internal::NearestBoxes nearest(cell_, data_.frame, task_);
      for (int i = 0; i < kMostBoxes; ++i) {
        const int index = nearest.next();
        if (index < 0) break;
        if (extend(index, change_towards(cell_.boxes[as_index(index)]), goal, 2)) return true;
      }
    }
    return false;
  }

 private:
  static constexpr int kTries = 12, kNearest = 64, kFarSteps = 12;
  static constexpr double kSame = 0.02;

  struct TriedGoal {
    JointVector q;
    int origin;
    bool is_free;
  };

  /// The modelled change of the box's goal for the task of the box that is nearest to the task.
  [[nodiscard]] JointVector change_towards(const CellBox& box) const {
    auto u = box.tasks.place_of(data_.frame.varying(), task_);
    for (double& value : u) value = std::clamp(value, -1.0, 1.0);
    return internal::evaluate(box.shift, u.data());
  }

  /// False for goals in contact, and for those that a path of the same plan was tried for.
  bool is_worth_trying(const JointVector& q, int origin) {
    for (const TriedGoal& other : tried_) {
      if ((other.q - q).norm() >= kSame) continue;
      if (!other.is_free || other.origin == origin) return false;
    }
    tried_.push_back({q, origin, data_.tools().checker.is_valid(internal::to_configuration(q))});
    return tried_.back().is_free;
  }

  /// Makes the box's path, bent to its goal plus `change`, the answer if it is free.
  bool bend(int index, const JointVector& change) {
    const CellBox& box = cell_.boxes[as_index(index)];
    if (!write_path(data_.chain, box, change, start_, answer_.path)) return false;
    const std::vector<float>& shares = box.path.shares;
    std::size_t proven = 0;  // motions that do not bend
    while (box.is_proven && proven + 2 < shares.size() && shares[proven + 1] == 0) ++proven;
    return take(index, proven);
  }

  /// The same for a path to a task of the box, and then straight to `goal`; then for shorter parts
  /// of it, of at least `least` waypoints; 0: all.
  bool extend(int index, const JointVector& change, const Configuration& goal,
              std::size_t least = 0) {
    const CellBox& box = cell_.boxes[as_index(index)];
    Path& path = answer_.path;
    if (!write_path(data_.chain, box, change, start_, path)) return false;
    path.push_back(goal);
    while (!take(index, box.is_proven ? path.size() - 2 : 0)) {
      if (least == 0 || path.size() <= least) return false;
      path.erase(path.end() - 2);
    }
    return true;
  }

  /// Makes the path an answer if it is free. Its first motions may be proven.
  bool take(int index, std::size_t proven) {
    const Robot& robot = data_.region.problem.robot;
    const MotionVerifier verifier(data_.tools().checker);
    CheckCounters counters;
    const auto row = [&](std::size_t i) {
      const Configuration q = robot.normalized(answer_.path[i]);
      return std::vector<float>(q.begin(), q.end());
    };
    // Most paths are blocked near the goal.
    for (std::size_t i = answer_.path.size() - 1; i > proven; --i) {
      const MotionEnds ends{i == 1, i + 1 == answer_.path.size()};
      if (!verifier.is_free(row(i - 1), row(i), ends, counters)) return false;
    }
    answer_.path = unwrapped(robot, std::move(answer_.path), start_);
    answer_.tier = CellTier::verified;
    answer_.box = index;
    return true;
  }

  const internal::CellData& data_;
  const CellTask& task_;
  const Configuration& start_;
  const StartCell& cell_;
  CellAnswer& answer_;
  std::vector<TriedGoal> tried_;
};

/// Plans to all configurations of the task that inverse kinematics finds.
void plan_anew(const internal::CellData& data, const CellTask& task, std::size_t start,
               double timeout_s, const std::atomic<bool>* cancel, CellAnswer& answer) {
  const Robot& robot = data.region.problem.robot;
  PoseGoal goal;
  goal.link = data.region.middle().link;
  goal.pose = data.frame.pose(task);
  const Configuration& from = data.region.starts[start].q;
  const Stopwatch stopwatch;
  IkSettings ik;
  ik.is_over = [&] { return stopwatch.elapsed_s() > timeout_s || (cancel != nullptr && *cancel); };
  const internal::CellTools& tools = data.tools();
  const IkResult found =
      tools.kinematics.solve(goal, from, ik, &tools.checker, kVerificationMargin);
  if (found.solutions.empty()) {
    answer.note = found.blocked.empty() ? "inverse kinematics finds no configuration of this task"
                                        : "all configurations found for this task are in contact";
    return;
  }
  if (PathBender(data, task, start, answer).run(found.solutions)) return;
  PlanSettings settings;
  settings.timeout_s = std::max(0.0, timeout_s - stopwatch.elapsed_s());
  settings.cancel = cancel;
  const PlanResult planned = plan_with(rrt_connect, tools.checker, {from, found.solutions},
                                       *make_uniform_sampler(robot), settings);
  answer.note = planned.message;
  if (!planned.is_solved()) return;
  answer.tier = CellTier::planned;
  answer.path = unwrapped(robot, planned.path, from);
}

}  // namespace

CellAnswer Cell::ask(const CellTask& task, std::size_t start, double timeout_s,
                     const std::atomic<bool>* cancel) const {
  CellAnswer answer;
  answer.start = start;
  answer.cell = data_->hash;
  if (!data_->frame.whole().contains(task)) {
    answer.note = "the task is beyond the region";
    const CellTask& half = data_->frame.half_extents();
    for (std::size_t k = 0; k < kTaskSize; ++k) {
      if (std::abs(task[k]) <= half[k]) continue;
      answer.note +=
          fmt::format(": {} is {}, expected at most {}", kTaskNames[k], task[k], half[k]);
      break;
    }
    return answer;
  }
  look_up(task, answer, start);
  if (answer.tier != CellTier::none) return answer;
  if (const auto& made = data_->make_tools(); !made) {
    answer.note = made.error().message;
    return answer;
  }
  if (PathBender(*data_, task, start, answer).run()) return answer;
  if (timeout_s > 0) {
    plan_anew(*data_, task, start, timeout_s, cancel, answer);
  } else {
    answer.note =
        "no proven box and no path of a near box leads to the task, and without time it is not "
        "planned";
  }
  if (answer.tier == CellTier::none) answer.path.clear();
  return answer;
}

std::optional<CellAnswer> answer_from(const Cell& cell, const Problem& problem) {
  const CellRegion& region = cell.region();
  const auto start = std::ranges::find(region.starts, problem.start, &CellStart::q);
  const bool is_one_pose =
      problem.pose_goals.size() == 1 && problem.goals.empty() && !problem.is_moving();
  if (start == region.starts.end() || !is_one_pose || !problem.constraints.empty()) return {};
  const PoseGoal& goal = problem.pose_goals.front();
  const bool is_pose = goal.position_tolerance.isZero() && goal.cone == 0 && goal.turn == 0;
  if (!is_pose || goal.link != region.middle().link || !cell.is_of(problem)) return {};
  const auto task = task_of(region, goal.pose);
  if (!task) return {};
  constexpr double kNoPlanning = 0;
  CellAnswer answer =
      cell.ask(*task, static_cast<std::size_t>(start - region.starts.begin()), kNoPlanning);
  if (answer.tier == CellTier::none) return {};
  return answer;
}

std::optional<std::string> describe_near_start(const Cell& cell, const Problem& problem) {
  constexpr double kNearStart = 1e-6;
  for (const CellStart& start : cell.region().starts) {
    if (start.q == problem.start || start.q.size() != problem.start.size()) continue;
    double most = 0;
    for (std::size_t j = 0; j < start.q.size(); ++j) {
      most = std::max(most, std::abs(start.q[j] - problem.start[j]));
    }
    if (!(most <= kNearStart) || !cell.is_of(problem)) continue;
    return fmt::format(
        "the start is {:.2g} from start '{}' of the cell of {}: a cell answers its own starts "
        "only; send that start",
        most, start.name, cell.region().path);
  }
  return std::nullopt;
}

CellCoverage Cell::coverage(std::size_t start, int samples) const {
  CellCoverage coverage;
  coverage.samples = samples;
  Rng rng(99);
  CellAnswer answer;
  std::array<int, kCellGaps> gap_counts = {};
  int proven = 0;
  constexpr int kPollInterval = 1024;
  for (int i = 0; i < samples; ++i) {
    if (i % kPollInterval == 0) internal::poll_interrupt();
    const CellTask task = data_->frame.whole().sample(data_->frame.varying(), rng);
    look_up(task, answer, start);
    if (answer.tier == CellTier::certified) {
      ++proven;
      continue;
    }
    const internal::SplitNode& leaf = data_->starts[start].tree.leaf_of(task);
    const CellGap unsaid = data_->is_of_this_world ? CellGap::limits : CellGap::changed;
    const CellGap reason = leaf.has_gap ? leaf.gap.reason : unsaid;
    ++gap_counts[static_cast<std::size_t>(reason)];
  }
  const auto share = [samples](int count) { return samples > 0 ? double(count) / samples : 0; };
  coverage.proven = share(proven);
  std::ranges::transform(gap_counts, coverage.gaps.begin(), share);
  return coverage;
}

std::vector<UnprovenBox> Cell::unproven(std::size_t start) const {
  return data_->starts[start].tree.unproven(data_->frame);
}

}  // namespace mneme
