// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task_file/task_input.h"

#include "mneme/goal.h"
#include "mneme/task_file.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "base/files.h"
#include "problem/problem_input.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mneme {
namespace internal {
namespace {

/// Bounds the memory for alternatives.
constexpr std::size_t kMostPoses = 100'000;

Transform read_pose(const Input& input) {
  Transform pose;
  if (const auto position = input.find("position")) pose.translation = read_point(*position);
  if (const auto quaternion = input.find("quat_xyzw")) {
    const std::vector<double> xyzw = quaternion->finite_numbers(4, "a quaternion x, y, z, w");
    pose.rotation = quaternion->take(rotation_from_unit_quaternion(std::span(xyzw).first<4>()));
  }
  return pose;
}

/// The transforms of an item of `vary`: turns about an axis, or shifts along it.
std::vector<Transform> read_variation(const Input& input) {
  input.allow_keys({"turn", "shift", "from", "to", "count"});
  const auto turn = input.find("turn"), shift = input.find("shift");
  if (turn.has_value() == shift.has_value()) {
    input.fail(ErrorCode::parse, "expected one of the keys turn and shift");
  }
  const Input named = turn ? *turn : *shift;
  const auto axis = parse_axis(named.is_text() ? named.text() : "");
  if (!axis) named.fail_expecting("x, y or z");
  const auto count = input.at("count").whole_number();
  if (!count || *count < 1 || *count > kMostPoses) {
    input.at("count").fail_expecting("a whole number from 1 to {}", kMostPoses);
  }
  const Input range = input.taking_angles(turn.has_value());
  const double from = range.at("from").finite_number(), to = range.at("to").finite_number();
  constexpr double kWholeTurn = 2 * std::numbers::pi + 1e-3;
  if (turn && std::max(std::abs(from), std::abs(to)) > kWholeTurn) {
    input.fail(ErrorCode::invalid,
               "turns from {} to {} go beyond a whole turn: expected radians; degrees are {:.4f} "
               "to {:.4f} rad",
               from, to, from * std::numbers::pi / 180, to * std::numbers::pi / 180);
  }
  std::vector<Transform> all;
  for (std::uint64_t i = 0; i < *count; ++i) {
    const double share = *count == 1 ? 0 : static_cast<double>(i) / static_cast<double>(*count - 1);
    const double value = from + share * (to - from);
    const Vec3 unit = Vec3::Unit(static_cast<int>(*axis));
    all.push_back(turn ? Transform{rotation_about(unit, value), Vec3::Zero()}
                       : Transform{Eigen::Matrix3d::Identity(), value * unit});
  }
  return all;
}

/// A state of joints outside of the planning group.
struct GripperState {
  std::string name, group;
  std::map<std::string, double> values;  ///< without joints that follow others
  bool is_carried = false;               ///< the planning group moves the joints
};

/// Nothing for a state that moves joints of the planning group, or none at all.
std::optional<GripperState> as_gripper_state(const Robot& robot, const NamedState& state) {
  const std::vector<bool> moves = find_moving_links(robot);
  GripperState found{state.name, state.group, {}};
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const Joint& joint = robot.joints()[i];
    const auto value = state.values.find(joint.name);
    if (value == state.values.end() || !is_free(joint)) continue;
    if (std::ranges::count(robot.group(), static_cast<int>(i)) > 0) return std::nullopt;
    found.values.insert(*value);
    found.is_carried = found.is_carried || moves[as_index(joint.parent_link)];
  }
  return found.values.empty() ? std::nullopt : std::optional(std::move(found));
}

/// The values of a gripper's state in the SRDF. Of the same name for several grippers, those that
/// the planning group carries count.
Result<std::map<std::string, double>> find_gripper_state(const Robot& robot,
                                                         const std::string& name) {
  std::vector<std::string> known;
  std::vector<GripperState> found;
  for (const NamedState& state : robot.named_states()) {
    auto gripper = as_gripper_state(robot, state);
    if (!gripper) continue;
    if (std::ranges::count(known, state.name) == 0) known.push_back(state.name);
    if (state.name == name) found.push_back(*std::move(gripper));
  }
  if (std::ranges::any_of(found, &GripperState::is_carried)) {
    std::erase_if(found, [](const GripperState& state) { return !state.is_carried; });
  }
  if (found.size() == 1) return std::move(found.front().values);
  if (found.empty()) {
    return fail(ErrorCode::invalid,
                "expected values by joint, or a state that the SRDF of robot {} names for joints "
                "outside of the planning group ({}), got \"{}\"",
                robot.name(),
                known.empty() ? "it names none" : fmt::format("{}", fmt::join(known, ", ")), name);
  }
  return fail(ErrorCode::invalid,
              "the groups {} and {} have a state \"{}\" each: expected values by joint",
              found[0].group, found[1].group, name);
}

class StageReader {
 public:
  StageReader(const Robot& robot, const Transform& X_RF, const Configuration& start)
      : robot_(robot), X_RF_(X_RF), start_(start) {
    const std::vector<std::string> tips = find_tips(robot.without_attached());
    if (tips.size() == 1) tip_ = tips.front();
    for (const ApproximatedObject& each : robot.attached()) {
      carriers_[each.object.name] = each.object.link;
    }
  }

