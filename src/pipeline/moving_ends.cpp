// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/moving_ends.h"

#include "base/fail.h"
#include "base/threads.h"
#include "check/end_motions.h"
#include "path/waypoints.h"
#include "pipeline/query.h"
#include "replay/proven_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

/// A straight motion between rest and a given velocity.
struct EndMotion {
  Configuration from, to;
  bool is_stop = true;  ///< at the start of the path; otherwise a run-up to its end
};

/// Says what the motion touches first; without contact at any state it is too near.
std::string describe_blocked(const CollisionChecker& checker, const EndMotion& motion) {
  constexpr int kStates = 64;
  const auto& [from, to, is_stop] = motion;
  const std::string takes =
      fmt::format("{} takes {:.3g} (L2 joint distance), ",
                  is_stop ? "start velocity: the robot cannot stop in time: its straight stop"
                          : "end velocity: the straight run-up",
                  checker.robot().distance(from, to));
  for (int i = 0; i <= kStates; ++i) {
    Configuration q = from;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += (to[j] - from[j]) * i / kStates;
    const std::vector<Contact> contacts = checker.contacts(checker.robot().normalized(q));
    if (contacts.empty()) continue;
    return fmt::format("{}and after {:.0f} % of it '{}' touches '{}'", takes, 100.0 * i / kStates,
                       contacts.front().link, contacts.front().other);
  }
  return takes + "which is not proven free of contact";
}

/// Empty if the motion is proven free.
Result<std::string> find_fault(const Problem& problem, const SolveSettings& settings,
                               const EndMotion& motion) {
  const QueryChecker made = MNEME_TRY(query_checker_of(
      problem.robot, problem.scene, checker_settings_of(settings, problem.constraints),
      {motion.from, {motion.to}}));
  CheckCounters counters;
  const MotionVerifier verifier(made.checker, settings.plan.verification());
  const bool is_free =
      verifier.is_free(to_floats(problem.robot, motion.from), to_floats(problem.robot, motion.to),
                       {motion.is_stop, !motion.is_stop}, counters);
  return is_free ? std::string() : describe_blocked(made.checker, motion);
}

/// Where the robot stops, or begins its run-up.
struct Rest {
  Configuration q;
  std::string fault;  ///< why that is impossible; empty if it is not
};

Result<Rest> find_rest(const Problem& problem, const SolveSettings& settings,
                       const RateLimits& limits, const Configuration& end, bool is_start) {
  const Robot& robot = problem.robot;
  if (auto violation = robot.describe_violation(end, is_start ? "start" : "goal")) {
    if (is_start && is_near_limits(robot, end, end_tolerances(settings))) {
      *violation +=
          "; start-tolerance does not apply to a start with a velocity, because the robot cannot "
          "stop inside the limits";
    }
    return Rest{end, *std::move(violation)};
  }
  const auto rest = is_start ? stopping_point(robot, end, problem.start_velocity, limits)
                             : run_up_point(robot, end, problem.end_velocity, limits);
  if (!rest) return Rest{end, rest.error().message};
  if (*rest == end) return Rest{end, ""};
  const EndMotion motion = is_start ? EndMotion{end, *rest, true} : EndMotion{*rest, end, false};
  return Rest{robot.normalized(*rest), MNEME_TRY(find_fault(problem, settings, motion))};
}

/// A goal and where the run-up to it begins.
struct RunUp {
  Configuration from, goal;
};

/// The run-ups of a problem. Without an end velocity there are none and no fault.
struct RunUps {
  std::vector<RunUp> free;
  std::string fault;               ///< of the last goal, if no run-up is free
  std::vector<std::string> notes;  ///< about goals that are ignored
  double used_s = 0;               ///< of the time limit
};

/// Ends once half of the time limit is over, or the call is cancelled.
Result<RunUps> find_run_ups(const Problem& problem, const SolveSettings& settings,
                            const RateLimits& limits) {
  RunUps run_ups;
  if (problem.end_velocity.empty()) return run_ups;
  if (!problem.pose_goals.empty()) {
    return fail(ErrorCode::invalid,
                "end velocity: expected configurations as goals, got a pose; inverse kinematics "
                "finds configurations for it");
  }
  constexpr double kShare = 0.5;
  constexpr std::ptrdiff_t kMostNoted = 64;
  std::optional<Stopwatch> stopwatch;  // the first goal also prepares the scene
  for (const Configuration& goal : problem.goals) {
    const auto number = &goal - problem.goals.data() + 1;
    if (is_set(settings.plan.cancel)) break;
    if (stopwatch && stopwatch->elapsed_s() >= kShare * settings.plan.timeout_s) {
      run_ups.notes.push_back(fmt::format(
          "the goals from goal {} on are ignored: half of the time limit was over before their "
          "run-ups were checked",
          number));
      break;
    }
    Rest rest = MNEME_TRY(find_rest(problem, settings, limits, goal, false));
    run_ups.fault = std::move(rest.fault);
    if (run_ups.fault.empty()) {
      run_ups.free.push_back({std::move(rest.q), goal});
    } else if (number <= kMostNoted) {
      run_ups.notes.push_back(fmt::format("goal {} is ignored: {}", number, run_ups.fault));
    }
    if (!stopwatch) stopwatch.emplace();
  }
  if (stopwatch) run_ups.used_s = stopwatch->elapsed_s();
  if (!run_ups.free.empty()) run_ups.fault.clear();
  return run_ups;
}

