// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Depth first over groups of stages: the next candidate of each group by cheap tests, then the
// moves between them, then back to the group whose move failed.
#include "mneme/task.h"

#include "base/as_index.h"
#include "base/check_ranges.h"
#include "base/fail.h"
#include "check/end_motions.h"
#include "planning/end_contacts.h"
#include "task/alternatives.h"
#include "task/task_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace mneme {
namespace {

using namespace internal;

/// Factor on the iteration limit of paths from one round to the next.
constexpr std::uint64_t kIterationGrowth = 8;

/// A path to a candidate.
struct Entry {
  std::shared_ptr<const Problem> problem;
  Path path;
  std::uint64_t states = 0;
  std::vector<std::string> notes = {};
};

/// A group on the way from the first to the last.
struct Level {
  std::unique_ptr<Alternatives> alternatives;
  std::optional<Candidate> candidate;
  std::optional<Entry> entry;  ///< to the candidate, once it is planned
  int failures = 0;
  bool has_candidates = false;  ///< some candidate passed the cheap tests
};

/// A complete choice with all of its paths.
struct TaskPlan {
  std::vector<Candidate> candidates;
  std::vector<Entry> entries;
  double path_time_s = std::numeric_limits<double>::infinity();
};

class TaskSearch {
 public:
  TaskSearch(const Task& task, Database* database, const TaskSettings& settings,
             std::vector<Group> groups)
      : run_{task, settings, task.robot.link_poses(task.start)},
        database_(database),
        groups_(std::move(groups)),
        drops_(task.stages.size()),
        memory_(task, groups_, database) {}

  Result<TaskResult> solve();

 private:
  /// How a round of the search ends.
  enum class End { plan, exhausted, no_paths, over };

  Result<void> find_plan(TaskResult& result);
  Result<End> search_in_rounds();
  Result<End> search();
  void push_level();
  bool advance();
  Result<bool> plan_moves();
  Result<bool> plan_move(std::size_t level);
  void count(const PlanResult& move);
  Problem problem_of(std::size_t level, const Configuration& goal) const;
  Result<bool> refuse_start(TaskResult& result);
  /// Paths that may fail from one configuration in this round.
  [[nodiscard]] int siblings() const { return run_.settings.siblings << std::min(run_.round, 8); }
  [[nodiscard]] double bound() const;
  void keep_plan();
  [[nodiscard]] SolveSettings move_settings() const;
  void take_path(const SolveResult& solved, Entry& entry) const;
  void compare_plans(int most);
  void polish_best();
  void improve_until_over();
  void remember(TaskResult& result) const;
  void refuse(End end, TaskResult& result) const;
  void describe_stages(TaskResult& result) const;
  [[nodiscard]] StageResult describe_stage(int i, int alternative) const;
  void add_stage(StageResult stage, int i, TaskResult& result) const;
  void add_stages(TaskResult& result) const;
  [[nodiscard]] std::string describe_failure() const;
  [[nodiscard]] const CheckedWorldPtr& world_before(std::size_t level) const;
  [[nodiscard]] const Configuration& end_before(std::size_t level) const;

