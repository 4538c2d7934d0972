// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/ompl_run.h"

#include <algorithm>

#include <ompl/base/goals/GoalStates.h>

#include "ompl/count_samples.h"
#include "ompl/experience.h"
#include "ompl/verified_motion_validity.h"
#include "path/shortcut.h"

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

constexpr double kTunedRange = 0.4;      ///< radians
constexpr double kTunedDeviation = 0.4;  ///< radians, of OMPL's Gaussian and bridge-test samplers
constexpr int kShortcutAttempts = 100;

ob::ScopedState<> to_state(const ob::SpaceInformationPtr& information, const Configuration& q) {
  ob::ScopedState<> state(information);
  state = q;
  return state;
}

}  // namespace

OmplRun::OmplRun(const Problem& problem, const CollisionChecker& checker,
                 const SolveSettings& settings, const OmplSettings& ompl,
                 const OmplPlanner& planner, const ob::StateSamplerAllocator& allocator)
    : problem_(problem),
      checker_(checker),
      settings_(settings),
      ompl_(ompl),
      planner_(planner),
      // What simplification makes is verified in any case.
      verifier_(checker, std::max(settings.plan.verification(), Verification::states),
                [this] { return is_over(); }) {
  set_up_information(allocator);
  define_problem();
}

void OmplRun::set_up_information(const ob::StateSamplerAllocator& allocator) {
  if (ompl_.as_in_paper && settings_.resolution == 0) {
    const auto space = std::make_shared<JointStateSpace>(problem_.robot);
    information_ = std::make_shared<ob::SpaceInformation>(space);
    information_->setStateValidityChecker(make_state_validity(information_, checker_, counters_));
    information_->setup();
  } else {
    information_ = make_space_information(checker_, counters_);
  }
  information_->getStateSpace()->setStateSamplerAllocator(count_samples(allocator, counters_));
  if (auto valid =
          valid_sampler_allocator(settings_.sampler, ompl_.as_in_paper ? 0.0 : kTunedDeviation)) {
    information_->setValidStateSamplerAllocator(valid);
  }
}

void OmplRun::define_problem() {
  definition_ = std::make_shared<ob::ProblemDefinition>(information_);
  definition_->addStartState(
      to_state(information_, problem_.robot.normalized(problem_.start)).get());
  const auto goals = std::make_shared<ob::GoalStates>(information_);
  for (const Configuration& goal : problem_.goals) {
    goals->addState(to_state(information_, problem_.robot.normalized(goal)).get());
  }
  definition_->setGoal(goals);
  const auto objective = make_path_length_objective(information_);
  // Any path will do: planners that optimise stop at their first.
  objective->setCostThreshold(objective->infiniteCost());
  definition_->setOptimizationObjective(objective);
}

ob::PlannerTerminationCondition OmplRun::limits() const {
  return ob::PlannerTerminationCondition([this] {
    const std::uint64_t most = settings_.plan.max_iterations;
    if (most > 0 && counters_->samples.load(std::memory_order_relaxed) >= most) return true;
    if (is_full()) was_full_ = true;
    return was_full_ || is_over();
  });
}

bool OmplRun::is_over() const {
  const std::atomic<bool>* cancel = settings_.plan.cancel;
  return (cancel != nullptr && cancel->load(std::memory_order_relaxed)) ||
         stopwatch_.elapsed_s() >= timeout_s_;
}

bool OmplRun::is_full() const {
  const auto& space = *information_->getStateSpace()->as<JointStateSpace>();
  return settings_.plan.max_nodes > 0 && space.state_count() >= settings_.plan.max_nodes;
}

Result<ob::PlannerPtr> OmplRun::make_planner() const {
  const double wanted = settings_.plan.range;
  const double range = wanted > 0 || ompl_.as_in_paper ? wanted : kTunedRange;
  if (planner_.make == nullptr) {
    return make_experience_planner(planner_.name, information_, ompl_.experience_path, range);
  }
  const ob::PlannerPtr planner = planner_.make(information_);
  set_range(*planner, range);
  return planner;
}

