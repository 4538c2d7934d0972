// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/given_ends.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "path/waypoints.h"
#include "pipeline/end_exit.h"
#include "planning/end_contacts.h"
#include "robot/joint_space.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

namespace mneme::internal {
namespace {

/// Metres that a link is moved out of contact, as shares of the stretch.
constexpr std::array<double, 5> kShares = {0.24, 0.34, 0.48, 0.66, 0.88};
constexpr double kDefaultStretch = 0.005;
/// Standard deviations of samples around an end, radians, and their number.
constexpr std::array<double, 4> kSigmas = {0.002, 0.005, 0.01, 0.02};
constexpr int kSamples = 16;
/// States of the motion to an end.
constexpr int kEndStates = 64;
constexpr std::uint64_t kEndsTask = std::uint64_t{1} << 60;

class EndMover {
 public:
  EndMover(const Query& query, const CollisionChecker& checker)
      : query_(query),
        checker_(checker),
        robot_(checker.robot()),
        tolerances_(end_tolerances(query.settings)),
        rng_(derive_seed(query.settings.plan.seed, kEndsTask)) {}

  /// Returns a configuration that replaces `given`, or nothing. Adds notes about the limits, cones
  /// and distances that `given` does not keep; they call it `name`.
  std::optional<Configuration> find_inside(PathEnd end, const Configuration& given,
                                           const std::string& name,
                                           std::vector<std::string>& notes) {
    is_start_ = end == PathEnd::start;
    exit_.emplace(checker_, tolerances_, end, kEndStates);
    const bool is_out = !robot_.is_configuration(given);
    if (is_out && !(is_start_ && is_near_limits(robot_, given, tolerances_))) return std::nullopt;
    std::optional<Configuration> nearest = keep_limits_and_cones(given);
    if (!nearest) return std::nullopt;
    const std::vector<Touch> touches = exit_->find_touches(given, kSolidClearance);
    if (!exit_->may_leave(touches)) return std::nullopt;
    if (*nearest == given && touches.empty()) return std::nullopt;
    std::optional<Configuration> inside = find_free(given, *nearest);
    if (inside) describe(given, touches, name, notes);
    return inside;
  }

  /// Why find_inside() has found nothing for a start that the tolerances allow. Empty for other
  /// starts: what refuse_query() says of them is the reason.
  [[nodiscard]] std::string describe_failure(const Configuration& start) {
    const auto is_far_beyond = [&](const OrientationConstraint& constraint) {
      return tilt(robot_, constraint, start) > constraint.angle + tolerances_.angle;
    };
    if (!is_near_limits(robot_, start, tolerances_) ||
        std::ranges::any_of(checker_.constraints(), is_far_beyond)) {
      return {};
    }
    const std::optional<Configuration> nearest = keep_limits_and_cones(start);
    if (!nearest) return {};
    const auto refused = refuse_query(checker_, {*nearest, {*nearest}});
    if (*nearest == start) {
      const std::vector<Touch> touches = exit_->find_touches(start, kSolidClearance);
      if (!refused || touches.empty() || !exit_->may_leave(touches)) return {};
      return refused->message +
             ". A path may begin in this contact, but no straight motion of the joints leaves it";
    }
    std::string fault = refused ? refused->message : "start: no straight motion leads it inside";
    if (!refused) {
      for (const Touch& touch : exit_->find_touches(start, kSolidClearance)) {
        fault += "; " + exit_->describe(touch);
      }
    }
    return fmt::format("{} ({}, which start-tolerance allows)", fault,
                       fmt::join(describe_excess(start), ", "));
  }

 private:
  /// The start within limits and cones; a goal as it is. Nothing if a cone is too far away.
  [[nodiscard]] std::optional<Configuration> keep_limits_and_cones(
      const Configuration& given) const {
    if (!is_start_) return given;
    Configuration q = given;
    for (const LimitExcess& beyond : find_excess(robot_, given)) {
      const Joint& joint = robot_.group_joint(beyond.joint);
      double& value = q[as_index(beyond.joint)];
      value = std::clamp(value, joint.lower, joint.upper);
    }
    std::vector<float> projected = to_floats(q);
    if (!checker_.project(projected)) return std::nullopt;
    if (projected == to_floats(q)) return q;
    return robot_.normalized(Configuration(projected.begin(), projected.end()));
  }