  TaskRun run_;
  Database* database_;
  std::vector<Group> groups_;
  DropCounts drops_;
  TaskMemory memory_;
  CheckedWorldPtr first_world_;
  std::vector<Level> levels_;
  std::optional<TaskPlan> best_;
  std::uint64_t iterations_ = 0;
  PlanResult moves_;                             ///< counts of all moves that were planned
  PlanStatus move_status_ = PlanStatus::solved;  ///< of the last move
  bool is_improving_ = false;                    ///< moves are planned to be short
  bool has_failed_paths_ = false;                ///< for lack of iterations
  std::size_t deepest_ = 0;                      ///< deepest group that was tried
  std::optional<std::size_t> failed_move_;       ///< deepest group whose move failed
  int plans_ = 0;
};

const CheckedWorldPtr& TaskSearch::world_before(std::size_t level) const {
  return level == 0 ? first_world_ : levels_[level - 1].candidate->after;
}
const Configuration& TaskSearch::end_before(std::size_t level) const {
  return level == 0 ? run_.task.start : levels_[level - 1].candidate->end;
}

void TaskSearch::push_level() {
  const std::size_t level = levels_.size();
  deepest_ = std::max(deepest_, level);
  const Group* next = level + 1 < groups_.size() ? &groups_[level + 1] : nullptr;
  const auto rank = [&, level](const World& world, const std::vector<Transform>& targets,
                               std::size_t first, const std::string& link) {
    return memory_.rank(level, world, targets, first, link);
  };
  Level pushed;
  pushed.alternatives = std::make_unique<Alternatives>(
      run_, drops_, groups_[level], next, world_before(level), end_before(level), rank);
  levels_.push_back(std::move(pushed));
}

/// Takes the next candidate of the last level, or drops levels until one has a next. Returns false
/// once none is left.
bool TaskSearch::advance() {
  while (!levels_.empty() && !run_.is_over()) {
    Level& last = levels_.back();
    last.entry.reset();
    last.candidate = last.alternatives->next();
    // Also one that takes too long: it says nothing about what comes before.
    last.has_candidates = last.has_candidates || last.candidate;
    if (last.candidate && (!best_ || bound() < best_->path_time_s)) return true;
    if (last.candidate) continue;
    const bool is_hopeless = !last.has_candidates;
    levels_.pop_back();
    // What comes next hardly depends on the branch that reaches this alternative.
    if (is_hopeless && run_.round == 0 && !levels_.empty()) {
      levels_.back().alternatives->leave_alternative();
    }
  }
  return false;
}

/// Seconds that any plan through the present candidates takes at least.
double TaskSearch::bound() const {
  double time_s = 0;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const Level& level = levels_[i];
    if (!level.candidate) break;
    time_s += level.candidate->time_s;
    if (!groups_[i].move) continue;
    const Path straight{end_before(i), level.candidate->begin};
    const Path& path = level.entry ? level.entry->path : straight;
    time_s += path_time(run_.task.robot, path) / run_.task.stages[as_index(*groups_[i].move)].speed;
  }
  return time_s;
}

Result<TaskSearch::End> TaskSearch::search() {
  while (!run_.is_over()) {
    if (levels_.size() < groups_.size()) {
      push_level();
      if (!advance()) break;
      continue;
    }
    if (MNEME_TRY(plan_moves())) {
      keep_plan();
      return End::plan;
    }
    if (!advance()) break;
  }
  if (run_.is_over()) return End::over;
  return has_failed_paths_ ? End::no_paths : End::exhausted;
}

/// Plans the moves of the complete choice from the first on. Returns false if one fails: its level
/// is then the last one.
Result<bool> TaskSearch::plan_moves() {
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (levels_[i].entry) continue;
    if (MNEME_TRY(plan_move(i))) {
      if (!best_ || bound() < best_->path_time_s) continue;
      levels_.resize(i + 1);
      return false;
    }
    if (move_status_ == PlanStatus::invalid_start) {
      // Other candidates of this level begin at the same configuration.
      levels_.resize(i);
      return false;
    }
    levels_.resize(i + 1);
    if (move_status_ == PlanStatus::invalid_goal) return false;
    if (++levels_[i].failures >= siblings() && i > 0) levels_.resize(i);
    return false;
  }
  return true;
}

/// The move from the end of the level before to `goal`.
Problem TaskSearch::problem_of(std::size_t level, const Configuration& goal) const {
  const Task& task = run_.task;
  const CheckedWorldPtr& world = world_before(level);
  Problem problem{.name = task.name,
                  .robot = world->world.robot,
                  .robot_path = task.robot_path,
                  .scene = world->checker.scene(),
                  .start = end_before(level),
                  .goals = {goal}};
  if (groups_[level].move) {
    problem.constraints = task.constraints;
    const Stage& stage = task.stages[as_index(*groups_[level].move)];
    problem.constraints.insert(problem.constraints.end(), stage.constraints.begin(),
                               stage.constraints.end());
    if (level == 0) problem.start_velocity = task.start_velocity;
  }
  return problem;
}

SolveSettings TaskSearch::move_settings() const {
  constexpr std::uint64_t kImproveRounds = 4;
  SolveSettings settings = run_.settings.solve;
  PlanSettings& plan = settings.plan;
  plan.timeout_s = run_.remaining_s();
  plan.max_iterations = std::min(iterations_, plan.max_iterations.value_or(iterations_));
  plan.improve = is_improving_ ? run_.remaining_s() : 0;
  plan.improve_rounds.reset();
  if (is_improving_) plan.improve_rounds = kImproveRounds;
  if (is_improving_) plan.minimize_time = true;
  return settings;
}

