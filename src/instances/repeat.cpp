// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/goal.h"
#include "mneme/instances.h"
#include "mneme/planning.h"

#include "base/fail.h"

#include <algorithm>
#include <optional>

namespace mneme {
namespace {

constexpr int kMostRepeatTries = 1000;
/// Seeds of inverse kinematics: the old goal and configurations around it.
constexpr int kSeeds = 16;
/// Largest distance between the goals of a fixed base, radians: beyond, the arm's posture differs.
constexpr double kSameArm = 1;

/// A random vector in a ball, or in a disc of the x-y plane.
Vec3 sample_move(bool is_flat, double radius, Rng& rng) {
  for (;;) {
    Vec3 v;
    for (const int axis : {2, 1, 0}) v[axis] = rng.uniform(-1, 1);
    if (is_flat) v.z() = 0;
    if (v.squaredNorm() <= 1) return radius * v;
  }
}

bool has_fixed_base(const RepeatSettings& settings) {
  return settings.base == 0 && settings.turn == 0;
}

/// A random pose of the world in the base's frame.
Transform sample_world(const RepeatSettings& settings, Rng& rng) {
  if (has_fixed_base(settings)) return {};
  const double turn = rng.uniform(-settings.turn, settings.turn);
  return {rotation_about(Vec3::UnitZ(), turn), sample_move(true, settings.base, rng)};
}

Scene sample_scene(const Problem& problem, const Transform& world, double radius, Rng& rng) {
  Scene moved = problem.scene;
  for (Obstacle& obstacle : moved.obstacles) {
    const Vec3 move = sample_move(problem.robot.is_planar(), radius, rng);
    const Transform X = world * Transform{Eigen::Matrix3d::Identity(), move};
    for (Shape& shape : obstacle.shapes) shape = transformed(X, shape);
  }
  return moved;
}

/// Samples goals with a moved tip.
class GoalMover {
 public:
  static Result<GoalMover> make(const Robot& robot, const Configuration& goal) {
    const std::vector<std::string> tips = find_tips(robot);
    if (tips.empty()) {
      return fail(ErrorCode::unsupported, "robot {} has no tip to move", robot.name());
    }
    auto kinematics = MNEME_TRY(InverseKinematics::make(robot, tips.front()));
    const auto is_tip = [&](const Link& link) { return link.name == tips.front(); };
    const auto index = std::ranges::find_if(robot.links(), is_tip) - robot.links().begin();
    const Transform pose = robot.link_poses(goal)[static_cast<std::size_t>(index)];
    return GoalMover(robot, goal, std::move(kinematics), {tips.front(), pose});
  }

  std::optional<Configuration> sample(const CollisionChecker& checker, const Transform& world,
                                      const RepeatSettings& repeat, Rng& rng) const {
    const bool is_fixed = has_fixed_base(repeat);
    if (is_fixed && repeat.goal == 0) return goal_;
    PoseGoal moved = tip_;
    moved.pose.translation += sample_move(robot_.is_planar(), repeat.goal, rng);
    moved.pose = world * moved.pose;
    IkSettings settings;
    settings.seeds = kSeeds;
    const IkResult found = kinematics_.solve(moved, goal_, settings, &checker);
    if (found.solutions.empty()) return std::nullopt;
    const Configuration& nearest = found.solutions.front();
    if (is_fixed && robot_.distance(nearest, goal_) >= kSameArm) return std::nullopt;
    return nearest;
  }

 private:
  GoalMover(const Robot& robot, const Configuration& goal, InverseKinematics kinematics,
            PoseGoal tip)
      : robot_(robot), goal_(goal), kinematics_(std::move(kinematics)), tip_(std::move(tip)) {}

  const Robot& robot_;
  const Configuration& goal_;
  InverseKinematics kinematics_;
  PoseGoal tip_;
};

}  // namespace

Result<Problem> repeat(const Problem& problem, const RepeatSettings& settings, Rng& rng) {
  if (!(settings.obstacles >= 0 && settings.goal >= 0 && settings.base >= 0 &&
        settings.turn >= 0)) {
    return fail(ErrorCode::invalid,
                "a repetition's settings obstacles, goal, base and turn must be 0 or more");
  }
  if (problem.goals.empty()) {
    return fail(ErrorCode::unsupported, "problem '{}': expected a goal that is a configuration",
                problem.name);
  }
  if (auto fault = problem.robot.describe_violation(problem.goals.front(), "goal")) {
    return fail(ErrorCode::invalid, "problem '{}': {}", problem.name, *fault);
  }
  const auto mover = MNEME_TRY(GoalMover::make(problem.robot, problem.goals.front()));
  Problem repeated = problem;
  repeated.pose_goals.clear();
  for (int i = 0; i < kMostRepeatTries; ++i) {
    const Transform world = sample_world(settings, rng);
    repeated.scene = sample_scene(problem, world, settings.obstacles, rng);
    const auto checker = MNEME_TRY(CollisionChecker::make(problem.robot, repeated.scene));
    const auto goal = mover.sample(checker, world, settings, rng);
    if (!goal) continue;
    repeated.goals = {*goal};
    if (!refuse_query(checker, {repeated.start, repeated.goals})) return repeated;
  }
  return fail(
      ErrorCode::invalid,
      "problem '{}': start or goal is in contact in all {} repetitions; try smaller distances",
      problem.name, kMostRepeatTries);
}

}  // namespace mneme
