// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_problem.h"

#include "base/as_index.h"
#include "base/files.h"
#include "problem/problem_input.h"
#include "robot/held_joints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace mneme::internal {
namespace {

constexpr std::string_view kRequest = "request";

/// Radians or metres by which a goal may differ from the start for a joint outside the group.
constexpr double kSamePosition = 1e-5;

bool has_joint(const Robot& robot, const std::string& name) {
  return std::ranges::count(robot.joints(), name, &Joint::name) > 0;
}

bool is_planned(const Robot& robot, const std::string& name) {
  return std::ranges::any_of(robot.group(),
                             [&](int i) { return robot.joints()[as_index(i)].name == name; });
}

Configuration positions_of_group(const Robot& robot, const std::map<std::string, double>& positions,
                                 const Input& place, std::string_view what) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const auto position = positions.find(robot.group_joint(i).name);
    if (position == positions.end()) {
      place.fail(ErrorCode::invalid,
                 "expected a {} position of joint {} of the planning group, got none", what,
                 robot.group_joint(i).name);
    }
    q.push_back(position->second);
  }
  return q;
}

/// The middle of each range, clamped to the joint's limits if the two overlap.
std::map<std::string, double> middles_of(const std::map<std::string, JointRange>& ranges,
                                         const Robot& robot) {
  std::map<std::string, double> middles;
  for (const auto& [name, range] : ranges) middles[name] = 0.5 * (range.least + range.most);
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    const auto given = ranges.find(joint.name);
    if (given == ranges.end() || joint.type == JointType::continuous) continue;
    const double least = std::max(given->second.least, joint.lower);
    const double most = std::min(given->second.most, joint.upper);
    if (least <= most) middles[joint.name] = 0.5 * (least + most);
  }
  return middles;
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
    ProblemRobot robot = load_robot();
    hold_joints(robot);
    const MoveitFrames frames(scene_input_, state_);
    Problem problem{.name = stem(address_.request),
                    .robot = robot.robot,
                    .robot_path = robot.path,
                    .srdf_path = robot.srdf};
    problem.files = std::move(robot.files);
    problem.files.insert(problem.files.end(), {address_.scene, address_.request});
    problem.scene = place_scene(robot.robot, frames);
    std::vector<AttachedObject> attached = name_attached(robot);
    allow_and_fix(robot, attached, problem.scene);
    pose_attached(robot.robot, frames, attached);
    robot.robot = attach_to(robot.robot, std::move(attached), request_input_);
    add_warnings(robot, problem.scene);
    problem.robot = robot.robot;
    problem.start = read_start(robot.robot);
    if (!take_goals(overrides_, {}, problem)) read_goals(frames, problem);
    read_path_constraints(frames, problem);
    take_constraints(overrides_, {}, problem);
    problem.start_velocity = overrides_.start_velocity.value_or(std::vector<double>());
    problem.end_velocity = overrides_.end_velocity.value_or(std::vector<double>());
    problem.warnings = std::move(robot.warnings);
    problem.allowed_pairs = options_.allowed_pairs;
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
                        "expected the key robot_model_name, or a robot given with the problem");
    }
    return scene_input_.at("robot_model_name").take(find_robot(scene_.robot_name));
  }

  ProblemRobot load_robot() {
    if (options_.group.empty() && options_.joints.empty()) options_.group = request_.group;
    return load_problem_robot(find_path(), options_, overrides_);
  }

  /// Moves planar and floating joints of the robot to the state's poses. The pose that is left is
  /// that of a virtual joint.
  void hold_joints(ProblemRobot& robot) {
    std::map<std::string, double> values;
    for (const Joint& joint : robot.robot.joints()) {
      const auto pose = joint.held ? state_.poses.find(joint.name) : state_.poses.end();
      if (pose == state_.poses.end()) continue;
      values.merge(held_values(joint, pose->second));
      state_.poses.erase(pose);
    }
    if (fix_joints(robot, options_, values, request_input_)) {
      robot.robot = load_problem_robot(robot.path, options_, overrides_).robot;
    }
  }

  Scene place_scene(const Robot& robot, const MoveitFrames& frames) const {
    Scene scene = place_objects(scene_, frames, [&](const std::string& name, const Input& place) {
      return find_fixed_link(robot, name, place);
    });
    std::erase_if(scene.obstacles, [&](const Obstacle& obstacle) {
      return std::ranges::any_of(state_.attached, [&](const MoveitAttached& attached) {
        return attached.object.obstacle.name == obstacle.name;
      });
    });
    return scene;
  }

  /// Attached objects without shapes, which need the robot's start.
  std::vector<AttachedObject> name_attached(ProblemRobot& robot) const {
    std::vector<AttachedObject> objects;
    const auto has_link = [&](const std::string& name) {
      return robot.robot.find_link(name).has_value();
    };
    for (const MoveitAttached& attached : state_.attached) {
      const std::string& name = attached.object.obstacle.name;
      if (!has_link(attached.link) || has_link(name)) {
        attached.object.place.fail(
            ErrorCode::invalid,
            has_link(name) ? fmt::format("expected a unique name, got \"{}\", a link", name)
                           : fmt::format("expected a link of robot {} to carry \"{}\", got \"{}\"",
                                         robot.robot.name(), name, attached.link));
      }
      AttachedObject& object = objects.emplace_back(AttachedObject{name, attached.link, {}});
      for (const std::string& link : attached.touch_links) {
        if (has_link(link)) {
          object.may_touch.push_back(link);
        } else {
          robot.warnings.push_back(attached.object.place.place(
              fmt::format("ignored, because there is no such touch link: {}", link)));
        }
      }
    }
    return objects;
  }

  /// Reads allowed contacts and values of joints outside the group; both need the robot anew.
  void allow_and_fix(ProblemRobot& robot, std::vector<AttachedObject>& attached, Scene& scene) {
    AllowedContacts contacts(robot.robot, attached, scene);
    std::vector<std::string> names;
    for (const Link& link : robot.robot.links()) names.push_back(link.name);
    for (const AttachedObject& object : attached) names.push_back(object.name);
    for (const Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
    std::vector<std::string> ignored = read_moveit_allowed(scene_input_, names, contacts);
    options_.allowed_pairs.insert(options_.allowed_pairs.end(), contacts.link_pairs().begin(),
                                  contacts.link_pairs().end());
    std::map<std::string, double> others = state_.positions;
    std::erase_if(others, [&](const auto& joint) { return is_planned(robot.robot, joint.first); });
    if (fix_joints(robot, options_, others, request_input_) || !contacts.link_pairs().empty()) {
      robot.robot = load_problem_robot(robot.path, options_, overrides_).robot;
    }
    std::ranges::move(ignored, std::back_inserter(robot.warnings));
  }

  /// Finds link poses at a start, which is computed only if a frame of a link is named.
  template <class FindStart>
  static FindLink links_at(const Robot& robot, const FindStart& find_start) {
    return [&robot, find_start](const std::string& name,
                                const Input& where) -> std::optional<Transform> {
      const auto link = robot.find_frame(name);
      if (!link) return std::nullopt;
      return robot.link_poses(find_start(where))[as_index(*link)];
    };
  }

  /// Sets the shapes of attached objects, in their links' frames at the scene's start.
  void pose_attached(const Robot& robot, const MoveitFrames& frames,
                     std::vector<AttachedObject>& objects) const {
    const FindLink find_pose = links_at(robot, [&](const Input&) {
      return positions_of_group(robot, state_.positions, request_input_, "start");
    });
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const MoveitObject& object = shaped(state_.attached[i].object);
      if (object.plane_count > 0) {
        state_.attached[i].object.place.fail(
            ErrorCode::unsupported,
            "object \"{}\": expected shapes without planes to attach, got a plane",
            object.obstacle.name);
      }
      objects[i].shapes = object.obstacle.shapes;
      if (object.frame == objects[i].link) continue;
      const Transform X_RL = *find_pose(objects[i].link, object.place);
      const Transform X_RF = frames.pose_in_root(object.frame, object.place, find_pose);
      objects[i].shapes = moved(X_RL.inverse() * X_RF, object.obstacle).shapes;
    }
  }

  /// Returns the object, or the object of the world with its name if it has no shapes.
  const MoveitObject& shaped(const MoveitObject& object) const {
    if (!object.obstacle.shapes.empty()) return object;
    const auto found = std::ranges::find_if(scene_.objects, [&](const MoveitObject& other) {
      return other.obstacle.name == object.obstacle.name;
    });
    if (found == scene_.objects.end()) {
      object.place.fail(ErrorCode::invalid,
                        "object \"{}\": expected primitives, or an object of this name "
                        "in the world",
                        object.obstacle.name);
    }
    return *found;
  }

  void add_warnings(ProblemRobot& robot, const Scene& scene) const {
    const auto own = robot.robot.warnings();
    robot.warnings.insert(robot.warnings.end(), own.begin(), own.end());
    std::ranges::move(describe_fixed_contacts(robot.robot, scene),
                      std::back_inserter(robot.warnings));
    for (const char* key : {"max_velocity_scaling_factor", "max_acceleration_scaling_factor"}) {
      const auto factor = request_input_.find_value(key);
      if (!factor) continue;
      const double share = factor->finite_number();
      // In MoveIt, 0 means not set.
      if (share == 0 || share == 1) continue;
      robot.warnings.push_back(
          factor->place(fmt::format("{} is ignored: --velocity-scale and --acceleration-scale set "
                                    "the speed of a trajectory",
                                    key)));
    }
  }

  Configuration read_start(const Robot& robot) const {
    if (overrides_.start) return read_configuration(*overrides_.start, "start", robot);
    return positions_of_group(robot, state_.positions, request_input_, "start");
  }

  void read_goals(const MoveitFrames& frames, Problem& problem) const {
    for (std::size_t i = 0; i < request_.goals.size(); ++i) {
      const Input& place = request_.goal_places[i];
      if (is_moveit_pose_goal(place)) {
        add_pose_goal(place, read_moveit_pose_goal(place, frames_at_start(frames, problem)),
                      problem);
        continue;
      }
      const auto positions = middles_of(request_.goals[i], problem.robot);
      for (const auto& [joint, position] : positions) {
        check_other_joint(problem.robot, joint, position, place);
      }
      problem.goals.push_back(positions_of_group(problem.robot, positions, place, "goal"));
    }
  }

  /// Returns poses of the constraints' frames at the start. Refers to its arguments.
  static FrameOf frames_at_start(const MoveitFrames& frames, const Problem& problem) {
    return [&frames, &problem](const Input& constraint) {
      const Robot& robot = problem.robot;
      const FindLink find_link = links_at(robot, [&](const Input& where) {
        if (const auto violation = robot.describe_violation(problem.start, "start")) {
          where.fail(ErrorCode::invalid, *violation);
        }
        return problem.start;
      });
      return frames.pose_in_root(read_frame_id(constraint), constraint, find_link);
    };
  }

  void read_path_constraints(const MoveitFrames& frames, Problem& problem) const {
    for (const Input& place : request_.path_constraints) {
      add_constraint(place, read_moveit_path_constraint(place, frames_at_start(frames, problem)),
                     problem);
    }
  }

  void check_other_joint(const Robot& robot, const std::string& name, double position,
                         const Input& place) const {
    if (is_planned(robot, name)) return;
    const auto stays = state_.positions.find(name);
    if (!has_joint(robot, name) || stays == state_.positions.end() ||
        std::abs(stays->second - position) > kSamePosition) {
      place.fail(ErrorCode::invalid,
                 "expected positions of joints of the planning group, got one of {}; the robot is "
                 "{}",
                 name, robot.name());
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
                 "the scene of this motion plan request is unknown; expected a file "
                 "name with \"request\" in it, or SCENE.yaml,{}",
                 path);
  }
  return (file.parent_path() / name.replace(at, kRequest.size(), "scene")).string();
}

Problem read_moveit_problem(const MoveitAddress& address, const ProblemOptions& options) {
  const InputValue scene = parse_yaml(value_or_throw(read_text_file(address.scene)), address.scene);
  const InputValue request =
      parse_yaml(value_or_throw(read_text_file(address.request)), address.request);
  InputFindings findings;
  const Input scene_input = Input(scene, address.scene).collecting(findings);
  const Input request_input = Input(request, address.request).collecting(findings);
  if (!is_moveit_request(request_input)) {
    request_input.fail(ErrorCode::parse, "expected a motion plan request with goal_constraints");
  }
  if (options.made_robot) {
    request_input.fail(ErrorCode::unsupported,
                       "a motion plan request refers to groups and fixed joints; expected a robot "
                       "by file or name, not a loaded one");
  }
  Problem problem = MoveitReader(scene_input, request_input, address, options).read();
  findings.append_to(problem.warnings);
  return problem;
}

}  // namespace mneme::internal