/// Takes the path of a move, and the scene as it was checked: with pairs that count by exact
/// geometry only.
void TaskSearch::take_path(const SolveResult& solved, Entry& entry) const {
  if (solved.scene) {
    Problem checked = *entry.problem;
    checked.scene = *solved.scene;
    entry.problem = std::make_shared<const Problem>(std::move(checked));
  }
  entry.path = solved.plan.path;
  entry.path.back() = run_.task.robot.turned_near(entry.problem->goals.front(), entry.path.back());
  entry.states = solved.plan.states_checked;
}

Result<bool> TaskSearch::plan_move(std::size_t level) {
  Entry entry;
  if (!groups_[level].move) {
    levels_[level].entry = std::move(entry);
    return true;
  }
  auto problem = std::make_shared<Problem>(problem_of(level, levels_[level].candidate->begin));
  SolveResult solved = MNEME_TRY(mneme::solve(*problem, database_, move_settings()));
  count(solved.plan);
  move_status_ = solved.plan.status;
  if (!solved.plan.is_solved()) {
    failed_move_ = std::max(failed_move_.value_or(0), level);
    drops_.add(*groups_[level].move, {DropReason::path, solved.plan.message},
               levels_[level].candidate->alternative);
    // More iterations do not mend ends.
    const bool is_refused =
        move_status_ == PlanStatus::invalid_start || move_status_ == PlanStatus::invalid_goal;
    has_failed_paths_ = has_failed_paths_ || !is_refused;
    return false;
  }
  for (const std::string& note : solved.notes) {
    entry.notes.push_back(
        fmt::format("stage '{}': {}", stage_name(run_.task, *groups_[level].move), note));
  }
  entry.problem = std::move(problem);
  take_path(solved, entry);
  levels_[level].entry = std::move(entry);
  return true;
}

void TaskSearch::count(const PlanResult& move) {
  moves_.iterations += move.iterations;
  moves_.nodes += move.nodes;
  moves_.states_checked += move.states_checked;
  moves_.motions_checked += move.motions_checked;
}

void TaskSearch::keep_plan() {
  ++plans_;
  TaskPlan plan;
  plan.path_time_s = bound();
  for (const Level& level : levels_) {
    plan.candidates.push_back(*level.candidate);
    plan.entries.push_back(*level.entry);
  }
  if (!best_ || plan.path_time_s < best_->path_time_s) best_ = std::move(plan);
}

/// Finds complete choices that take less time than the best one, until `most` plans were found.
void TaskSearch::compare_plans(int most) {
  while (!run_.is_over() && plans_ < most) {
    const Result<End> end = search();
    if (!end || *end != End::plan || !advance()) break;
  }
}

/// Plans the moves of the best choice again, with improvement.
void TaskSearch::polish_best() {
  is_improving_ = true;
  for (std::size_t i = 0; i < groups_.size() && !run_.is_over(); ++i) {
    Entry& entry = best_->entries[i];
    if (!entry.problem) continue;
    const auto solved = mneme::solve(*entry.problem, database_, move_settings());
    if (!solved) return;
    count(solved->plan);
    if (!solved->plan.is_solved()) continue;
    const double gain =
        path_time(run_.task.robot, entry.path) - path_time(run_.task.robot, solved->plan.path);
    if (gain <= 0) continue;
    take_path(*solved, entry);
    best_->path_time_s -= gain / run_.task.stages[as_index(*groups_[i].move)].speed;
  }
}

/// Half of the effort compares choices with the first paths of their moves. Then moves are
/// improved: those of the best choice, and those of all choices that may still be better.
void TaskSearch::improve_until_over() {
  const double begin_s = run_.stopwatch.elapsed_s();
  const double end_s = std::min(run_.end_s, begin_s + run_.settings.improve);
  const auto& limit = run_.settings.improve_plans;
  const int most = limit.value_or(std::numeric_limits<int>::max());
  run_.end_s = limit ? end_s : 0.5 * (begin_s + end_s);
  if (advance()) compare_plans(limit ? (most + 1) / 2 : most);
  run_.end_s = end_s;
  polish_best();
  // The second round tries branches and lines that the first one leaves out.
  do {
    levels_.clear();
    compare_plans(most);
  } while (run_.round++ == 0 && !run_.is_over() && plans_ < most);
}

/// The deepest move whose path failed, or the deepest group at which something was dropped: paths
/// are planned last, so that a move may fail before groups that have candidates.
std::string TaskSearch::describe_failure() const {
  const auto describe = [&](std::size_t group) {
    return describe_drops(run_.task, groups_[group], drops_);
  };
  std::string text = failed_move_ ? describe(*failed_move_) : "";
  for (std::size_t i = deepest_ + 1; text.empty() && i-- > 0;) text = describe(i);
  return text;
}

