// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/end_exit.h"

#include "mneme/planning.h"

#include "base/as_index.h"
#include "path/waypoints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mneme::internal {

std::vector<Touch> EndExit::find_touches(const Configuration& q, double clearance) {
  const std::vector<Touch> spheres = motions_.touching(q);
  motions_.check_exactly(spheres);
  std::vector<Touch> touches = motions_.touching(q, clearance);
  std::erase_if(touches,
                [&](const Touch& touch) { return find_same_pair(spheres, touch) == nullptr; });
  return touches;
}

bool EndExit::may_leave(const std::vector<Touch>& touches) const {
  return std::ranges::all_of(
      touches, [&](const Touch& touch) { return motions_.may_leave(touch, is_start_); });
}

std::optional<Configuration> EndExit::reach(const PoseGoal& goal, const Configuration& near,
                                            int seeds) const {
  constexpr double kFarthest = 0.3;  // radians: another posture
  const auto kinematics = InverseKinematics::make(checker_.robot(), goal.link, checker_.isa());
  if (!kinematics) return std::nullopt;
  IkSettings settings;
  settings.seeds = seeds;
  settings.position_tolerance = 1e-5;
  settings.rotation_tolerance = 1e-4;
  const IkResult reached = kinematics->solve(goal, near, settings);
  if (reached.solutions.empty()) return std::nullopt;
  const Configuration& q = reached.solutions.front();
  if (checker_.robot().distance(near, q) >= kFarthest) return std::nullopt;
  return q;
}

/// Metres that links move at most between a state of the motion and the nearest checked one.
double EndExit::room_between(const Configuration& from, const Configuration& to, int states) const {
  const Robot& robot = checker_.robot();
  std::vector<float> delta = to_floats(robot.difference(from, to));
  for (float& value : delta) value = std::abs(value) / static_cast<float>(2 * states);
  return checker_.displacement_bound(to_floats(robot, from), to_floats(robot, to), delta);
}

bool EndExit::is_left_by(const Configuration& end, const Configuration& inside) const {
  const auto passes = [&](int states, double extra) {
    return motions_.is_left_by(end, inside, is_start_, states, extra);
  };
  const int many = 16 * states_;
  return passes(states_, room_between(end, inside, states_)) ||
         (passes(states_, 0) && passes(many, room_between(end, inside, many)));
}

std::string EndExit::describe(const Touch& touch) const {
  const auto links = checker_.robot().links();
  const std::string& other = touch.is_self ? links[as_index(touch.other)].name
                                           : checker_.scene().obstacles[as_index(touch.other)].name;
  const double distance = touch.distance + (touch.is_self ? 0 : checker_.margin());
  return fmt::format(
      "'{}' {} {} '{}'", links[as_index(touch.link)].name,
      touch.distance > 0 ? fmt::format("is {:.2g} mm from", 1e3 * distance) : "touches",
      touch.is_self ? "link" : "obstacle", other);
}

}  // namespace mneme::internal
