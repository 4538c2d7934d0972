// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_problem.h"

#include "base/text_file.h"
#include "problem/goals.h"
#include "problem/moveit_goal.h"
#include "problem/moveit_request.h"
#include "problem/problem_input.h"
#include "scene/moveit_scene.h"
#include "scene/yaml.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace mneme::internal {
namespace {

constexpr std::string_view kRequest = "request";

/// A goal may repeat where a joint stands that is not planned for.
constexpr double kSamePosition = 1e-5;

bool has_joint(const Robot& robot, const std::string& name) {
  const auto joints = robot.joints();
  return std::any_of(joints.begin(), joints.end(),
                     [&](const Joint& joint) { return joint.name == name; });
}

bool is_planned(const Robot& robot, const std::string& name) {
  for (int i = 0; i < robot.joint_count(); ++i) {
    if (robot.group_joint(i).name == name) return true;
  }
  return false;
}

Configuration positions_of_group(const Robot& robot, const std::map<std::string, double>& positions,
                                 const Input& place, std::string_view what) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const auto position = positions.find(robot.group_joint(i).name);
    if (position == positions.end()) {
      place.fail(ErrorCode::invalid, fmt::format("expected a {} position of joint {}, which is "
                                                 "planned for; there is none",
                                                 what, robot.group_joint(i).name));
    }
    q.push_back(position->second);
  }
  return q;
}

class MoveitReader {
 public:
  MoveitReader(const Input& scene, const Input& request, const MoveitAddress& address,
               const ProblemOptions& options)
      : scene_input_(scene),
        request_input_(request),
        address_(address),
        overrides_(options),
        options_(options.robot),
        scene_(read_moveit_scene(scene, stem(address.scene))),
        request_(read_moveit_request(request)),
        state_(overlaid(scene_.state, request_.start)) {}

  Problem read() {
    ProblemRobot robot = read_robot();
    Problem problem{stem(address_.request), robot.robot, robot.path, {}, {}, {}, {}};
    const MoveitFrames frames(scene_input_, state_);
    problem.scene = place_objects(scene_, frames, [&](const std::string& name, const Input& place) {
      return find_fixed_link(robot.robot, name, place);
    });
    problem.start = overrides_.start ? *overrides_.start
                                     : positions_of_group(robot.robot, state_.positions,
                                                          request_input_, "start");
    if (!take_goals(overrides_, {}, problem)) read_goals(frames, problem);
    problem.warnings = std::move(robot.warnings);
    problem.warnings.insert(problem.warnings.end(), scene_.warnings.begin(), scene_.warnings.end());
    return problem;
  }

 private:
  static std::string stem(const std::string& path) {
    return std::filesystem::path(path).stem().string();
  }

  std::string find_path() const {
    if (!overrides_.robot_path.empty()) return overrides_.robot_path;
    if (scene_.robot_name.empty()) {
      scene_input_.fail(ErrorCode::parse,
                        "expected the key robot_model_name, or a robot that is "
                        "given beside the problem");
    }
    const Result<std::string> found = find_robot(scene_.robot_name);
    if (!found) scene_input_.at("robot_model_name").fail(found.error().code, found.error().message);
    return *found;
  }

  ProblemRobot read_robot() {
    if (options_.group.empty() && options_.joints.empty()) options_.group = request_.group;
    const std::string path = find_path();
    ProblemRobot robot = load_problem_robot(path, options_);
    std::vector<std::string> objects;
    for (const MoveitObject& object : scene_.objects) objects.push_back(object.obstacle.name);
    MoveitAllowed allowed = read_moveit_allowed(scene_input_, robot.robot, objects);
    options_.allowed_pairs.insert(options_.allowed_pairs.end(), allowed.pairs.begin(),
                                  allowed.pairs.end());
    std::map<std::string, double> others = state_.positions;
    std::erase_if(others, [&](const auto& joint) { return is_planned(robot.robot, joint.first); });
    if (fix_joints(robot, options_, others, request_input_) || !allowed.pairs.empty()) {
      robot.robot = load_problem_robot(path, options_).robot;
    }
    std::move(allowed.warnings.begin(), allowed.warnings.end(), std::back_inserter(robot.warnings));
    const auto own = robot.robot.warnings();
    robot.warnings.insert(robot.warnings.end(), own.begin(), own.end());
    return robot;
  }