void TaskSearch::describe_stages(TaskResult& result) const {
  for (int i = 0; i < static_cast<int>(run_.task.stages.size()); ++i) {
    StageResult stage = describe_stage(i, -1);
    if (!stage.dropped.empty()) result.stages.push_back(std::move(stage));
  }
}

StageResult TaskSearch::describe_stage(int i, int alternative) const {
  StageResult stage;
  const Stage& at = run_.task.stages[as_index(i)];
  stage.name = stage_name(run_.task, i);
  stage.kind = at.kind;
  stage.alternatives = count_alternatives(at);
  stage.alternative = alternative;
  stage.dropped = drops_.of_stage(i, alternative);
  return stage;
}

void TaskSearch::add_stage(StageResult stage, int i, TaskResult& result) const {
  const Robot& robot = run_.task.robot;
  const double speed = run_.task.stages[as_index(i)].speed;
  stage.path_time_s = path_time(robot, stage.path) / speed;
  if (stage.gripper) {
    stage.path_time_s += path_time(stage.gripper->world->robot, stage.gripper->path) / speed;
  }
  // Continuous joints do not jump between stages.
  if (!result.stages.empty()) {
    stage.path = unwrapped(robot, std::move(stage.path), result.stages.back().path.back());
  }
  result.stages.push_back(std::move(stage));
}

void TaskSearch::add_stages(TaskResult& result) const {
  const Task& task = run_.task;
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    const Candidate& candidate = best_->candidates[k];
    const Group& group = groups_[k];
    if (group.move) {
      const Entry& entry = best_->entries[k];
      StageResult move =
          describe_stage(*group.move, group.is_line_anchor ? -1 : candidate.alternative);
      move.world = entry.problem;
      move.path = entry.path;
      move.states_checked = entry.states;
      result.notes.insert(result.notes.end(), entry.notes.begin(), entry.notes.end());
      add_stage(std::move(move), *group.move, result);
    }
    for (const LocalStage& local : candidate.stages) {
      const bool is_anchor = group.is_line_anchor && local.stage == *group.anchor;
      StageResult stage =
          describe_stage(local.stage, is_anchor ? candidate.alternative : local.alternative);
      stage.path = local.path;
      stage.gripper = local.gripper;
      for (const std::string& touch : local.touches) {
        result.notes.push_back(fmt::format("stage '{}' ends in contact: {}", stage.name, touch));
      }
      const CheckedWorld& world = *local.world;
      Problem problem{.name = task.name,
                      .robot = world.world.robot,
                      .robot_path = task.robot_path,
                      .scene = world.checker.scene(),
                      .start = stage.path.front(),
                      .goals = {stage.path.back()}};
      if (stage.kind == StageKind::line) problem.constraints = task.constraints;
      stage.world = std::make_shared<const Problem>(std::move(problem));
      add_stage(std::move(stage), local.stage, result);
    }
  }
}

/// Searches in rounds, each harder than the one before, until one ends with a plan or with nothing
/// that a harder one may find.
Result<TaskSearch::End> TaskSearch::search_in_rounds() {
  const std::uint64_t most = run_.settings.solve.plan.max_iterations.value_or(
      std::numeric_limits<std::uint64_t>::max() / kIterationGrowth);
  for (iterations_ = run_.settings.first_iterations;; iterations_ *= kIterationGrowth) {
    drops_ = DropCounts(run_.task.stages.size());
    levels_.clear();
    has_failed_paths_ = false;
    const End end = MNEME_TRY(search());
    const bool may_try_harder = end == End::no_paths
                                    ? iterations_ < most
                                    : end == End::exhausted && run_.round == 0 && run_.has_tried;
    if (!may_try_harder) return end;
    ++run_.round;
  }
}

void TaskSearch::remember(TaskResult& result) const {
  if (!run_.settings.solve.remember_after) return;
  std::vector<Configuration> anchors;
  for (const Candidate& candidate : best_->candidates) anchors.push_back(candidate.anchor);
  const auto stored = memory_.remember(anchors, run_.task.name);
  if (!stored) result.notes.push_back("the choices were not remembered: " + stored.error().message);
  result.is_remembered = stored.value_or(false);
}