  Stage read(const Input& input) {
    input.allow_keys({"name", "speed", "stop", "constraints", "move", "line", "attach", "detach",
                      "allow", "gripper"});
    Stage stage;
    stage.name = input.text_or("name", "");
    if (const auto speed = input.find("speed")) stage.speed = speed->positive_number();
    if (const auto stop = input.find("stop")) stage.stop = stop->boolean();
    std::optional<Input> found;
    constexpr std::array kKinds = {StageKind::move,   StageKind::line,  StageKind::attach,
                                   StageKind::detach, StageKind::allow, StageKind::gripper};
    for (const StageKind kind : kKinds) {
      const auto value = input.find(to_string(kind));
      if (!value) continue;
      if (found)
        input.fail(ErrorCode::parse, "expected one kind of stage, got {} and {}",
                   to_string(stage.kind), to_string(kind));
      found = value;
      stage.kind = kind;
    }
    if (!found) {
      input.fail(ErrorCode::parse,
                 "expected one of the keys move, line, attach, detach, allow and gripper");
    }
    read_kind(*found, stage);
    read_stage_constraints(input, stage);
    return stage;
  }

 private:
  void read_kind(const Input& input, Stage& stage) {
    switch (stage.kind) {
      case StageKind::move:
        return read_move(input, stage);
      case StageKind::line:
        return read_line(input, stage);
      case StageKind::attach:
        return read_attach(input, stage);
      case StageKind::detach:
        stage.object = input.text();
        carriers_.erase(stage.object);
        return;
      case StageKind::allow:
        for (const Input& pair : input.items()) stage.pairs.push_back(read_pair(pair));
        return;
      case StageKind::gripper:
        return read_gripper(input, stage);
    }
  }

  void read_gripper(const Input& input, Stage& stage) {
    if (input.is_text() && !input.is_number()) {
      stage.values = input.take(find_gripper_state(robot_, input.text()));
      return;
    }
    if (!input.is_map()) input.fail_expecting("values by joint, or the name of a state");
    for (const auto& [name, value] : input.entries())
      stage.values[name] = value.taking_angles(is_angle(robot_, name)).finite_number();
  }

  static std::pair<std::string, std::string> read_pair(const Input& input) {
    if (!input.is_map()) return read_name_pair(input);
    input.fail(ErrorCode::unsupported,
               "a stage allows contact until the end of the task: expected a list of two names, as "
               "in [hand, table]; contact at ends belongs to the key 'allow' of the task");
  }

