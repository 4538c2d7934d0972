// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/planner_table.h"
#include "ompl/states.h"

#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

constexpr double kTunedRange = 0.4;      ///< radians
constexpr double kTunedDeviation = 0.4;  ///< radians, of OMPL's Gaussian and bridge-test samplers

ob::ScopedState<> to_state(const ob::SpaceInformationPtr& information, const Configuration& q) {
  ob::ScopedState<> state(information);
  state = q;
  return state;
}

/// One run of an OMPL planner, like PlannerRun for mneme's planners. Not thread-safe. Each function
/// may throw OMPL's exceptions.
class OmplRun {
 public:
  /// Keeps references to its arguments.
  OmplRun(const OmplPlanner& planner, const PlanTask& task);

  /// Plans until the limits are reached. Errors: experience that cannot be read.
  [[nodiscard]] Result<PlanResult> plan();

 private:
  void set_up_information();
  void define_problem();
  [[nodiscard]] Result<::ompl::base::PlannerPtr> make_planner() const;
  [[nodiscard]] ::ompl::base::PlannerTerminationCondition limits() const;
  [[nodiscard]] bool is_full() const;
  /// True if the time limit is reached or the run is cancelled.
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] Path solution() const;
  /// Shortens and verifies a path, depending on the settings. False if it is refused.
  [[nodiscard]] bool is_accepted(Path& path);
  void explain_failure();

  const OmplPlanner& planner_;
  const PlanTask& task_;
  const PlanSettings& settings_;
  const Robot& robot_;
  std::shared_ptr<WorkCounters> counters_ = std::make_shared<WorkCounters>();
  std::shared_ptr<::ompl::base::SpaceInformation> information_;
  ::ompl::base::ProblemDefinitionPtr definition_;
  Stopwatch stopwatch_;
  CheckCounters checks_;  ///< of simplification and verification
  /// The node limit was reached. Planners free their states at the end and may have several
  /// threads.
  mutable std::atomic<bool> was_full_{false};
  PlanResult result_;
};

OmplRun::OmplRun(const OmplPlanner& planner, const PlanTask& task)
    : planner_(planner), task_(task), settings_(task.settings), robot_(task.checker.robot()) {
  set_up_information();
  define_problem();
}

void OmplRun::set_up_information() {
  if (settings_.ompl_defaults && task_.checker.has_default_resolution()) {
    const auto space = std::make_shared<JointStateSpace>(robot_);
    information_ = std::make_shared<ob::SpaceInformation>(space);
    information_->setStateValidityChecker(
        make_state_validity(information_, task_.checker, counters_));
    information_->setup();
  } else {
    information_ = make_space_information(task_.checker, counters_);
  }
  // Not owned: the caller owns the sampler.
  const std::shared_ptr<const Sampler> sampler(&task_.sampler, [](const Sampler*) {});
  information_->getStateSpace()->setStateSamplerAllocator(
      count_samples(sampler_allocator(sampler, settings_.seed), counters_));
  const double deviation = settings_.ompl_defaults ? 0.0 : kTunedDeviation;
  if (auto valid = valid_sampler_allocator(task_.valid_states, deviation)) {
    information_->setValidStateSamplerAllocator(valid);
  }
}

void OmplRun::define_problem() {
  definition_ = std::make_shared<ob::ProblemDefinition>(information_);
  definition_->addStartState(to_state(information_, robot_.normalized(task_.query.start)).get());
  const auto goals = std::make_shared<ob::GoalStates>(information_);
  for (const Configuration& goal : task_.query.goals) {
    goals->addState(to_state(information_, robot_.normalized(goal)).get());
  }
  definition_->setGoal(goals);
  const auto objective = make_path_length_objective(information_);
  // Makes optimizing planners stop at their first path.
  objective->setCostThreshold(objective->infiniteCost());
  definition_->setOptimizationObjective(objective);
}

ob::PlannerTerminationCondition OmplRun::limits() const {
  return ob::PlannerTerminationCondition([this] {
    const auto most = settings_.max_iterations;
    if (most && counters_->samples.load(std::memory_order_relaxed) >= *most) return true;
    if (is_full()) was_full_ = true;
    return was_full_ || is_over();
  });
}

bool OmplRun::is_over() const {
  const std::atomic<bool>* cancel = settings_.cancel;
  return (cancel != nullptr && cancel->load(std::memory_order_relaxed)) ||
         stopwatch_.elapsed_s() >= settings_.timeout_s;
}

bool OmplRun::is_full() const {
  const auto& space = *information_->getStateSpace()->as<JointStateSpace>();
  return space.state_count() >= settings_.max_nodes;
}

