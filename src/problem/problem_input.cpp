// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem_input.h"

#include "mneme/spheres.h"

#include "base/as_index.h"
#include "base/files.h"
#include "check/link_distances.h"
#include "robot/held_joints.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>

namespace mneme::internal {
namespace {

constexpr double kTolerance = 1e-9;
constexpr std::size_t kShownJoints = 3;
/// In multiples of the robot's reach.
constexpr double kFarAway = 2;
constexpr std::size_t kCachedRobots = 8;

bool is_close(double a, double b) { return std::abs(a - b) <= kTolerance; }

std::string find_path(const Input& input, const std::string& directory,
                      const std::string& override_path) {
  if (!override_path.empty()) return override_path;
  const Input named = input.at("robot");
  const std::string robot = named.text();
  if (robot.find('/') != std::string::npos || robot.ends_with(".urdf")) {
    return (std::filesystem::path(directory) / robot).string();
  }
  return named.take(find_robot(robot));
}

/// Returns why the value of a joint cannot be fixed, or nothing.
std::string describe_obstruction(const Robot& robot, const std::string& name) {
  for (const Joint& joint : robot.joints()) {
    if (joint.held && held_values(joint, {}).contains(name)) return "";
  }
  const auto joint = std::ranges::find(robot.joints(), name, &Joint::name);
  if (joint == robot.joints().end()) {
    std::vector<std::string> names;
    for (const Joint& each : robot.joints()) names.push_back(each.name);
    return "no such joint" + did_you_mean(name, names);
  }
  if (joint->held) return joint->held->is_planar ? "a planar joint" : "a floating joint";
  if (std::ranges::count(robot.group(), joint - robot.joints().begin()) > 0) return "planned for";
  if (joint->mimic) return "follows another joint";
  return joint->type == JointType::fixed ? "a fixed joint" : "";
}

/// Returns the value. The error of an unreadable file has the place that names the file.
template <class T>
T value_named_by(const Input& place, Result<T> result) {
  if (!result && result.error().code == ErrorCode::io) return place.take(std::move(result));
  return value_or_throw(std::move(result));
}

/// As load_problem_robot(). Errors of unreadable files have the key of `input` that names the file.
ProblemRobot load_named_robot(const Input& input, const std::string& path,
                              const RobotOptions& options, const ProblemOptions& overrides) {
  try {
    return load_problem_robot(path, options, overrides);
  } catch (const InputFailure& failure) {
    if (failure.error.code != ErrorCode::io) throw;
    const auto check = [&](std::string_view key, const std::string& file,
                           const std::string& override_path) {
      const auto named = input.find(key);
      if (named && override_path.empty()) value_named_by(*named, read_text_file(file));
    };
    check("robot", path, overrides.robot_path);
    check("srdf", options.srdf_path, overrides.robot.srdf_path);
    throw;
  }
}

std::vector<std::string> joint_names(const Input& list) {
  std::vector<std::string> names;
  for (const Input& joint : list.items()) names.push_back(joint.text());
  return names;
}

}  // namespace

ProblemRobot load_problem_robot(const std::string& path, const RobotOptions& options,
                                const ProblemOptions& overrides) {
  ProblemCache* const cache = overrides.cache.get();
  if (cache) {
    const auto known = std::ranges::find_if(cache->robots, [&](const CachedRobot& candidate) {
      return candidate.robot.path == path && candidate.options == options;
    });
    if (known != cache->robots.end()) return known->robot;
  }
  ApproximatedRobot loaded =
      value_or_throw(load_approximated_robot(path, options, {}, overrides.on_approximated));
  ProblemRobot robot{
      path, std::move(loaded.robot), std::move(loaded.notes), options.srdf_path, {path}};
  if (!robot.srdf.empty()) robot.files.push_back(robot.srdf);
  if (!cache) return robot;
  if (cache->robots.size() == kCachedRobots) cache->robots.erase(cache->robots.begin());
  cache->robots.push_back({options, robot});
  return robot;
}

bool is_angle(const Robot& robot, const std::string& name) {
  const auto joint = std::ranges::find(robot.joints(), name, &Joint::name);
  return joint == robot.joints().end() ? name.ends_with("/theta") : is_turning(*joint);
}

ProblemRobot read_robot(const Input& input, const std::string& directory,
                        const ProblemOptions& overrides) {
  const std::string path = find_path(input, directory, overrides.robot_path);
  RobotOptions options = overrides.robot;
  std::vector<std::string> warnings;
  if (const auto srdf = input.find("srdf"); srdf && options.srdf_path.empty()) {
    options.srdf_path = (std::filesystem::path(directory) / srdf->text()).string();
  }
  if (const auto joints = input.find("joints"); joints && options.joints.empty()) {
    options.joints = joint_names(*joints);
    const auto beside = input.find("group");
    const std::string group = beside && options.group.empty() ? beside->text() : options.group;
    if (!group.empty()) {
      warnings.push_back(
          joints->place(fmt::format("planning is for these joints; group {} is ignored", group)));
    }
  } else if (const auto group = input.find("group"); group && options.group.empty()) {
    options.group = group->text();
  }
  ProblemRobot result = load_named_robot(input, path, options, overrides);
  std::move(warnings.begin(), warnings.end(), std::back_inserter(result.warnings));
  if (const auto fixed_joints = input.find("fixed_joints")) {
    std::map<std::string, double> values;
    for (const auto& [name, value] : fixed_joints->entries()) {
      values[name] = value.taking_angles(is_angle(result.robot, name)).finite_number();
    }
    if (fix_joints(result, options, values, *fixed_joints)) {
      result.robot = load_problem_robot(path, options, overrides).robot;
    }
  }
  for (const std::string& warning : result.robot.warnings()) result.warnings.push_back(warning);
  return result;
}

bool fix_joints(ProblemRobot& robot, RobotOptions& options,
                const std::map<std::string, double>& values, const Input& place) {
  std::vector<std::string> ignored;
  bool is_changed = false;
  for (const auto& [name, value] : values) {
    const std::string obstruction = describe_obstruction(robot.robot, name);
    if (obstruction.empty()) {
      is_changed |= options.fixed_values.emplace(name, value).second;
    } else {
      ignored.push_back(fmt::format("{} ({})", name, obstruction));
    }
  }
  if (!ignored.empty()) {
    const std::size_t rest = ignored.size() - std::min(ignored.size(), kShownJoints);
    ignored.resize(ignored.size() - rest);
    if (rest > 0) ignored.push_back(fmt::format("and {} more", rest));
    robot.warnings.push_back(place.place(
        fmt::format("ignored for robot {}: {}", robot.robot.name(), fmt::join(ignored, ", "))));
  }
  return is_changed;
}

void check_robot_facts(const Input& input, const Robot& robot) {
  if (const auto links = input.find("links")) {
    std::vector<double> lengths;
    for (const Link& link : robot.links()) {
      for (const Capsule& capsule : link.capsules) {
        lengths.push_back((capsule.b - capsule.a).norm());
      }
    }
    const std::vector<double> expected = links->numbers();
    if (!std::equal(lengths.begin(), lengths.end(), expected.begin(), expected.end(), is_close)) {
      links->fail(ErrorCode::invalid, "expected the lengths of robot {}'s capsules, [{}], got [{}]",
                  robot.name(), fmt::join(lengths, ", "), fmt::join(expected, ", "));
    }
  }
  if (const auto limits = input.find("joint_limits")) {
    const std::vector<double> range =
        limits->taking_angles().finite_numbers(2, "lower and upper limit of all joints");
    for (int i = 0; i < robot.joint_count(); ++i) {
      const Joint& joint = robot.group_joint(i);
      if (!is_close(joint.lower, range[0]) || !is_close(joint.upper, range[1])) {
        limits->fail(ErrorCode::invalid,
                     "expected the limits of robot {}'s joint {}, [{}, {}], got [{}]", robot.name(),
                     joint.name, joint.lower, joint.upper, fmt::join(range, ", "));
      }
    }
  }
}

std::optional<Transform> find_fixed_link(const Robot& robot, const std::string& name,
                                         const Input& place) {
  const auto links = robot.links();
  const auto found = robot.find_frame(name);
  if (!found) return std::nullopt;
  Transform X_RF;
  for (const Link* link = &links[as_index(*found)]; link->parent_joint >= 0;) {
    const Joint& joint = robot.joints()[as_index(link->parent_joint)];
    if (joint.type != JointType::fixed) {
      place.fail(ErrorCode::unsupported,
                 "expected the root link of robot {} or one fixed to it, got \"{}\", "
                 "which joint {} moves",
                 robot.name(), name, joint.name);
    }
    X_RF = joint.origin * X_RF;
    link = &links[as_index(joint.parent_link)];
  }
  return X_RF;
}

Transform pose_of_frame(const Robot& robot, const std::string& name, const Input& place) {
  if (const auto X_RF = find_fixed_link(robot, name, place)) return *X_RF;
  place.fail(ErrorCode::invalid, "expected a link of robot {} as frame, got \"{}\"", robot.name(),
             name);
}

Transform read_frame(const Input& input, const Robot& robot) {
  const auto frame = input.find("frame");
  return frame ? pose_of_frame(robot, frame->text(), *frame) : Transform();
}

namespace {

Configuration read_start(const Input& input, const Robot& robot, const ProblemOptions& options) {
  return options.start ? read_configuration(*options.start, "start", robot)
                       : read_configuration(input.at("start"), robot);
}

std::vector<Input> find_goals(const Input& input) {
  const auto goals = input.find("goals");
  if (!goals) return {input.at("goal")};
  if (input.find("goal")) goals->fail(ErrorCode::parse, "expected either goal or goals, got both");
  const std::vector<Input> items = goals->items();
  if (items.empty()) goals->fail_expecting("at least one goal");
  return items;
}

}  // namespace

FramedScene read_scene_of_problem(const Input& problem, const std::string& path) {
  const std::string name = problem.text_or("name", std::filesystem::path(path).stem().string());
  const Input scene = problem.at("scene");
  if (scene.is_text()) {
    const std::string file = (std::filesystem::path(directory_of(path)) / scene.text()).string();
    FramedScene framed = value_named_by(scene, load_framed_scene(file));
    framed.files = {path, file};
    return framed;
  }
  if (!scene.is_map()) scene.fail_expecting("a scene, or the path of a scene file");
  return {read_scene(scene, name), "", {path}};
}

std::string directory_of(const std::string& path) {
  return std::filesystem::path(path).parent_path().string();
}

std::vector<std::string> describe_fixed_contacts(const Robot& robot, const Scene& scene) {
  std::vector<std::string> notes;
  for (const Contact& contact : find_fixed_contacts(robot, LinkDistances(robot), scene)) {
    notes.push_back(
        fmt::format("link {} touches obstacle {}, and no joint of the group moves it: this "
                    "contact is ignored",
                    contact.link, contact.other));
  }
  return notes;
}

namespace {

/// Lower bound of the distance from the root's origin, metres. Exact if the bounding sphere alone
/// does not decide whether it is beyond `far`.
double distance_from_root(const Obstacle& obstacle, double far) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Shape& shape : obstacle.shapes) {
    const Sphere bound = bounding_sphere(shape);
    double away = bound.center.norm() - bound.radius;
    if (away <= far && bound.center.norm() > far) away = mneme::distance(shape, Sphere{});
    nearest = std::min(nearest, away);
  }
  return nearest;
}

