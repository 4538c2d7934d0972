// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/follow.h"

#include "mneme/goal.h"
#include "mneme/line.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "check/end_motions.h"
#include "path/waypoints.h"
#include "planning/end_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace mneme::internal {
namespace {

/// Lengths of the motion out of contact, as shares of what allow-at-ends allows.
constexpr std::array<double, 3> kShares = {0.4, 0.66, 0.88};

/// Returns the configuration near `q` that brings the link to the pose.
std::optional<Configuration> reach_nearby(const CollisionChecker& checker, const std::string& link,
                                          const Transform& pose, const Configuration& q) {
  constexpr double kFarthest = 0.3;  // radians: another posture
  const auto kinematics = InverseKinematics::make(checker.robot(), link, checker.isa());
  if (!kinematics) return std::nullopt;
  IkSettings settings;
  settings.seeds = 1;
  settings.solutions = 1;
  settings.position_tolerance = 2e-5;
  settings.rotation_tolerance = 2e-4;
  PoseGoal goal;
  goal.link = link;
  goal.pose = pose;
  const IkResult reached = kinematics->solve(goal, q, settings);
  if (reached.solutions.empty()) return std::nullopt;
  const Configuration& found = reached.solutions.front();
  if (checker.robot().distance(q, found) > kFarthest) return std::nullopt;
  return found;
}

/// Metres that links move at most between a state of the motion and the nearest checked one.
double room_between(const CollisionChecker& checker, const Configuration& from,
                    const Configuration& to, int states) {
  const Robot& robot = checker.robot();
  std::vector<float> delta = to_floats(robot.difference(from, to));
  for (float& value : delta) value = std::abs(value) / static_cast<float>(2 * states);
  return checker.displacement_bound(to_floats(robot.normalized(from)),
                                    to_floats(robot.normalized(to)), delta);
}

/// The world with pairs checked exactly whose spheres alone touch at `q`.
CheckedWorldPtr with_exact_pairs(const TaskRun& run, const CheckedWorldPtr& world,
                                 const Configuration& q) {
  const auto made = make_query_checker(world->checker, run.checker_settings(), {q, {}});
  if (!made) return world;
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

std::string describe_contact(const CollisionChecker& checker, const Configuration& q) {
  const std::vector<Contact> contacts = checker.contacts(checker.robot().normalized(q));
  if (contacts.empty()) return "something within 0.1 mm";
  const Contact& deepest = *std::ranges::min_element(contacts, {}, &Contact::distance);
  return fmt::format("'{}' with '{}'", deepest.link, deepest.other);
}

namespace {

/// Motions out of the contact of a held object at one end of a line.
class ContactExit {
 public:
  ContactExit(TaskRun& run, const CheckedWorldPtr& world, const LineTask& line)
      : run_(run),
        world_(world),
        line_(line),
        motions_(checker().robot(), checker().scene(), checker().margin(),
                 end_tolerances(run.settings.solve)) {}

  /// True if what touches at the end of the line may be left there.
  bool may_begin() {
    motions_.check_exactly(motions_.touching(line_.q));
    const std::vector<Touch> touches = motions_.touching(line_.q);
    return std::ranges::all_of(
        touches, [&](const Touch& touch) { return motions_.may_leave(touch, line_.is_start); });
  }

  /// The configuration that the given share of the stretch farther is free of contact.
  std::optional<Configuration> find_inside(double share) {
    const Robot& robot = checker().robot();
    Transform pose = robot.link_poses(line_.q)[as_index(*robot.find_link(line_.link))];
    const Vec3 way = line_.X_WL.translation - pose.translation;
    if (way.norm() == 0) return std::nullopt;
    const double length = share * std::min(motions_.longest_stretch(), way.norm());
    pose.translation += length * way.normalized();
    auto inside = reach_nearby(checker(), line_.link, pose, line_.q);
    ++run_.states;
    if (!inside || robot.describe_violation(*inside, "")) return std::nullopt;
    if (!is_clear_by_exact_geometry(checker(), *inside)) return std::nullopt;
    return inside;
  }

  /// True if the motion between the line's end and `inside` only leaves the contact.
  bool is_left_by(const Configuration& inside) {
    const auto passes = [&](int states) {
      run_.states += static_cast<std::uint64_t>(states);
      return motions_.is_left_by(line_.q, inside, line_.is_start, states,
                                 room_between(checker(), line_.q, inside, states));
    };
    return passes(kFewStates) || passes(kManyStates);
  }

 private:
  /// States of the motion; many where other links are near.
  static constexpr int kFewStates = 16, kManyStates = 256;

  [[nodiscard]] const CollisionChecker& checker() const { return world_->checker; }

  TaskRun& run_;
  const CheckedWorldPtr& world_;
  const LineTask& line_;
  EndMotions motions_;
};

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
  std::optional<ContactExit> made;
  if (run.may_touch_at_ends(world->world)) made.emplace(run, world, line);
  if (made && made->may_begin()) {
    ContactExit& exit = *made;
    for (const double share : kShares) {
      const auto inside = exit.find_inside(share);
      if (!inside) continue;
      const CheckedWorldPtr exact = with_exact_pairs(run, world, *inside);
      auto rest = plan_rest(run, exact->checker, line, *inside);
      if (!rest) return tl::unexpected(rest.error());
      // Exact distances cost more than the rest of the line.
      if (!exit.is_left_by(*inside)) continue;
      rest->insert(rest->begin(), line.q);
      return FollowedLine{exact, *std::move(rest)};
    }
  }
  if (line.has_reason) failure.what = describe_contact(world->checker, line.q);
  return tl::unexpected(std::move(failure));
}

}  // namespace

bool may_stand(TaskRun& run, const CheckedWorldPtr& world, const Configuration& q) {
  ++run.states;
  if (is_clear_by_exact_geometry(world->checker, q)) return true;
  if (!run.may_touch_at_ends(world->world)) return false;
  const LineTask here{"", q, {}, false};
  return ContactExit(run, world, here).may_begin();
}

tl::expected<FollowedLine, Failure> follow_line(TaskRun& run, const CheckedWorldPtr& world,
                                                const LineTask& line) {
  tl::expected<FollowedLine, Failure> followed;
  ++run.states;
  if (is_clear(world->checker, line.q)) {
    auto path = plan_rest(run, world->checker, line, line.q);
    if (!path) return tl::unexpected(path.error());
    followed = FollowedLine{world, *std::move(path)};
  } else if (is_clear_by_exact_geometry(world->checker, line.q)) {
    const CheckedWorldPtr exact = with_exact_pairs(run, world, line.q);
    auto path = plan_rest(run, exact->checker, line, line.q);
    if (!path) return tl::unexpected(path.error());
    followed = FollowedLine{exact, *std::move(path)};
  } else {
    followed = follow_out_of_contact(run, world, line);
  }
  if (followed && !line.is_start) std::ranges::reverse(followed->path);
  return followed;
}

}  // namespace mneme::internal