  std::optional<Configuration> find_free(const Configuration& given, const Configuration& nearest) {
    if (is_inside(given, nearest)) return nearest;
    for (const double share : kShares) {
      poll_interrupt();
      const auto moved = move_out(nearest, share * stretch());
      if (moved && is_inside(given, *moved)) return moved;
    }
    for (const double sigma : kSigmas) {
      const std::vector<float> sigmas = joint_deviations(robot_, sigma);
      for (int i = 0; i < kSamples; ++i) {
        Configuration q = nearest;
        for (std::size_t j = 0; j < q.size(); ++j) q[j] += double{sigmas[j] * rng_.bell()};
        if (is_inside(given, robot_.normalized(q))) return robot_.normalized(q);
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] double stretch() const {
    const double longest = exit_->motions().longest_stretch();
    return longest > 0 ? longest : kDefaultStretch;
  }

  /// True if `q` keeps all limits, cones and distances, and the straight motion from `given` to `q`
  /// passes.
  [[nodiscard]] bool is_inside(const Configuration& given, const Configuration& q) const {
    if (!robot_.is_configuration(q) || !is_clear_by_exact_geometry(checker_, q)) return false;
    const auto keeps = [&](const OrientationConstraint& constraint) {
      return tilt(robot_, constraint, q) <= constraint.angle - kTiltMargin &&
             keeps_cone(robot_, constraint, {given, q}, checker_.resolution(), tolerances_);
    };
    return std::ranges::all_of(checker_.constraints(), keeps) && exit_->is_left_by(given, q);
  }

  /// A configuration that moves the link in contact by `length` metres away from what it touches.
  [[nodiscard]] std::optional<Configuration> move_out(const Configuration& q, double length) const {
    const std::vector<Touch> touches = exit_->motions().touching(q, kSolidClearance);
    if (touches.empty()) return std::nullopt;
    // Children have higher indices than their parents, attached objects the highest.
    const auto outer = [](const Touch& touch) {
      return touch.is_self ? std::max(touch.link, touch.other) : touch.link;
    };
    const int link = outer(std::ranges::max(touches, {}, outer));
    Vec3 direction = Vec3::Zero();
    for (const Touch& touch : touches) {
      if (touch.link == link) direction += exit_->motions().direction_out(q, touch);
      if (touch.is_self && touch.other == link) {
        direction +=
            exit_->motions().direction_out(q, {touch.other, touch.link, true, touch.distance});
      }
    }
    if (direction.norm() == 0) return std::nullopt;
    PoseGoal goal;
    goal.link = robot_.links()[as_index(link)].name;
    goal.pose = robot_.link_poses(q)[as_index(link)];
    goal.pose.translation += length * direction.normalized();
    return reach(goal, q);
  }

  [[nodiscard]] std::optional<Configuration> reach(PoseGoal goal, const Configuration& near) const {
    constexpr int kSeeds = 16;
    for (const double freedom : {0.0, std::numbers::pi}) {
      goal.cone = goal.turn = freedom;
      if (auto q = exit_->reach(goal, near, kSeeds)) return q;
    }
    return std::nullopt;
  }

  /// The limits and cones that `given` does not keep.
  [[nodiscard]] std::vector<std::string> describe_excess(const Configuration& given) const {
    std::vector<std::string> found;
    for (const LimitExcess& beyond : find_excess(robot_, given)) {
      const Joint& joint = robot_.group_joint(beyond.joint);
      found.push_back(fmt::format("joint '{}' is {:.2g} {} beyond its limit", joint.name,
                                  beyond.excess, joint.type == JointType::prismatic ? "m" : "rad"));
    }
    for (const OrientationConstraint& constraint : checker_.constraints()) {
      const double excess = tilt(robot_, constraint, given) - constraint.angle;
      if (excess <= 0) continue;
      found.push_back(
          fmt::format("{} is tilted by {:.2g} rad beyond its cone", constraint.link, excess));
    }
    return found;
  }

  void describe(const Configuration& given, const std::vector<Touch>& touches,
                const std::string& name, std::vector<std::string>& notes) const {
    for (const std::string& excess : describe_excess(given)) {
      notes.push_back(fmt::format("{}: {}; the first motion leads it inside", name, excess));
    }
    for (const Touch& touch : touches) {
      notes.push_back(
          fmt::format("{}: {}; the {}", name, exit_->describe(touch),
                      is_start_ ? "first motion leads away" : "last motion leads there"));
    }
  }

  const Query& query_;
  const CollisionChecker& checker_;
  const Robot& robot_;
  EndTolerances tolerances_;
  std::optional<EndExit> exit_;  ///< of the end that is moved
  Rng rng_;
  bool is_start_ = true;
};

}  // namespace

std::vector<std::string> GivenEnds::names(const PlanQuery& ends) const {
  std::vector<std::string> names = {start ? "after the first motion" : "start"};
  for (const Configuration& q : ends.goals) {
    const bool is_given = std::ranges::find(goals, q, &Goal::inside) == goals.end();
    names.emplace_back(is_given ? "goal" : "before the last motion");
  }
  return names;
}

Path GivenEnds::completed(const Robot& robot, Path path) const {
  if (path.empty()) return path;
  const auto reached = std::ranges::find_if(
      goals, [&](const Goal& goal) { return is_same_end(robot, goal.inside, path.back()); });
  if (start) path.insert(path.begin(), *start);
  if (reached != goals.end()) path.push_back(reached->given);
  return path;
}

GivenEnds move_ends_inside(const Query& query, const CollisionChecker& checker, PlanQuery& ends,
                           std::size_t first) {
  GivenEnds given;
  EndMover mover(query, checker);
  if (auto inside = mover.find_inside(PathEnd::start, ends.start, "start", given.notes)) {
    given.start = std::exchange(ends.start, *std::move(inside));
  } else {
    given.start_failure = mover.describe_failure(ends.start);
  }
  // The search has half of the time, at least, unless the first goal takes longer.
  const double least_left_s = 0.5 * query.settings.plan.timeout_s;
  for (std::size_t i = 0; i < ends.goals.size(); ++i) {
    poll_interrupt();
    if (i > 0 && query.remaining_s() < least_left_s) break;
    const bool is_only = query.problem.goals.size() <= 1 && ends.goals.size() == 1;
    const std::string name = is_only ? "goal" : fmt::format("goal {}", first + i + 1);
    if (auto inside = mover.find_inside(PathEnd::goal, ends.goals[i], name, given.notes)) {
      given.goals.push_back({*inside, std::exchange(ends.goals[i], *inside)});
    }
  }
  return given;
}

}  // namespace mneme::internal