Result<ob::PlannerPtr> OmplRun::make_planner() const {
  const double range = settings_.range.value_or(settings_.ompl_defaults ? 0.0 : kTunedRange);
  if (planner_.make == nullptr) {
    return make_experience_planner(planner_.name, information_, settings_.experience_path, range);
  }
  const ob::PlannerPtr planner = planner_.make(information_);
  set_range(*planner, range);
  return planner;
}

Result<PlanResult> OmplRun::plan() {
  const auto made = MNEME_TRY(make_planner());
  const ob::PlannerPtr& planner = made;
  planner->setProblemDefinition(definition_);
  // One limit per attempt, because parallel planners end their limit when they have a path.
  for (auto limit = limits(); !limit; limit = limits()) {
    planner->solve(limit);
    if (!definition_->hasExactSolution()) break;
    Path path = solution();
    if (is_accepted(path)) {
      result_.status = PlanStatus::solved;
      result_.path = std::move(path);
      break;
    }
    planner->clear();
    definition_->clearSolutionPaths();
    information_->setMotionValidator(make_verified_motion_validity(
        information_, task_.checker, counters_, task_.shorten_and_verify.verifier()));
    information_->setup();
  }
  if (!result_.is_solved()) explain_failure();
  result_.iterations = counters_->samples.load();
  result_.states_checked = counters_->states.load() + checks_.states;
  result_.motions_checked = counters_->motions.load() + checks_.motions;
  result_.simplification_time_s = task_.shorten_and_verify.simplification_time_s();
  result_.verification_time_s = task_.shorten_and_verify.verification_time_s();
  result_.planning_time_s =
      stopwatch_.elapsed_s() - result_.simplification_time_s - result_.verification_time_s;
  return std::move(result_);
}

/// With OMPL's defaults a path in contact is returned unchanged: shortcuts might remove the motion
/// through an obstacle and hide the planner's error.
bool OmplRun::is_accepted(Path& path) {
  // The number of motions in planning limits the cost of shortening.
  const std::uint64_t motions = counters_->motions.load();
  CheckCounters work{0, motions};
  const bool is_taken = task_.shorten_and_verify(path, work) < 0;
  checks_.states += work.states;
  checks_.motions += work.motions - motions;
  return is_taken || settings_.ompl_defaults;
}

/// The path with exactly the query's ends, which OMPL has rounded and wrapped.
Path OmplRun::solution() const {
  const auto& states =
      dynamic_cast<const ::ompl::geometric::PathGeometric&>(*definition_->getSolutionPath());
  Path path = from_ompl(states, robot_);
  path.front() = robot_.normalized(task_.query.start);
  const auto goal =
      std::min_element(task_.query.goals.begin(), task_.query.goals.end(),
                       [&](const Configuration& a, const Configuration& b) {
                         return robot_.distance(path.back(), a) < robot_.distance(path.back(), b);
                       });
  path.back() = robot_.normalized(*goal);
  return path;
}

void OmplRun::explain_failure() {
  const auto most = settings_.max_iterations;
  if (settings_.cancel != nullptr && settings_.cancel->load()) {
    result_.status = PlanStatus::cancelled;
    result_.message = "cancelled";
  } else if (most && counters_->samples.load() >= *most) {
    result_.status = PlanStatus::iteration_limit;
    result_.message = "no path within " + std::to_string(*most) + " iterations";
  } else if (was_full_) {
    result_.status = PlanStatus::node_limit;
    result_.message = "no path within " + std::to_string(settings_.max_nodes) + " nodes";
  } else {
    result_.status = PlanStatus::timeout;
    result_.message = stopwatch_.elapsed_s() >= settings_.timeout_s
                          ? "no path within the time limit"
                          : "the planner gave up before the time limit";
  }
  result_.message += task_.shorten_and_verify.describe_refused();
}

std::mutex silence_mutex;
int silence_count = 0;
::ompl::msg::OutputHandler* previous_handler = nullptr;

}  // namespace

Silence::Silence() {
  const std::lock_guard lock(silence_mutex);
  if (silence_count++ > 0) return;
  previous_handler = ::ompl::msg::getOutputHandler();
  ::ompl::msg::noOutputHandler();
}

Silence::~Silence() {
  const std::lock_guard lock(silence_mutex);
  if (--silence_count == 0) ::ompl::msg::useOutputHandler(previous_handler);
}

Result<PlanResult> run(const OmplPlanner& planner, const PlanTask& task) {
  const Silence silence;
  try {
    // OMPL has one sequence of seeds per process; 0 is not allowed.
    const std::uint64_t seed = derive_seed(task.settings.seed, 0) % 0xFFFFFFFEu + 1;
    ::ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
    return OmplRun(planner, task).plan();
  } catch (const std::exception& error) {
    return fail(ErrorCode::unsupported,
                "OMPL's " + std::string(planner.name) + ": " + error.what());
  }
}

}  // namespace mneme::ompl
