// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_run.h"

#include <algorithm>
#include <limits>

#include "path/path_conversion.h"
#include "path/shortcut.h"

namespace mneme::internal {
namespace {

/// Iterations and motions per look at the clock, which costs a tenth of a fast iteration.
constexpr std::uint64_t kWorkPerClockCheck = 32;
/// Shapes in a scene from which on a motion takes so long that the clock is looked at more often.
constexpr std::uint64_t kManyShapes = 1000;
/// Shorter steps round to no movement at all, or take longer to cross the space than a time limit.
constexpr double kLeastRange = 1e-3;
/// Radians of L2 joint distance.
constexpr float kFirstDomainRadius = 4;
constexpr int kShortcutAttempts = 100;
/// Shortening gives up after one attempt in vain per so many motions that planning checked, within
/// the bounds below: it should take no longer than the planning.
constexpr std::uint64_t kMotionsPerAttempt = 16;
constexpr std::uint64_t kLeastPatience = 12, kMostPatience = 60;
constexpr float kLeastShortcutGain = 0.01f;

std::uint64_t work_per_clock_check(const Scene& scene) {
  std::uint64_t shapes = 0;
  for (const Obstacle& obstacle : scene.obstacles) shapes += obstacle.shapes.size();
  const std::uint64_t work = kWorkPerClockCheck * kManyShapes / std::max(shapes, kManyShapes);
  return std::max(work, std::uint64_t{1});
}

}  // namespace

PlannerRun::PlannerRun(const CollisionChecker& checker, const PlanQuery& query,
                       const Sampler& sampler, const PlanSettings& settings)
    : checker_(checker),
      query_(query),
      settings_(settings),
      space_(checker.robot()),
      range_(static_cast<float>(settings.range > 0 ? std::max(settings.range, kLeastRange)
                                                   : default_range(checker.robot()))),
      long_range_(settings.range > 0 ? range_ : range_ / 2),
      first_domain_(checker.robot().is_planar() ? std::numeric_limits<float>::infinity()
                                                : kFirstDomainRadius * kFirstDomainRadius),
      work_per_clock_check_(work_per_clock_check(checker.scene())),
      stream_(sampler.start(settings.seed)) {
  validate();
}

void PlannerRun::refuse(PlanStatus status, std::string message) {
  result_.status = status;
  result_.message = std::move(message);
}

void PlannerRun::validate() {
  if (auto refused = refuse_query(checker_, query_)) {
    result_ = *std::move(refused);
    return;
  }
  const Robot& robot = checker_.robot();
  start_ = to_floats(robot.normalized(query_.start));
  for (const Configuration& goal : query_.goals)
    goals_.push_back(to_floats(robot.normalized(goal)));
  is_ready_ = true;
}

int PlannerRun::begin_iterations(int most) {
  auto count = static_cast<std::uint64_t>(most);
  if (settings_.max_iterations > 0) {
    count = std::min(count, settings_.max_iterations - result_.iterations);
    if (count == 0) {
      refuse(PlanStatus::iteration_limit,
             "no path within " + std::to_string(settings_.max_iterations) + " iterations");
      return 0;
    }
  }
  if (must_stop()) return 0;
  result_.iterations += count;
  return static_cast<int>(count);
}

bool PlannerRun::must_stop() {
  if (is_stopped_) return true;
  if (is_full()) {
    refuse(PlanStatus::node_limit,
           "no path within " + std::to_string(settings_.max_nodes) + " nodes");
    is_stopped_ = true;
    return true;
  }
  const std::uint64_t work = result_.iterations + counters_.motions;
  if (work < next_clock_check_) return false;
  next_clock_check_ = work + work_per_clock_check_;
  if (is_cancelled()) {
    refuse(PlanStatus::cancelled, "cancelled");
    is_stopped_ = true;
  } else if (is_time_up()) {
    refuse(PlanStatus::timeout, "no path within the time limit");
    is_stopped_ = true;
  }
  return is_stopped_;
}

bool PlannerRun::is_cancelled() const {
  return settings_.cancel != nullptr && settings_.cancel->load(std::memory_order_relaxed);
}

bool PlannerRun::is_time_up() const { return stopwatch_.elapsed_s() >= settings_.timeout_s; }

bool PlannerRun::is_full() const {
  return settings_.max_nodes > 0 && static_cast<std::uint64_t>(node_count_) >= settings_.max_nodes;
}

int PlannerRun::find_direct_goal() {
  if (settings_.timeout_s <= 0) return -1;
  for (std::size_t i = 0; i < goals_.size(); ++i) {
    if (is_motion_valid(start_, goals_[i]) && find_invalid_motion({start_, goals_[i]}) < 0) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int PlannerRun::find_invalid_motion(const FloatPath& path) {
  const auto goal = std::find(goals_.begin(), goals_.end(), path.back()) - goals_.begin();
  const Path planned = to_query_path(path, static_cast<std::size_t>(goal));
  if (settings_.simplify) {
    shortened_ = shortened(planned, nullptr);
    if (find_invalid_motion(*shortened_) < 0) return -1;
    shortened_.reset();
  }
  const int invalid = find_invalid_motion(planned);
  if (invalid >= 0) ++refused_path_count_;
  return invalid;
}

Path PlannerRun::to_query_path(const FloatPath& path, std::size_t goal) const {
  const Robot& robot = checker_.robot();
  Path result = to_path(robot, path);
  result.front() = robot.normalized(query_.start);
  if (goal < goals_.size()) result.back() = robot.normalized(query_.goals[goal]);
  return result;
}

int PlannerRun::find_invalid_motion(const Path& path) {
  if (!settings_.verify) return -1;
  const Stopwatch stopwatch;
  const int invalid = verifier().find_invalid_motion(path, counters_);
  result_.verification_time_s += stopwatch.elapsed_s();
  return invalid;
}

const MotionVerifier& PlannerRun::verifier() {
  if (!verifier_) {
    verifier_.emplace(checker_, settings_.verification(),
                      [this] { return is_cancelled() || is_time_up(); });
  }
  return *verifier_;
}

PlanResult PlannerRun::finish(const FloatPath& path, int goal, int node_count) {
  result_.status = PlanStatus::solved;
  result_.message.clear();
  if (shortened_) {
    result_.path = *std::move(shortened_);
    return take_result(node_count);
  }
  result_.path = to_query_path(path, static_cast<std::size_t>(goal));
  if (settings_.simplify) {
    // Cutting a motion moves the states that are looked at, so even verified ones are verified.
    Path verified = shortened(result_.path, &verifier());
    if (find_invalid_motion(verified) < 0) result_.path = std::move(verified);
  }
  return take_result(node_count);
}

Path PlannerRun::shortened(Path path, const MotionVerifier* verifier) {
  const auto patience = static_cast<int>(
      std::clamp(counters_.motions / kMotionsPerAttempt, kLeastPatience, kMostPatience));
  // The other half of what is left of the time is for verification.
  const double end_s = 0.5 * (stopwatch_.elapsed_s() + settings_.timeout_s);
  const auto must_stop = [&] { return is_cancelled() || stopwatch_.elapsed_s() >= end_s; };
  const Stopwatch stopwatch;
  internal::shortcut_until(checker_, path, derive_seed(settings_.seed, 1),
                           {kShortcutAttempts, patience, kLeastShortcutGain}, verifier, counters_,
                           must_stop);
  result_.simplification_time_s += stopwatch.elapsed_s();
  return path;
}

PlanResult PlannerRun::give_up(int node_count) {
  result_.message += describe_refused(refused_path_count_);
  return take_result(node_count);
}

PlanResult PlannerRun::take_result(int node_count) {
  result_.nodes = static_cast<std::uint64_t>(node_count);
  result_.states_checked = counters_.states;
  result_.motions_checked = counters_.motions;
  result_.planning_time_s =
      stopwatch_.elapsed_s() - result_.simplification_time_s - result_.verification_time_s;
  return std::move(result_);
}

}  // namespace mneme::internal