/// A warning if obstacles are far beyond the robot's reach: mostly a mistake of units.
std::vector<std::string> describe_far_obstacles(const Robot& robot, const Scene& scene) {
  const double reach = farthest_reach(robot), far = kFarAway * reach;
  std::size_t count = 0;
  double nearest = std::numeric_limits<double>::infinity();
  std::string first;
  for (const Obstacle& obstacle : scene.obstacles) {
    if (obstacle.shapes.empty() || reach == 0) continue;
    const double away = distance_from_root(obstacle, far);
    if (away <= far) continue;
    if (count++ == 0) first = obstacle.name;
    nearest = std::min(nearest, away);
  }
  if (count == 0) return {};
  const std::string others =
      count == 1 ? " is" : fmt::format(" and {} more are at least", count - 1);
  return {
      fmt::format("obstacle {}{} {:.3g} m away, and robot {} reaches {:.2g} m: numbers in a "
                  "scene are metres",
                  first, others, nearest, robot.name(), reach)};
}

/// The frame that a scene file names for its objects, unless the header names one.
std::optional<Transform> find_scene_frame(const ProblemInput& input, const Robot& robot) {
  const std::string& frame = input.framed.frame;
  if (frame.empty() || input.header.find("frame")) return std::nullopt;
  const Input place = input.problem.find("scene").value_or(input.problem);
  auto X_RF = find_fixed_link(robot, frame, place);
  if (!X_RF) {
    place.fail(ErrorCode::invalid,
               "its objects are in frame \"{}\", which is no link of robot {}; name the link that "
               "they are in under the key frame",
               frame, robot.name());
  }
  return X_RF;
}