  void read_stage_constraints(const Input& input, Stage& stage) {
    if (!input.find("constraints")) return;
    Problem scratch{.robot = robot_};
    read_constraints(input, X_RF_, scratch);
    stage.constraints = std::move(scratch.constraints);
  }

  std::string read_link(const Input& input) {
    if (const auto link = input.find("link")) return link->text();
    if (tip_.empty())
      input.fail(ErrorCode::parse, "expected the key link: the group has no single tip");
    return tip_;
  }

  void read_move(const Input& input, Stage& stage) {
    if (input.is_text() && input.text() == "next") return;
    if (input.is_map() && input.find("to")) {
      input.allow_keys({"link", "to"});
      stage.poses = read_choice(input.at("to"), read_link(input));
      return;
    }
    if (input.is_map() && input.find("any")) {
      input.allow_keys({"any"});
      const std::vector<Input> goals = input.items("any");
      if (goals.empty()) input.at("any").fail_expecting("at least one goal, or move: next");
      for (const Input& goal : goals) read_one_goal(goal, stage);
      return;
    }
    read_one_goal(input, stage);
  }

  void read_one_goal(const Input& input, Stage& stage) {
    Problem scratch{.robot = robot_, .start = start_};
    read_goal(input, X_RF_, scratch);
    std::ranges::move(scratch.goals, std::back_inserter(stage.goals));
    std::ranges::move(scratch.pose_goals, std::back_inserter(stage.goals));
  }

  void read_line(const Input& input, Stage& stage) {
    input.allow_keys({"link", "direction", "along", "distance", "to"});
    stage.link = read_link(input);
    stage.along = input.text_or("along", "");
    if (const auto direction = input.find("direction")) {
      const Vec3 vector = read_point(*direction);
      if (!(vector.norm() > 1e-9)) direction->fail_expecting("a direction of some length");
      stage.direction = vector.normalized();
      if (stage.along.empty()) stage.direction = X_RF_.rotation * stage.direction;
      stage.distance = input.at("distance").positive_number();
    } else if (const auto distance = input.find("distance")) {
      distance->fail(ErrorCode::parse, "expected the key direction, too");
    }
    if (const auto to = input.find("to")) stage.poses = read_choice(*to, stage.link);
  }

  void read_attach(const Input& input, Stage& stage) {
    if (input.is_text()) {
      stage.object = input.text();
      if (tip_.empty())
        input.fail_expecting("a map with the keys object and link: the group has no single tip");
      stage.carrier = tip_;
    } else {
      input.allow_keys({"object", "link", "touch"});
      stage.object = input.at("object").text();
      stage.carrier = read_link(input);
      for (const Input& name : input.items("touch")) stage.may_touch.push_back(name.text());
    }
    carriers_[stage.object] = stage.carrier;
  }

  PoseChoice read_choice(const Input& input, const std::string& link) {
    input.allow_keys({"frame", "object", "position", "quat_xyzw", "poses", "vary"});
    PoseChoice choice;
    choice.link = link;
    choice.object = input.text_or("object", "");
    choice.frame = input.text_or("frame", "");
    // A held object's carrier is known.
    if (const auto carrier = carriers_.find(choice.object); carrier != carriers_.end()) {
      choice.link = carrier->second;
    }
    choice.poses = read_poses(input);
    const std::vector<Input> variations = input.items("vary");
    for (auto varied = variations.rbegin(); varied != variations.rend(); ++varied) {
      vary(*varied, choice.poses);
    }
    if (choice.frame.empty()) {
      for (Transform& pose : choice.poses) pose = X_RF_ * pose;
    }
    return choice;
  }

  static std::vector<Transform> read_poses(const Input& input) {
    const auto list = input.find("poses");
    if (!list) return {read_pose(input)};
    for (const char* single : {"position", "quat_xyzw"}) {
      if (const auto both = input.find(single)) {
        both->fail_expecting("it in each of `poses`, or instead of them");
      }
    }
    std::vector<Transform> poses;
    for (const Input& item : list->items()) {
      item.allow_keys({"position", "quat_xyzw"});
      poses.push_back(read_pose(item));
    }
    if (poses.empty()) list->fail_expecting("at least one pose");
    return poses;
  }