/// Refuses a start from which no motion may begin: before any search, as solve() does.
Result<bool> TaskSearch::refuse_start(TaskResult& result) {
  const StageKind first = run_.task.stages.front().kind;
  const bool moves =
      first != StageKind::attach && first != StageKind::detach && first != StageKind::allow;
  if (!moves) return false;
  const Problem stay = problem_of(0, run_.task.start);
  ++run_.states;
  const bool is_free = !stay.is_moving() && stay.constraints.empty();
  if (is_free && is_clear(first_world_->checker, stay.start)) return false;
  SolveSettings settings = run_.settings.solve;
  settings.remember_after.reset();
  const SolveResult solved = MNEME_TRY(mneme::solve(stay, database_, settings));
  if (solved.plan.status != PlanStatus::invalid_start) return false;
  result.status = solved.plan.status;
  result.message = fmt::format("stage '{}': {}", stage_name(run_.task, 0), solved.plan.message);
  return true;
}

void TaskSearch::refuse(End end, TaskResult& result) const {
  result.message = describe_failure();
  result.status = end == End::no_paths ? PlanStatus::iteration_limit : PlanStatus::invalid_goal;
  if (run_.is_cancelled()) {
    result.status = PlanStatus::cancelled;
    result.message = "cancelled";
  } else if (end == End::over) {
    result.status = PlanStatus::timeout;
    result.message = "no plan within the time limit" +
                     (result.message.empty() ? "" : "; so far " + result.message);
  }
  describe_stages(result);
}

Result<TaskResult> TaskSearch::solve() {
  TaskResult result;
  first_world_ = MNEME_TRY(check_unless_cancelled(first_world(run_.task), run_));
  if (first_world_ == nullptr) {
    result.status = PlanStatus::cancelled;
    result.message = "cancelled";
    return result;
  }
  result.preparation_time_s = run_.stopwatch.elapsed_s();
  run_.stopwatch = Stopwatch();
  result.remembered_rows = memory_.rows();
  if (!MNEME_TRY(refuse_start(result))) MNEME_TRY(find_plan(result));
  result.plans = plans_;
  result.states_checked = run_.states + moves_.states_checked;
  result.iterations = moves_.iterations;
  result.nodes = moves_.nodes;
  result.motions_checked = moves_.motions_checked;
  result.total_time_s = result.preparation_time_s + run_.stopwatch.elapsed_s();
  return result;
}

Result<void> TaskSearch::find_plan(TaskResult& result) {
  const End end = MNEME_TRY(search_in_rounds());
  if (best_) {
    result.status = PlanStatus::solved;
    result.first_plan_time_s = run_.stopwatch.elapsed_s();
    result.first_path_time_s = best_->path_time_s;
    if (run_.settings.improve > 0) improve_until_over();
    result.path_time_s = best_->path_time_s;
    add_stages(result);
    remember(result);
  } else {
    refuse(end, result);
  }
  return {};
}

/// Improvement of the moves means improvement of the task, where the task's settings say nothing.
TaskSettings completed(TaskSettings settings) {
  const PlanSettings& plan = settings.solve.plan;
  if (settings.improve == 0) settings.improve = plan.improve;
  if (!settings.improve_plans && plan.improve_rounds) {
    constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
    settings.improve_plans = static_cast<int>(std::min(*plan.improve_rounds, kMost));
  }
  return settings;
}

/// A start barely beyond limits is led inside by a move, as by solve(), and by no other stage.
std::optional<std::string> find_start_violation(const Task& task, const EndTolerances& near) {
  auto violation = task.robot.describe_violation(task.start, "start");
  const bool is_near = violation && is_near_limits(task.robot, task.start, near);
  if (is_near && task.stages.front().kind == StageKind::move) return std::nullopt;
  if (is_near) *violation += "; start-tolerance allows that where the first stage is a move";
  return violation;
}

}  // namespace

Result<TaskResult> solve_task(const Task& task, Database* database, const TaskSettings& given) {
  MNEME_TRY(internal::check_ranges(given));
  MNEME_TRY(check_settings(given.solve));
  MNEME_TRY(check_task(task));
  const TaskSettings settings = completed(given);
  if (auto violation = find_start_violation(task, end_tolerances(settings.solve))) {
    TaskResult refused;
    refused.status = PlanStatus::invalid_start;
    refused.message = *std::move(violation);
    return refused;
  }
  return TaskSearch(task, database, settings, MNEME_TRY(internal::make_groups(task))).solve();
}

}  // namespace mneme