  void read_goals(const MoveitFrames& frames, Problem& problem) const {
    for (std::size_t i = 0; i < request_.goals.size(); ++i) {
      const Input& place = request_.goal_places[i];
      if (is_moveit_pose_goal(place)) {
        add_pose_goal(place, read_pose_goal(place, frames, problem), problem);
        continue;
      }
      for (const auto& [joint, position] : request_.goals[i]) {
        check_other_joint(problem.robot, joint, position, place);
      }
      problem.goals.push_back(positions_of_group(problem.robot, request_.goals[i], place, "goal"));
    }
  }

  /// Frames of links that move are where they are at the start.
  static PoseGoal read_pose_goal(const Input& place, const MoveitFrames& frames,
                                 const Problem& problem) {
    const Robot& robot = problem.robot;
    const auto find_link = [&](const std::string& name,
                               const Input& where) -> std::optional<Transform> {
      const auto link = std::ranges::find(robot.links(), name, &Link::name);
      if (link == robot.links().end()) return std::nullopt;
      if (const auto violation = robot.describe_violation(problem.start, "start")) {
        where.fail(ErrorCode::invalid, *violation);
      }
      const std::vector<Transform> poses = robot.link_poses(problem.start);
      return poses[static_cast<std::size_t>(link - robot.links().begin())];
    };
    return read_moveit_pose_goal(place, [&](const Input& constraint) {
      return frames.pose_in_root(read_frame_id(constraint), constraint, find_link);
    });
  }

  void check_other_joint(const Robot& robot, const std::string& name, double position,
                         const Input& place) const {
    if (is_planned(robot, name)) return;
    const auto stays = state_.positions.find(name);
    if (!has_joint(robot, name) || stays == state_.positions.end() ||
        std::abs(stays->second - position) > kSamePosition) {
      place.fail(
          ErrorCode::invalid,
          fmt::format("expected positions of joints that are planned for, got one of {}; the "
                      "robot is {}",
                      name, robot.name()));
    }
  }

  const Input& scene_input_;
  const Input& request_input_;
  const MoveitAddress& address_;
  const ProblemOptions& overrides_;
  RobotOptions options_;
  MoveitScene scene_;
  MoveitRequest request_;
  MoveitState state_;
};

}  // namespace

std::optional<MoveitAddress> split_moveit_address(const std::string& where) {
  for (std::size_t comma = where.find(','); comma != std::string::npos;
       comma = where.find(',', comma + 1)) {
    const std::string scene = where.substr(0, comma);
    if (scene.ends_with(".yaml") || scene.ends_with(".yml")) {
      return MoveitAddress{scene, where.substr(comma + 1)};
    }
  }
  return std::nullopt;
}

std::string scene_of_request(const Input& request, const std::string& path) {
  const std::filesystem::path file(path);
  std::string name = file.filename().string();
  const std::size_t at = name.rfind(kRequest);
  if (at == std::string::npos) {
    request.fail(ErrorCode::invalid,
                 fmt::format("the scene of this motion plan request is unknown; expected a file "
                             "name with \"request\" in it, or SCENE.yaml,{}",
                             path));
  }
  return (file.parent_path() / name.replace(at, kRequest.size(), "scene")).string();
}

Problem read_moveit_problem(const MoveitAddress& address, const ProblemOptions& options) {
  const InputValue scene = parse_yaml(value_or_throw(read_text_file(address.scene)), address.scene);
  const InputValue request =
      parse_yaml(value_or_throw(read_text_file(address.request)), address.request);
  const Input scene_input(scene, address.scene);
  const Input request_input(request, address.request);
  if (!is_moveit_request(request_input)) {
    request_input.fail(ErrorCode::parse, "expected a motion plan request with goal_constraints");
  }
  return MoveitReader(scene_input, request_input, address, options).read();
}

}  // namespace mneme::internal