Result<PlanResult> OmplRun::plan(double spent_s) {
  const auto made = make_planner();
  if (!made) return tl::unexpected(made.error());
  const ob::PlannerPtr& planner = *made;
  planner->setProblemDefinition(definition_);
  timeout_s_ = settings_.plan.timeout_s - spent_s + stopwatch_.elapsed_s();
  // One per attempt, because parallel planners end theirs when they have a path.
  for (auto limit = limits(); !limit; limit = limits()) {
    planner->solve(limit);
    if (!definition_->hasExactSolution()) break;
    const Path path = solution();
    if (ompl_.as_in_paper || !settings_.plan.verify || is_free(path)) {
      result_.status = PlanStatus::solved;
      result_.path = path;
      break;
    }
    ++refused_path_count_;
    planner->clear();
    definition_->clearSolutionPaths();
    information_->setMotionValidator(
        make_verified_motion_validity(information_, checker_, counters_, verifier_));
    information_->setup();
  }
  if (result_.is_solved() && settings_.plan.simplify) simplify();
  if (!result_.is_solved()) explain_failure();
  result_.iterations = counters_->samples.load();
  result_.states_checked = counters_->states.load() + checks_.states;
  result_.motions_checked = counters_->motions.load() + checks_.motions;
  result_.planning_time_s =
      stopwatch_.elapsed_s() - result_.simplification_time_s - result_.verification_time_s;
  return std::move(result_);
}

/// The ends are the query's own, as if they had not been copied and wrapped on the way.
Path OmplRun::solution() const {
  const auto& states =
      dynamic_cast<const ::ompl::geometric::PathGeometric&>(*definition_->getSolutionPath());
  const Robot& robot = problem_.robot;
  Path path = from_ompl(states, robot);
  path.front() = robot.normalized(problem_.start);
  const auto goal =
      std::min_element(problem_.goals.begin(), problem_.goals.end(),
                       [&](const Configuration& a, const Configuration& b) {
                         return robot.distance(path.back(), a) < robot.distance(path.back(), b);
                       });
  path.back() = robot.normalized(*goal);
  return path;
}

bool OmplRun::is_free(const Path& path) {
  const internal::Stopwatch stopwatch;
  const bool is_free = verifier_.find_invalid_motion(path, checks_) < 0;
  result_.verification_time_s += stopwatch.elapsed_s();
  return is_free;
}

/// Shortcuts may cut out a motion that tunnels through an obstacle, and hide what the planner did.
void OmplRun::simplify() {
  if (ompl_.as_in_paper && !is_free(result_.path)) return;
  const internal::Stopwatch stopwatch;
  Path path = result_.path;
  internal::shortcut_until(checker_, path, derive_seed(settings_.plan.seed, 1),
                           {kShortcutAttempts, kShortcutAttempts, 0}, &verifier_, checks_,
                           [this] { return is_over(); });
  result_.simplification_time_s += stopwatch.elapsed_s();
  // Cutting a motion moves the states that are looked at.
  if (!settings_.plan.verify || is_free(path)) result_.path = std::move(path);
}

void OmplRun::explain_failure() {
  const PlanSettings& plan = settings_.plan;
  if (plan.cancel != nullptr && plan.cancel->load()) {
    result_.status = PlanStatus::cancelled;
    result_.message = "cancelled";
  } else if (plan.max_iterations > 0 && counters_->samples.load() >= plan.max_iterations) {
    result_.status = PlanStatus::iteration_limit;
    result_.message = "no path within " + std::to_string(plan.max_iterations) + " iterations";
  } else if (was_full_) {
    result_.status = PlanStatus::node_limit;
    result_.message = "no path within " + std::to_string(plan.max_nodes) + " nodes";
  } else {
    result_.status = PlanStatus::timeout;
    result_.message = stopwatch_.elapsed_s() >= timeout_s_
                          ? "no path within the time limit"
                          : "the planner gave up before the time limit";
  }
  result_.message += internal::describe_refused(refused_path_count_);
}

}  // namespace mneme::ompl
