// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/follow.h"

#include "mneme/goal.h"
#include "mneme/line.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "check/cones.h"
#include "line/floating_body.h"
#include "pipeline/end_exit.h"
#include "planning/end_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

/// Lengths of the motion out of contact, as shares of what allow-at-ends allows.
constexpr std::array<double, 3> kShares = {0.4, 0.66, 0.88};

/// The world in which the robot is clear at `q`: the given one, or one with pairs checked exactly
/// whose spheres alone touch there. Null if there is none.
CheckedWorldPtr find_clear_world(const TaskRun& run, const CheckedWorldPtr& world,
                                 const Configuration& q) {
  if (is_clear(world->checker, q)) return world;
  const auto made = make_end_checker(world->checker, run.checker_settings(), q, kLineClearance);
  if (!made || made->notes.empty()) return nullptr;
  return std::make_shared<const CheckedWorld>(CheckedWorld{world->world, made->checker});
}

}  // namespace

bool TaskRun::may_touch_at_ends(const World& world) const {
  return !world.scene.end_contacts.empty() ||
         (settings.solve.allow_at_ends > 0 && !world.robot.attached().empty());
}
bool TaskRun::is_cancelled() const { return is_set(settings.solve.plan.cancel); }
bool TaskRun::is_over() const { return is_cancelled() || remaining_s() <= 0; }
double TaskRun::remaining_s() const { return std::max(0.0, end_s - stopwatch.elapsed_s()); }

Result<CheckedWorldPtr> check_world(World world, const TaskRun& run) {
  auto checker =
      MNEME_TRY(CollisionChecker::make(world.robot, world.scene, run.checker_settings()));
  return std::make_shared<const CheckedWorld>(CheckedWorld{std::move(world), std::move(checker)});
}

Result<CheckedWorldPtr> check_unless_cancelled(World world, const TaskRun& run) {
  auto made = unless_cancelled(run.settings.solve.plan.cancel, [&] {
    prepare_shapes_of(run.task, run.checker_settings().margin);
    return check_world(std::move(world), run);
  });
  return made ? *std::move(made) : nullptr;
}

std::string describe_contact(const CollisionChecker& checker, const Configuration& q) {
  const std::vector<Contact> contacts = checker.contacts(checker.robot().normalized(q));
  return contacts.empty() ? "something within 0.1 mm" : describe_deepest(contacts);
}

