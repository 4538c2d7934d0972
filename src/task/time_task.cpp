// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/task.h"

#include "pipeline/trajectory_checker.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mneme {
namespace {

/// Radians of L2 joint distance by which a timed line may leave its path.
constexpr double kLineTolerance = 2e-4;

/// The fingers move as fast as their own limits allow.
Result<Trajectory> time_gripper(const GripperMotion& gripper, const SolveSettings& settings,
                                const TrajectorySettings& timing, const std::string& limits_file,
                                double speed) {
  RateLimits limits = MNEME_TRY(find_rate_limits(gripper.world->robot, timing, limits_file));
  for (double& value : limits.velocity) value *= speed;
  return make_trajectory(*gripper.world, settings, gripper.path, limits, timing);
}

std::vector<FingerMotion> fingers_of(const GripperMotion& gripper, const Trajectory& motion) {
  std::vector<FingerMotion> fingers;
  const std::vector<std::string> joints = gripper.world->robot.joint_names();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (gripper.path.front()[j] == gripper.path.back()[j]) continue;
    fingers.push_back({joints[j], motion.of_joint(j)});
  }
  return fingers;
}

/// Motions of the stages that take time.
struct MovingStages {
  const SolveSettings& settings;
  const RateLimits& limits;
  const TrajectorySettings& timing;
  const std::string& limits_file;
  // Parts refer to verifiers, and these to checkers.
  std::deque<internal::TrajectoryChecker> checkers = {};
  std::deque<MotionVerifier> verifiers = {};
  std::vector<MotionPart> parts = {};
  std::vector<std::size_t> firsts = {};                 ///< per stage: parts before it
  std::vector<std::optional<Trajectory>> fingers = {};  ///< per stage

  Result<void> add(const Stage& stage, const StageResult& planned) {
    firsts.push_back(parts.size());
    fingers.emplace_back();
    const bool changes_hand = stage.kind == StageKind::attach || stage.kind == StageKind::detach ||
                              stage.kind == StageKind::gripper;
    if (changes_hand && !parts.empty()) parts.back().stops = true;
    if (planned.gripper) {
      Trajectory motion =
          MNEME_TRY(time_gripper(*planned.gripper, settings, timing, limits_file, stage.speed));
      const Configuration& q = planned.path.back();
      // The group rests meanwhile.
      parts.push_back({Trajectory({{0, q}}, q, motion.duration_s()), limits, nullptr, true});
      fingers.back() = std::move(motion);
    } else if (planned.path.size() > 1) {
      MNEME_TRY(add_path(stage, planned));
    }
    if (stage.stop && !parts.empty()) parts.back().stops = true;
    return {};
  }

  Result<void> add_path(const Stage& stage, const StageResult& planned) {
    RateLimits slower = limits;
    for (double& value : slower.velocity) value *= stage.speed;
    TrajectorySettings near_path = timing;
    if (stage.kind == StageKind::line) {
      near_path.path_tolerance = std::min(timing.path_tolerance, kLineTolerance);
      near_path.time_rounds = 0;
    }
    const Problem& world = *planned.world;
    checkers.push_back(MNEME_TRY(internal::make_trajectory_checker(world, settings, planned.path)));
    verifiers.push_back(checkers.back().verifier());
    const MotionVerifier* verifier = &verifiers.back();
    Trajectory motion = MNEME_TRY(
        parameterize(world.robot, planned.path, slower, near_path, verifier, world.start_velocity));
    parts.push_back({std::move(motion), std::move(slower), verifier, false});
    return {};
  }

  [[nodiscard]] TaskMotion join(const Configuration& end) const {
    if (parts.empty()) return {Trajectory({}, end, 0), std::vector<double>(firsts.size()), fingers};
    auto [trajectory, begins_s] = join_motions(parts, timing.blend_tolerance);
    begins_s.push_back(trajectory.duration_s());
    TaskMotion motion{std::move(trajectory), {}, fingers};
    for (std::size_t i = 0; i < firsts.size(); ++i) {
      const double begin_s = begins_s[firsts[i]];
      motion.begins_s.push_back(begin_s);
      const std::size_t next = i + 1 < firsts.size() ? firsts[i + 1] : parts.size();
      if (next == firsts[i] || fingers[i]) continue;
      motion.stages[i] = motion.trajectory.between(begin_s, begins_s[next]);
    }
    return motion;
  }
};

}  // namespace

Result<TaskMotion> time_task(const Task& task, const TaskResult& result,
                             const SolveSettings& settings, const RateLimits& limits,
                             const TrajectorySettings& timing, const std::string& limits_file) {
  MovingStages moving{settings, limits, timing, limits_file};
  for (std::size_t i = 0; i < result.stages.size(); ++i) {
    MNEME_TRY(moving.add(task.stages[i], result.stages[i]));
  }
  return moving.join(result.stages.back().path.back());
}

std::vector<StageBegin> stage_begins(const TaskResult& result, const TaskMotion& motion) {
  std::vector<StageBegin> stages;
  for (std::size_t i = 0; i < result.stages.size(); ++i) {
    const StageResult& stage = result.stages[i];
    stages.push_back({stage.name, motion.begins_s[i]});
    if (stage.gripper) stages.back().fingers = fingers_of(*stage.gripper, *motion.stages[i]);
  }
  return stages;
}

}  // namespace mneme
