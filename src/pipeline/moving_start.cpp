// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/moving_start.h"

#include "path/waypoints.h"
#include "replay/proven_motions.h"

#include <fmt/format.h>

#include <utility>

namespace mneme::internal {
namespace {

SolveResult refused(const SolveSettings& settings, std::string message) {
  SolveResult result;
  result.plan.status = PlanStatus::invalid_start;
  result.plan.message = std::move(message);
  result.planner = settings.planner;
  result.sampler = settings.sampler;
  result.seed = settings.plan.seed;
  result.isa = settings.isa == Isa::automatic ? default_isa() : settings.isa;
  return result;
}

/// Says what the stop touches first; without contact at any state it is too near.
std::string describe_blocked(const CollisionChecker& checker, const Configuration& start,
                             const Configuration& stop) {
  constexpr int kStates = 64;
  const std::string length =
      fmt::format("{:.3g} (L2 joint distance)", checker.robot().distance(start, stop));
  for (int i = 0; i <= kStates; ++i) {
    Configuration q = start;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += (stop[j] - start[j]) * i / kStates;
    const std::vector<Contact> contacts = checker.contacts(checker.robot().normalized(q));
    if (contacts.empty()) continue;
    return fmt::format(
        "start velocity: the robot cannot stop in time: its straight stop takes {}, and after "
        "{:.0f} "
        "% of it '{}' touches '{}'",
        length, 100.0 * i / kStates, contacts.front().link, contacts.front().other);
  }
  return fmt::format(
      "start velocity: the straight stop, which takes {}, is not proven free of contact", length);
}

/// Empty if the motion from the start to `stop` is proven free.
Result<std::string> find_fault(const Problem& problem, const SolveSettings& settings,
                               const Configuration& stop) {
  const CheckerSettings checked{settings.resolution, settings.margin, settings.isa,
                                problem.constraints};
  const QueryChecker made =
      MNEME_TRY(query_checker_of(problem.robot, problem.scene, checked, {problem.start, {stop}}));
  const auto to_row = [&](const Configuration& q) {
    return to_floats(problem.robot.normalized(q));
  };
  CheckCounters counters;
  const MotionVerifier verifier(made.checker, settings.plan.verification());
  const bool is_free =
      verifier.is_free(to_row(problem.start), to_row(stop), {true, false}, counters);
  return is_free ? std::string() : describe_blocked(made.checker, problem.start, stop);
}

}  // namespace

Result<SolveResult> solve_moving(
    const Problem& problem, const SolveSettings& settings,
    const std::function<Result<SolveResult>(const Problem&)>& solve_at_rest) {
  if (auto violation = problem.robot.describe_violation(problem.start, "start")) {
    return refused(settings, *std::move(violation));
  }
  const RateLimits limits = settings.plan.limits != nullptr
                                ? *settings.plan.limits
                                : MNEME_TRY(find_rate_limits(problem.robot));
  auto stop = stopping_point(problem.robot, problem.start, problem.start_velocity, limits);
  if (!stop) return refused(settings, stop.error().message);
  std::string fault = MNEME_TRY(find_fault(problem, settings, *stop));
  if (!fault.empty()) return refused(settings, std::move(fault));
  Problem resting = problem;
  resting.start = problem.robot.normalized(*stop);
  resting.start_velocity.clear();
  if (*stop == problem.start) return solve_at_rest(resting);
  SolveResult result = MNEME_TRY(solve_at_rest(resting));
  Path& path = result.plan.path;
  if (!path.empty()) path.insert(path.begin(), problem.start);
  path = unwrapped(problem.robot, std::move(path), problem.start);
  return result;
}

}  // namespace mneme::internal