namespace {

/// States of a motion out of contact.
constexpr int kExitStates = 16;

EndExit make_exit(const TaskRun& run, const CollisionChecker& checker, PathEnd end) {
  return {checker, end_tolerances(run.settings.solve), end, kExitStates};
}

/// The configuration that is the given share of the stretch farther.
std::optional<Configuration> find_inside(TaskRun& run, const CollisionChecker& checker,
                                         const EndExit& exit, const LineTask& line, double share) {
  const Robot& robot = checker.robot();
  PoseGoal goal;
  goal.link = line.link;
  goal.pose = robot.link_poses(line.q)[as_index(*robot.find_link(line.link))];
  const Vec3 way = line.X_WL.translation - goal.pose.translation;
  if (way.norm() == 0) return std::nullopt;
  const double length = share * std::min(exit.motions().longest_stretch(), way.norm());
  goal.pose.translation += length * way.normalized();
  auto inside = exit.reach(goal, line.q, 1);
  ++run.states;
  if (!inside || !robot.is_configuration(*inside)) return std::nullopt;
  return inside;
}

/// Returns the pair that is nearest at the end of a line. Of a pair that is apart, also what a line
/// needs, and the way out.
std::string describe_nearest(const CollisionChecker& checker, const Configuration& q) {
  const Robot& robot = checker.robot();
  const Configuration inside = robot.normalized(q);
  std::vector<Contact> contacts = checker.contacts(inside);
  for (Contact& contact : contacts) {
    const auto behind = find_exact_contact(robot, checker.scene(), inside, contact);
    if (behind) contact.distance = behind->distance - (contact.is_self ? 0 : checker.margin());
  }
  const auto nearest = std::ranges::min_element(contacts, {}, &Contact::distance);
  if (nearest == contacts.end() || nearest->distance <= 0) return describe_contact(checker, q);
  return fmt::format(
      "'{}' with '{}', {:.2g} mm apart: a line needs {:.2g} mm, or a stage `allow` with both",
      nearest->link, nearest->other, 1e3 * nearest->distance, 1e3 * kLineClearance);
}

tl::expected<Path, Failure> plan_rest(TaskRun& run, const CollisionChecker& checker,
                                      const LineTask& line, const Configuration& from) {
  Line straight;
  straight.link = line.link;
  straight.target = line.X_WL;
  LineSettings settings;
  settings.timeout_s = std::max(1e-6, run.remaining_s());
  settings.cancel = run.settings.solve.plan.cancel;
  settings.seed = run.settings.solve.plan.seed;
  settings.line_steps = run.line_steps();
  settings.has_reason = line.has_reason;
  auto found = plan_line(checker, straight, from, settings);
  if (!found) return tl::unexpected(Failure{DropReason::line, found.error().message});
  run.states += found->checks.states;
  if (!found->is_whole()) {
    run.has_tried = true;
    return tl::unexpected(Failure{DropReason::line, found->reason});
  }
  return std::move(found->line.path);
}

/// A line whose end `q` is in contact.
tl::expected<FollowedLine, Failure> follow_out_of_contact(TaskRun& run,
                                                          const CheckedWorldPtr& world,
                                                          const LineTask& line) {
  Failure failure{DropReason::contact, {}};
  EndExit exit = make_exit(run, world->checker, line.is_start ? PathEnd::start : PathEnd::goal);
  const bool may_touch = run.may_touch_at_ends(world->world);
  const std::vector<Touch> touches =
      may_touch ? exit.find_touches(line.q, kLineClearance) : std::vector<Touch>();
  if (may_touch && exit.may_leave(touches)) {
    for (const double share : kShares) {
      const auto inside = find_inside(run, world->checker, exit, line, share);
      const CheckedWorldPtr exact = inside ? find_clear_world(run, world, *inside) : nullptr;
      if (!exact) continue;
      auto rest = plan_rest(run, exact->checker, line, *inside);
      if (!rest) return tl::unexpected(rest.error());
      // Exact distances cost more than the rest of the line.
      run.states += kExitStates;
      if (!exit.is_left_by(line.q, *inside)) continue;
      rest->insert(rest->begin(), line.q);
      FollowedLine followed{exact, *std::move(rest), {}};
      for (const Touch& touch : touches) {
        if (touch.distance <= 0) followed.touches.push_back(exit.describe(touch));
      }
      return followed;
    }
  }
  if (line.has_reason) failure.what = describe_nearest(world->checker, line.q);
  return tl::unexpected(std::move(failure));
}

/// Why the path leaves a cone of the task; nothing if it keeps all.
std::optional<Failure> find_tilt(const Task& task, const Robot& robot, const Path& path) {
  for (const OrientationConstraint& constraint : task.constraints) {
    const Cones cones(robot, {&constraint, 1});
    for (std::size_t i = 1; i < path.size(); ++i) {
      const std::vector<float> from(path[i - 1].begin(), path[i - 1].end());
      const std::vector<float> to(path[i].begin(), path[i].end());
      if (cones.contain_motion(from, to, {})) continue;
      return Failure{DropReason::line,
                     fmt::format("link '{}' leans more than the {:.3g} rad of its constraint",
                                 constraint.link, constraint.angle)};
    }
  }
  return std::nullopt;
}

}  // namespace

bool may_stand(TaskRun& run, const CheckedWorldPtr& world, const Configuration& q) {
  ++run.states;
  if (is_clear_by_exact_geometry(world->checker, q, kLineClearance)) return true;
  if (!run.may_touch_at_ends(world->world)) return false;
  EndExit exit = make_exit(run, world->checker, PathEnd::goal);
  return exit.may_leave(exit.find_touches(q, kLineClearance));
}

tl::expected<FollowedLine, Failure> follow_line(TaskRun& run, const CheckedWorldPtr& world,
                                                const LineTask& line) {
  tl::expected<FollowedLine, Failure> followed;
  ++run.states;
  if (const CheckedWorldPtr clear = find_clear_world(run, world, line.q)) {
    auto path = plan_rest(run, clear->checker, line, line.q);
    if (!path) return tl::unexpected(path.error());
    followed = FollowedLine{clear, *std::move(path), {}};
  } else {
    followed = follow_out_of_contact(run, world, line);
  }
  if (!followed) return followed;
  if (auto tilted = find_tilt(run.task, world->world.robot, followed->path)) {
    return tl::unexpected(*std::move(tilted));
  }
  if (!line.is_start) std::ranges::reverse(followed->path);
  return followed;
}

}  // namespace mneme::internal