/// `allow(options)` returns the robot with allowed pairs of links.
template <class Allow>
Problem read_with(ProblemRobot robot, const ProblemInput& input, const ProblemOptions& options,
                  const Allow& allow) {
  check_robot_facts(input.problem, robot.robot);
  const Transform X_RF = read_frame(input.header, robot.robot);
  Scene scene = moved(find_scene_frame(input, robot.robot).value_or(X_RF), input.framed.scene);
  InputFindings findings;
  std::vector<AttachedObject> attached = read_attached(
      input.problem.collecting(findings), input.spelling, input.directory, robot.robot);
  AllowedContacts contacts(robot.robot, attached, scene);
  read_allowed(input.problem, contacts);
  RobotOptions allowing = options.robot;
  allowing.allowed_pairs.insert(allowing.allowed_pairs.end(), contacts.link_pairs().begin(),
                                contacts.link_pairs().end());
  if (!contacts.link_pairs().empty()) robot = allow(allowing);
  robot.robot = attach_to(robot.robot, std::move(attached),
                          input.problem.find("attached").value_or(input.problem));
  Configuration start = read_start(input.problem, robot.robot, options);
  const auto add_notes = [&](const std::vector<std::string>& more) {
    robot.warnings.insert(robot.warnings.end(), more.begin(), more.end());
  };
  findings.append_to(robot.warnings);
  add_notes(input.framed.scene.warnings);
  add_notes(filter_own_points(read_self_filter(input.problem, options), robot.robot, start, scene));
  add_notes(describe_fixed_contacts(robot.robot, scene));
  add_notes(describe_far_obstacles(robot.robot, scene));
  Problem problem{.name = input.name,
                  .robot = robot.robot,
                  .robot_path = robot.path,
                  .scene = std::move(scene),
                  .start = std::move(start),
                  .warnings = std::move(robot.warnings),
                  .srdf_path = robot.srdf};
  problem.allowed_pairs = std::move(allowing.allowed_pairs);
  const auto velocity = [&](const char* key, const std::optional<std::vector<double>>& given) {
    if (given) return *given;
    const auto values = input.problem.find(key);
    return values ? read_joint_values(*values, problem.robot) : std::vector<double>();
  };
  problem.start_velocity = velocity("start_velocity", options.start_velocity);
  problem.end_velocity = velocity("end_velocity", options.end_velocity);
  problem.files = input.framed.files;
  std::ranges::move(robot.files, std::back_inserter(problem.files));
  if (!take_goals(options, X_RF, problem)) {
    for (const Input& goal : find_goals(input.problem)) read_goal(goal, X_RF, problem);
  }
  read_constraints(input.problem, X_RF, problem);
  take_constraints(options, X_RF, problem);
  return problem;
}

}  // namespace

Problem read_problem(const ProblemInput& input, const ProblemOptions& options) {
  if (options.made_robot) return read_problem_of({"", *options.made_robot, {}}, input, options);
  const auto allow = [&](const RobotOptions& allowing) {
    ProblemOptions changed = options;
    changed.robot = allowing;
    return read_robot(input.header, input.directory, changed);
  };
  return read_with(read_robot(input.header, input.directory, options), input, options, allow);
}

Problem read_problem_of(ProblemRobot robot, const ProblemInput& input,
                        const ProblemOptions& options) {
  const auto refuse = [&](const RobotOptions& allowing) -> ProblemRobot {
    const auto& [first, second] = allowing.allowed_pairs.back();
    input.problem.at("allow").fail(
        ErrorCode::invalid,
        "expected pairs of a link and an obstacle or an attached object: the robot is "
        "given, got its links \"{}\" and \"{}\"",
        first, second);
  };
  return read_with(std::move(robot), input, options, refuse);
}

}  // namespace mneme::internal