/// Adds the run-up that begins at the end of the path.
void add_run_up(const Robot& robot, const std::vector<RunUp>& run_ups, SolveResult& result) {
  const auto run_up_from = [&](const Configuration& q) -> const RunUp& {
    return *std::ranges::min_element(
        run_ups, {}, [&](const RunUp& run_up) { return robot.distance(run_up.from, q); });
  };
  // Goals are in the order of their run-ups, unless they were found near them.
  auto next = run_ups.begin();
  for (Configuration& goal : result.goals) {
    const auto same =
        std::find_if(next, run_ups.end(), [&](const RunUp& run_up) { return run_up.from == goal; });
    if (same != run_ups.end()) next = same + 1;
    goal = same != run_ups.end() ? same->goal : run_up_from(goal).goal;
  }
  Path& path = result.plan.path;
  if (path.empty()) return;
  const RunUp& last = run_up_from(robot.normalized(path.back()));
  if (last.from != last.goal) path.push_back(last.goal);
}

/// Where a moving robot is at rest.
struct RestingEnds {
  Rest start;
  RunUps run_ups;
};

/// Stops at the first fault.
Result<RestingEnds> find_resting_ends(const Problem& problem, const SolveSettings& settings,
                                      const RateLimits& limits) {
  RestingEnds ends{.start = {problem.start, ""}, .run_ups = {}};
  if (!problem.start_velocity.empty()) {
    ends.start = MNEME_TRY(find_rest(problem, settings, limits, problem.start, true));
  }
  if (ends.start.fault.empty()) {
    ends.run_ups = MNEME_TRY(find_run_ups(problem, settings, limits));
  }
  return ends;
}

/// The problem between its resting ends.
Problem between(const RestingEnds& ends, const Problem& problem) {
  Problem resting = problem;
  resting.start_velocity.clear();
  resting.end_velocity.clear();
  resting.start = ends.start.q;
  if (!ends.run_ups.free.empty()) resting.goals.clear();
  for (const RunUp& run_up : ends.run_ups.free) resting.goals.push_back(run_up.from);
  return resting;
}

}  // namespace

SolveResult unplanned(const SolveSettings& settings, PlanStatus status, std::string message,
                      double preparation_s) {
  SolveResult result;
  result.plan.status = status;
  result.plan.message = std::move(message);
  result.planner = settings.planner;
  result.sampler = settings.sampler;
  result.seed = settings.plan.seed;
  result.isa = resolve_isa(settings.isa);
  result.preparation_time_s = result.total_time_s = preparation_s;
  return result;
}

Result<SolveResult> solve_moving(
    const Problem& problem, const SolveSettings& settings,
    const std::function<Result<SolveResult>(const Problem&, const SolveSettings&)>& solve_at_rest) {
  const Stopwatch stopwatch;
  const RateLimits limits = settings.plan.limits != nullptr
                                ? *settings.plan.limits
                                : MNEME_TRY(find_rate_limits(problem.robot));
  auto found = unless_cancelled(settings.plan.cancel,
                                [&] { return find_resting_ends(problem, settings, limits); });
  if (found && !*found) return tl::unexpected(found->error());
  const auto refused = [&](PlanStatus status, std::string message) {
    return unplanned(settings, status, std::move(message), stopwatch.elapsed_s());
  };
  if (!found || is_set(settings.plan.cancel)) return refused(PlanStatus::cancelled, "cancelled");
  auto& [start, run_ups] = **found;
  if (!start.fault.empty()) return refused(PlanStatus::invalid_start, std::move(start.fault));
  if (!run_ups.fault.empty()) return refused(PlanStatus::invalid_goal, std::move(run_ups.fault));
  SolveSettings rest = settings;
  rest.plan.timeout_s = std::max(0.0, settings.plan.timeout_s - run_ups.used_s);
  const double ends_s = stopwatch.elapsed_s();
  SolveResult result = MNEME_TRY(solve_at_rest(between(**found, problem), rest));
  result.total_time_s += ends_s;
  result.planning_time_s += run_ups.used_s;
  result.preparation_time_s += ends_s - run_ups.used_s;
  std::ranges::move(run_ups.notes, std::back_inserter(result.notes));
  if (!run_ups.free.empty()) add_run_up(problem.robot, run_ups.free, result);
  Path& path = result.plan.path;
  if (!path.empty() && start.q != problem.start) path.insert(path.begin(), problem.start);
  path = unwrapped(problem.robot, std::move(path), problem.start);
  return result;
}

}  // namespace mneme::internal
