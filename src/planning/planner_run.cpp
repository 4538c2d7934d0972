// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_run.h"

#include "base/threads.h"
#include "path/waypoints.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {
namespace {

/// Iterations and motions per reading of the clock, which costs a tenth of a fast iteration.
constexpr std::uint64_t kWorkPerClockCheck = 32;
/// Number of shapes from which motions take so long that the clock is read more often.
constexpr std::uint64_t kManyShapes = 1000;
/// Shorter steps round to zero, or take longer to cross the space than any time limit.
constexpr double kLeastRange = 1e-3;
constexpr float kFirstDomainRadius = 4;  ///< radians of L2 joint distance

std::uint64_t work_per_clock_check(const Scene& scene) {
  std::uint64_t shapes = 0;
  for (const Obstacle& obstacle : scene.obstacles) shapes += obstacle.shapes.size();
  const std::uint64_t work = kWorkPerClockCheck * kManyShapes / std::max(shapes, kManyShapes);
  return std::max(work, std::uint64_t{1});
}

/// Long steps lead arms of few joints to their goal faster. Verification must find contact that
/// coarse checks miss.
bool begins_coarse(const CollisionChecker& checker, const PlanSettings& settings) {
  constexpr int kMostJoints = 10;
  return !settings.range && checker.has_default_resolution() &&
         settings.verification() != Verification::none && !checker.robot().is_planar() &&
         checker.robot().joint_count() <= kMostJoints;
}

}  // namespace

PlannerRun::PlannerRun(const PlanTask& task)
    : checker_(task.checker),
      query_(task.query),
      shorten_and_verify_(task.shorten_and_verify),
      settings_(task.settings),
      space_(checker_.robot()),
      range_(static_cast<float>(
          std::max(settings_.range.value_or(default_range(checker_.robot())), kLeastRange))),
      long_range_(settings_.range ? range_ : range_ / 2),
      early_iterations_(begins_coarse(checker_, settings_) ? kEarly : 0),
      first_domain_(checker_.robot().is_planar() ? std::numeric_limits<float>::infinity()
                                                 : kFirstDomainRadius * kFirstDomainRadius),
      further_goals_(task.further_goals),
      work_per_clock_check_(work_per_clock_check(checker_.scene())),
      stream_(task.sampler.start(settings_.seed)),
      limit_(task.limit),
      motions_(task.motions) {
  const Robot& robot = checker_.robot();
  start_ = to_floats(robot, query_.start);
  for (const Configuration& goal : query_.goals) add_goal(goal);
}

void PlannerRun::add_goal(const Configuration& goal) {
  goal_configurations_.push_back(checker_.robot().normalized(goal));
  goals_.push_back(to_floats(goal_configurations_.back()));
}

std::size_t PlannerRun::take_further_goals() {
  const std::size_t known = goals_.size();
  if (further_goals_ == nullptr || result_.iterations < next_goals_) return known;
  next_goals_ = result_.iterations + kGoalPeriod;
  if (known >= kMostGoals) return known;
  for (const Configuration& goal : further_goals_->more()) {
    if (goals_.size() < kMostGoals) add_goal(goal);
  }
  return known;
}

void PlannerRun::refuse(PlanStatus status, std::string message) {
  result_.status = status;
  result_.message = std::move(message);
}

void PlannerRun::stop(PlanStatus status, std::string message) {
  refuse(status, std::move(message));
  is_stopped_ = true;
}

int PlannerRun::begin_iterations(int most) {
  auto count = static_cast<std::uint64_t>(most);
  if (settings_.max_iterations) {
    count = std::min(count, *settings_.max_iterations - result_.iterations);
    if (count == 0) {
      refuse(PlanStatus::iteration_limit,
             "no path within " + std::to_string(*settings_.max_iterations) + " iterations");
      return 0;
    }
  }
  if (must_stop()) return 0;
  if (limit_ != nullptr && !limit_->may_go_on(result_.iterations)) {
    stop(PlanStatus::cancelled, "the limit of the search ended it");
    return 0;
  }
  result_.iterations += count;
  return static_cast<int>(count);
}

bool PlannerRun::must_stop() {
  if (is_stopped_) return true;
  if (static_cast<std::uint64_t>(node_count_) >= settings_.max_nodes) {
    stop(PlanStatus::node_limit,
         "no path within " + std::to_string(settings_.max_nodes) + " nodes");
    return true;
  }
  const std::uint64_t work = result_.iterations + counters_.motions;
  if (work < next_clock_check_) return false;
  next_clock_check_ = work + work_per_clock_check_;
  if (is_set(settings_.cancel)) {
    stop(PlanStatus::cancelled, "cancelled");
  } else if (stopwatch_.elapsed_s() >= settings_.timeout_s) {
    stop(PlanStatus::timeout, "no path within the time limit");
  }
  return is_stopped_;
}

/// True if verification will pass a motion. Without this check, a branch that verification refuses
/// would be found again and again.
bool PlannerRun::would_pass(std::span<const float> from, std::span<const float> to) {
  const auto is_end = [&](std::span<const float> q) {
    const auto is_same = [&](const std::vector<float>& end) { return std::ranges::equal(q, end); };
    return is_same(start_) || std::ranges::any_of(goals_, is_same);
  };
  return shorten_and_verify_.verifier().is_free(from, to, {is_end(from), is_end(to)}, counters_);
}

bool PlannerRun::find_direct_path() {
  return std::ranges::any_of(goals_, [&](const std::vector<float>& goal) {
    return !must_stop() && is_motion_valid(start_, goal) && find_invalid_motion({start_, goal}) < 0;
  });
}

int PlannerRun::find_invalid_motion(const FloatPath& path) {
  Path offered = to_query_path(path);
  const int invalid = shorten_and_verify_(offered, counters_);
  if (invalid < 0) result_.path = std::move(offered);
  return invalid;
}

Path PlannerRun::to_query_path(const FloatPath& path) const {
  const Robot& robot = checker_.robot();
  Path result = to_path(robot, path);
  result.front() = robot.normalized(query_.start);
  const auto goal = std::ranges::find(goals_, path.back()) - goals_.begin();
  result.back() = goal_configurations_[static_cast<std::size_t>(goal)];
  return result;
}

PlanResult PlannerRun::finish(int node_count) {
  result_.status = PlanStatus::solved;
  result_.message.clear();
  return take_result(node_count);
}

PlanResult PlannerRun::give_up(int node_count) {
  result_.message += shorten_and_verify_.describe_refused();
  return take_result(node_count);
}

PlanResult PlannerRun::take_result(int node_count) {
  result_.nodes = static_cast<std::uint64_t>(node_count);
  result_.states_checked = counters_.states;
  result_.motions_checked = counters_.motions;
  result_.simplification_time_s = shorten_and_verify_.simplification_time_s();
  result_.verification_time_s = shorten_and_verify_.verification_time_s();
  result_.planning_time_s =
      stopwatch_.elapsed_s() - result_.simplification_time_s - result_.verification_time_s;
  return std::move(result_);
}

}  // namespace mneme::internal
