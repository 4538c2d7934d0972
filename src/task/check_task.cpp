// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/task.h"

#include "base/fail.h"
#include "geometry/solids.h"
#include "input/elided.h"
#include "task/groups.h"
#include "task/world.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace mneme {
namespace internal {
namespace {

/// Bounds the memory of a search, which keeps robot and scene of each stage.
constexpr std::size_t kMostStages = 1000;

/// Follows which objects are held, stage by stage.
class TaskCheck {
 public:
  explicit TaskCheck(const Task& task) : task_(task) {
    for (const Obstacle& obstacle : task.scene.obstacles) free_.insert(obstacle.name);
    for (const ApproximatedObject& each : task.robot.attached()) {
      held_.emplace(each.object.name, each.object.link);
    }
    for (const Link& link : task.robot.without_attached().links()) links_.insert(link.name);
  }

  Result<void> check() {
    if (task_.stages.empty()) {
      return fail(ErrorCode::invalid, "task '{}' has no stages; expected at least one", task_.name);
    }
    if (task_.stages.size() > kMostStages) {
      return fail(
          ErrorCode::unsupported,
          "task '{}' has {} stages, expected at most {}; plan it as several tasks, each from "
          "where the one before ends",
          task_.name, task_.stages.size(), kMostStages);
    }
    if (!task_.start_velocity.empty() && task_.stages.front().kind != StageKind::move) {
      return fail(ErrorCode::invalid,
                  "stage '{}': the robot moves at the start (start velocity), expected a move as "
                  "the first stage, got {}",
                  stage_name(task_, 0), to_string(task_.stages.front().kind));
    }
    MNEME_TRY(check_constraints(task_.constraints));
    for (std::size_t i = 0; i < task_.stages.size(); ++i) {
      const Result<void> checked = check_stage(task_.stages[i]);
      if (checked) continue;
      return fail(checked.error().code, "stage '{}': {}", stage_name(task_, static_cast<int>(i)),
                  checked.error().message);
    }
    return {};
  }

 private:
  Result<void> check_stage(const Stage& stage) {
    if (!(stage.speed > 0 && stage.speed <= 1)) {
      return fail(ErrorCode::invalid, "its speed is {}, expected more than 0 and at most 1",
                  stage.speed);
    }
    if (stage.kind != StageKind::move && !stage.constraints.empty()) {
      return fail(
          ErrorCode::unsupported,
          "constraints hold in moves only, not in a stage of kind {}; remove them, or use a "
          "move",
          to_string(stage.kind));
    }
    switch (stage.kind) {
      case StageKind::move:
        return check_move(stage);
      case StageKind::line:
        return check_line(stage);
      case StageKind::attach:
        return check_attach(stage);
      case StageKind::detach:
        return check_detach(stage);
      case StageKind::allow:
        return check_allow(stage);
      case StageKind::gripper:
        return check_gripper(stage);
    }
    return {};
  }

  Result<void> check_gripper(const Stage& stage) const {
    MNEME_TRY(with_joint_values(task_.robot, stage.values));
    for (const Joint& joint : task_.robot.joints()) {
      const auto value = stage.values.find(joint.name);
      if (value == stage.values.end() || joint.type == JointType::continuous) continue;
      constexpr double kTolerance = 1e-5;
      const double given = value->second;
      if (given >= joint.lower - kTolerance && given <= joint.upper + kTolerance) continue;
      return fail(ErrorCode::invalid, "joint '{}' is to be at {}, beyond its limits [{}, {}]",
                  joint.name, given, joint.lower, joint.upper);
    }
    return {};
  }

  Result<void> check_link(const std::string& link, std::string_view what) const {
    if (links_.contains(link)) return {};
    return fail(ErrorCode::invalid, "expected a link of robot {} as {}, got '{}'{}",
                task_.robot.name(), what, link, did_you_mean(link, names(links_)));
  }

  static std::vector<std::string> names(const std::set<std::string>& all) {
    return {all.begin(), all.end()};
  }

  /// Refuses goals that are no configurations, and goals beyond limits if there are no others: the
  /// search drops these.
  Result<void> check_goals(const Stage& stage) const {
    bool has_other = !stage.poses.poses.empty();
    std::optional<std::string> first;
    for (const MoveGoal& goal : stage.goals) {
      if (const auto* region = std::get_if<PoseGoal>(&goal)) {
        if (const auto fault = describe_fault(task_.robot, *region)) {
          return fail(ErrorCode::invalid, *fault);
        }
        has_other = true;
        continue;
      }
      const Configuration& q = std::get<Configuration>(goal);
      const auto violation = task_.robot.describe_violation(q, "its goal");
      const bool is_number_per_joint =
          std::ssize(q) == task_.robot.joint_count() &&
          std::ranges::all_of(q, [](double value) { return std::isfinite(value); });
      if (violation && !is_number_per_joint) return fail(ErrorCode::invalid, *violation);
      if (!first) first = violation;
      has_other = has_other || !violation;
    }
    if (first && !has_other) return fail(ErrorCode::invalid, *first);
    return {};
  }

  Result<void> check_move(const Stage& stage) const {
    MNEME_TRY(check_goals(stage));
    MNEME_TRY(check_constraints(stage.constraints));
    return check_poses(stage.poses);
  }

  Result<void> check_constraints(const std::vector<OrientationConstraint>& constraints) const {
    for (const OrientationConstraint& constraint : constraints) {
      if (const auto fault = describe_fault(task_.robot, constraint)) {
        return fail(ErrorCode::invalid, *fault);
      }
    }
    return {};
  }