  /// Replaces each pose by its variations.
  static void vary(const Input& variation, std::vector<Transform>& poses) {
    const std::vector<Transform> changes = read_variation(variation);
    if (changes.size() * poses.size() > kMostPoses) {
      variation.fail(ErrorCode::invalid, "expected at most {} poses in all", kMostPoses);
    }
    std::vector<Transform> varied;
    for (const Transform& change : changes) {
      for (const Transform& pose : poses) varied.push_back(change * pose);
    }
    poses = std::move(varied);
  }

  const Robot& robot_;
  Transform X_RF_;
  const Configuration& start_;  ///< of the task
  std::string tip_;
  std::map<std::string, std::string> carriers_;  ///< by object
};

/// `X_RF`: frame of poses without a frame, in the root link's frame. `start` is the task's.
std::vector<Stage> read_stages(const Input& list, const Robot& robot, const Transform& X_RF,
                               const Configuration& start) {
  StageReader reader(robot, X_RF, start);
  std::vector<Stage> stages;
  std::size_t poses = 0;
  for (const Input& input : list.items()) {
    stages.push_back(reader.read(input));
    poses += stages.back().poses.poses.size();
    if (poses > kMostPoses) {
      input.fail(ErrorCode::invalid, "expected at most {} poses in all stages", kMostPoses);
    }
  }
  return stages;
}

Task read_task(const std::string& path, const ProblemOptions& options) {
  const auto text = value_or_throw(read_text_file(path));
  const InputValue value = parse_yaml(text, path);
  const Input input(value, path);
  input.allow_keys({"name", "robot", "srdf", "group", "joints", "fixed_joints", "frame", "scene",
                    "start", "start_velocity", "allow", "attached", "constraints", "self_filter",
                    "stages"});
  const std::string name = input.text_or("name", std::filesystem::path(path).stem().string());
  // Stages take the place of the goals.
  ProblemOptions without_goal = options;
  without_goal.goal = Configuration();
  return read_task_of(
      read_problem({input, input, name, directory_of(path), read_scene_of_problem(input, path)},
                   without_goal),
      input);
}

}  // namespace

Task read_task_of(Problem problem, const Input& input) {
  Task task{std::move(problem.name),        std::move(problem.robot),
            std::move(problem.robot_path),  std::move(problem.scene),
            std::move(problem.start),       {},
            std::move(problem.constraints), std::move(problem.start_velocity),
            std::move(problem.warnings),    std::move(problem.files)};
  const Input list = input.at("stages");
  task.stages = read_stages(list, task.robot, read_frame(input, task.robot), task.start);
  if (const auto checked = check_task(task); !checked) {
    list.fail(checked.error().code, checked.error().message);
  }
  return task;
}

}  // namespace internal

Result<Task> load_task(const std::string& path, const ProblemOptions& options) {
  return internal::without_throwing([&] { return internal::read_task(path, options); });
}

Result<std::vector<Stage>> parse_stages(const std::string& text, const std::string& source,
                                        const Robot& robot, const Configuration& start) {
  return internal::without_throwing([&] {
    const internal::InputValue value = internal::parse_yaml(text, source);
    return internal::read_stages(internal::Input(value, source), robot, {}, start);
  });
}

bool is_task_file(const std::string& path) {
  if (path.find(".json") != std::string::npos) return false;
  const auto found = internal::without_throwing([&] {
    const auto text = internal::value_or_throw(internal::read_text_file(path));
    if (text.find("stages") == std::string::npos) return false;
    const internal::InputValue value = internal::parse_yaml(text, path);
    const internal::Input input(value, path);
    return input.is_map() && input.find("stages").has_value();
  });
  return found.value_or(false);
}

}  // namespace mneme
