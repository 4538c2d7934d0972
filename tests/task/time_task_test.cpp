// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/small_tasks.h"

#include <algorithm>
#include <cmath>

namespace mneme::test {
namespace {

TaskMotion timed(const Task& task, const TaskResult& result, const TrajectorySettings& timing) {
  REQUIRE_MESSAGE(result.is_solved(), result.message);
  const RateLimits limits = find_rate_limits(task.robot, timing).value();
  return require(time_task(task, result, {}, limits, timing));
}

double speed_at(const Trajectory& motion, double time_s) {
  double most = 0;
  for (const double value : motion.at(time_s).velocity) most = std::max(most, std::abs(value));
  return most;
}

double excess(const std::vector<double>& values, const std::vector<double>& limits) {
  double most = -1;
  for (std::size_t j = 0; j < values.size(); ++j) {
    most = std::max(most, std::abs(values[j]) / limits[j] - 1);
  }
  return most;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a task stops only where the hand changes, and is free with its blends") {
    const Task task = make_task(kCell + kPickAndPlace);
    const TaskResult result = solved(task);
    TrajectorySettings timing;
    for (const std::optional<double> jerk : {std::optional<double>(), std::optional(20.0)}) {
      timing.jerk_limit = jerk;
      timing.blend_tolerance = 0.2;
      const RateLimits limits = find_rate_limits(task.robot, timing).value();
      const TaskMotion motion = timed(task, result, timing);
      timing.blend_tolerance = 0;
      const TaskMotion stopping = timed(task, result, timing);
      const double end_s = motion.trajectory.duration_s();
      CHECK(end_s < stopping.trajectory.duration_s() - 0.05);
      int moving = 0;
      for (const std::size_t i : {1u, 4u, 5u, 8u}) {
        moving += speed_at(motion.trajectory, motion.begins_s[i]) > 0.02 ? 1 : 0;
      }
      CHECK(moving >= 2);
      for (const std::size_t i : {0u, 2u, 3u, 6u, 7u}) {
        CHECK(speed_at(motion.trajectory, motion.begins_s[i]) < 1e-9);
      }
      for (int i = 0; i <= 5000; ++i) {
        const auto point = motion.trajectory.at(end_s * i / 5000);
        CHECK(excess(point.velocity, limits.velocity) <= 1e-6);
        CHECK(excess(point.acceleration, limits.acceleration) <= 1e-6);
      }
      for (std::size_t i = 0; i < result.stages.size(); ++i) {
        if (!motion.stages[i]) continue;
        const StageResult& stage = result.stages[i];
        INFO(stage.name);
        Path path;
        const auto points = motion.stages[i]->sample(0.01).value();
        for (const auto& point : points) path.push_back(point.position);
        CHECK(is_path_free(stage.world->robot, stage.world->scene, path, 0.005,
                           end_tolerances(SolveSettings())));
      }
    }
  }

  TEST_CASE("the hand keeps to its line where no blend is") {
    const Task task = make_task(kCell + kPickAndPlace);
    const TaskResult result = solved(task);
    TrajectorySettings timing;
    timing.blend_tolerance = 0.1;
    const TaskMotion motion = timed(task, result, timing);
    const auto link = static_cast<std::size_t>(*task.robot.find_link("panda_hand"));
    for (const std::size_t i : {1u, 3u, 5u, 7u}) {
      const StageResult& stage = result.stages[i];
      INFO(stage.name);
      const Robot& robot = stage.world->robot;
      const Vec3 from = robot.link_poses(stage.path.front())[link].translation;
      const Vec3 way = robot.link_poses(stage.path.back())[link].translation - from;
      int count = 0;
      const auto points = motion.stages[i]->sample(0.01).value();
      for (const auto& point : points) {
        const Configuration& q = point.position;
        if (robot.distance(q, stage.path.front()) < 0.1) continue;
        if (robot.distance(q, stage.path.back()) < 0.1) continue;
        ++count;
        const Vec3 at = robot.link_poses(q)[link].translation - from;
        CHECK((at - at.dot(way) / way.squaredNorm() * way).norm() < 1e-3);
      }
      CHECK(count >= 1);
    }
  }

  TEST_CASE("a task replaces a motion that runs: it begins with the robot's velocity") {
    Task task = make_task(kCell + "start_velocity: [0.3, 0, 0, -0.2, 0, 0, 0]\n" + kPickAndPlace);
    const TaskResult result = solved(task);
    check_plan(task, result);
    const TaskMotion motion = timed(task, result, {});
    const Trajectory::Point begin = motion.trajectory.at(0);
    REQUIRE(begin.velocity.size() == task.start_velocity.size());
    for (std::size_t j = 0; j < begin.velocity.size(); ++j) {
      CHECK(begin.velocity[j] == doctest::Approx(task.start_velocity[j]).epsilon(1e-6));
    }
    const RateLimits limits = find_rate_limits(task.robot, {}).value();
    for (int i = 0; i <= 2000; ++i) {
      const auto point = motion.trajectory.at(motion.trajectory.duration_s() * i / 2000);
      CHECK(excess(point.velocity, limits.velocity) <= 1e-6);
      CHECK(excess(point.acceleration, limits.acceleration) <= 1e-6);
    }
    task.start_velocity[1] = 2;  // towards the table
    const TaskResult fast = solved(task);
    CHECK(fast.status == PlanStatus::invalid_start);
    CHECK_MESSAGE(fast.message.find("stage 'reach': start velocity: ") == 0, fast.message);
    task.start_velocity = {0.1};
    CHECK(solved(task).message.find("stage 'reach': start velocity: ") == 0);
  }

  TEST_CASE("a stage that is told to stop does so") {
    const Task task = make_task(kCell + replaced(kPickAndPlace, "{name: reach, move: next}",
                                                 "{name: reach, move: next, stop: true}"));
    CHECK(task.stages.front().stop);
    const TaskMotion motion = timed(task, solved(task), {});
    CHECK(speed_at(motion.trajectory, motion.begins_s[1]) < 1e-9);
  }
}

}  // namespace mneme::test