  Result<void> check_poses(const PoseChoice& choice) const {
    if (choice.poses.empty()) return {};
    MNEME_TRY(check_link(choice.link, "the link to bring to its poses"));
    const std::string& frame = choice.frame;
    const bool is_known = frame.empty() || frame == task_.robot.root_frame() ||
                          links_.contains(frame) || free_.contains(frame);
    if (!is_known) {
      std::vector<std::string> known = names(links_);
      known.insert(known.end(), free_.begin(), free_.end());
      return fail(ErrorCode::invalid, "expected a link or an obstacle as frame, got '{}'{}{}",
                  frame, held_.contains(frame) ? ", which is held" : "",
                  did_you_mean(frame, known));
    }
    for (const Transform& pose : choice.poses) {
      if (pose.translation.allFinite() && is_rotation(pose.rotation)) continue;
      return fail(ErrorCode::invalid, "one of its poses is no rotation and position");
    }
    if (choice.object.empty()) return {};
    const auto held = held_.find(choice.object);
    if (held == held_.end()) {
      return fail(ErrorCode::invalid,
                  "expected a held object, got '{}'; an attach stage must come first",
                  choice.object);
    }
    if (held->second == choice.link) return {};
    return fail(ErrorCode::invalid, "object '{}' is held by link '{}', not '{}'", choice.object,
                held->second, choice.link);
  }

  Result<void> check_line(const Stage& stage) const {
    MNEME_TRY(check_poses(stage.poses));
    if (stage.poses.poses.empty()) MNEME_TRY(check_link(stage.link, "the link of a line"));
    if (!stage.along.empty()) MNEME_TRY(check_link(stage.along, "the frame of its direction"));
    const bool has_direction = stage.direction.norm() > 0;
    if (!has_direction && stage.poses.poses.empty()) {
      return fail(ErrorCode::invalid,
                  "the line leads nowhere; expected a direction and a distance, or poses");
    }
    if (has_direction && !(std::abs(stage.direction.norm() - 1) < 1e-6)) {
      return fail(ErrorCode::invalid, "its direction is no unit vector");
    }
    constexpr double kFarthest = 100;  // metres
    if (has_direction && !(stage.distance > 0 && stage.distance <= kFarthest)) {
      return fail(ErrorCode::invalid, "its distance is {} m, expected more than 0 and at most {}",
                  stage.distance, kFarthest);
    }
    return {};
  }

  Result<void> check_attach(const Stage& stage) {
    MNEME_TRY(check_link(stage.carrier, "the link that takes an object"));
    for (const std::string& link : stage.may_touch)
      MNEME_TRY(check_link(link, "a link that may touch"));
    if (links_.contains(stage.object)) {
      return fail(ErrorCode::invalid, "object '{}' has the name of a link: rename the obstacle",
                  stage.object);
    }
    if (held_.contains(stage.object)) {
      return fail(ErrorCode::invalid, "object '{}' is held by link '{}' already; detach it first",
                  stage.object, held_.at(stage.object));
    }
    if (!free_.contains(stage.object)) {
      return fail(ErrorCode::invalid, "expected an obstacle of the scene to attach, got '{}'{}",
                  stage.object, did_you_mean(stage.object, names(free_)));
    }
    free_.erase(stage.object);
    held_.emplace(stage.object, stage.carrier);
    return {};
  }

  Result<void> check_detach(const Stage& stage) {
    if (held_.erase(stage.object) == 0) {
      std::string held;
      for (const auto& [name, link] : held_)
        held += fmt::format("{}'{}'", held.empty() ? "" : ", ", name);
      return fail(ErrorCode::invalid, "expected a held object to detach, got '{}'; held is {}",
                  stage.object, held.empty() ? "nothing" : held);
    }
    free_.insert(stage.object);
    return {};
  }

  Result<void> check_allow(const Stage& stage) const {
    for (const auto& [first, second] : stage.pairs) {
      for (const std::string& name : {first, second}) {
        if (!free_.contains(name) || !is_carried(name)) continue;
        return fail(ErrorCode::invalid,
                    "'{}' is a {} and an obstacle; rename the obstacle to allow its contact", name,
                    links_.contains(name) ? "link" : "held object");
      }
      const bool fits = (free_.contains(second) && is_carried(first)) ||
                        (free_.contains(first) && is_carried(second));
      if (fits) continue;
      return fail(ErrorCode::invalid,
                  "expected a pair of an obstacle and a link or held object, got '{}' and '{}'",
                  first, second);
    }
    return {};
  }

  [[nodiscard]] bool is_carried(const std::string& name) const {
    return links_.contains(name) || held_.contains(name);
  }

  const Task& task_;
  std::set<std::string> links_, free_;
  std::map<std::string, std::string> held_;  ///< object to link
};

}  // namespace
}  // namespace internal

Result<void> check_task(const Task& task) {
  const auto elide = [](const Error& error) {
    return Error{error.code, internal::elided(error.message)};
  };
  MNEME_TRY(internal::TaskCheck(task).check().map_error(elide));
  return internal::make_groups(task).map([](const auto&) {}).map_error(elide);
}

std::string_view to_string(StageKind kind) {
  constexpr std::array<std::string_view, 6> kNames = {"move",   "line",  "attach",
                                                      "detach", "allow", "gripper"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::string_view to_string(DropReason reason) {
  constexpr std::array<std::string_view, kDropReasons> kNames = {"out of reach",
                                                                 "contact",
                                                                 "no place",
                                                                 "no inverse kinematics",
                                                                 "no straight line",
                                                                 "not at the object",
                                                                 "no valid robot or scene",
                                                                 "no path"};
  return kNames.at(static_cast<std::size_t>(reason));
}

}  // namespace mneme
