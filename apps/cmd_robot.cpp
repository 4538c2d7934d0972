// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme robot: shows robots, checks configurations and writes planar arms.
#include "mneme/collision.h"
#include "mneme/goal.h"
#include "mneme/robot.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct RobotCommandOptions {
  std::string robot;
  RobotOptions robot_options;
  std::string scene;
  std::optional<GivenConfiguration> q;
  bool is_json = false;
};

constexpr double kLongestLink = 1e6;  // metres

struct PlanarOptions {
  std::vector<double> links;
  double thickness = 0.001;
  std::string name;
  std::string output = "-";
  bool is_json = false;
};

// info

const std::string& link_name(const Robot& robot, int link) {
  return robot.links()[static_cast<std::size_t>(link)].name;
}

Json to_json(const Robot& robot, const Joint& joint) {
  return {{"name", joint.name},
          {"type", to_string(joint.type)},
          {"parent", link_name(robot, joint.parent_link)},
          {"child", link_name(robot, joint.child_link)},
          {"lower", joint.lower},
          {"upper", joint.upper}};
}

Json to_json(const Robot& robot, const std::string& path) {
  Json joints = Json::array();
  for (int i = 0; i < robot.joint_count(); ++i) {
    joints.push_back(to_json(robot, robot.group_joint(i)));
  }
  Json links = Json::array();
  for (const Link& link : robot.links()) {
    links.push_back({{"name", link.name},
                     {"spheres", link.spheres.size()},
                     {"capsules", link.capsules.size()}});
  }
  return {{"name", robot.name()},
          {"path", path},
          {"hash", robot.hash()},
          {"kinematics_hash", robot.kinematics_hash()},
          {"is_planar", robot.is_planar()},
          {"joint_count", robot.joint_count()},
          {"joints", joints},
          {"links", links},
          {"self_pairs", robot.self_pairs().size()}};
}

void print_robot(const Robot& robot, const std::string& path) {
  fmt::print("robot   {} ({})\n", printable(robot.name()), printable(path));
  fmt::print("hash    {}\n", robot.hash());
  fmt::print("planar  {}\n", robot.is_planar() ? "yes" : "no");
  fmt::print("pairs   {} checked against each other\n", robot.self_pairs().size());
  fmt::print("joints  {}\n", robot.joint_count());
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    fmt::print("  {:<20} {:<11} {:>9.5f} to {:>9.5f}  moves {}\n", printable(joint.name),
               to_string(joint.type), joint.lower, joint.upper,
               printable(link_name(robot, joint.child_link)));
  }
  fmt::print("links   {}\n", robot.links().size());
  for (const Link& link : robot.links()) {
    fmt::print("  {:<20} {} spheres, {} capsules\n", printable(link.name), link.spheres.size(),
               link.capsules.size());
  }
}

Result<ExitCode> run_info(const RobotCommandOptions& options) {
  const std::string path = MNEME_TRY(robot_file(options.robot));
  const Robot robot = MNEME_TRY(load_named_robot(path, options.robot_options));
  if (options.is_json) {
    print_json(to_json(robot, path));
  } else {
    print_robot(robot, path);
  }
  return ExitCode::done;
}

// check

Json to_json(const std::vector<Contact>& contacts) {
  Json rows = Json::array();
  for (const Contact& contact : contacts) {
    rows.push_back({{"link", contact.link},
                    {"other", contact.other},
                    {"is_self", contact.is_self},
                    {"distance", contact.distance},
                    {"may_be_deeper", contact.may_be_deeper}});
  }
  return rows;
}

/// Poses of the group's tips in the root link's frame.
Json find_tip_poses(const Robot& robot, const Configuration& q) {
  Json tips = Json::array();
  const std::vector<Transform> poses = robot.link_poses(q);
  const std::vector<std::string> names = find_tips(robot);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string& link = robot.links()[i].name;
    if (std::ranges::count(names, link) == 0) continue;
    const Eigen::Quaterniond turn(poses[i].rotation);
    const Vec3& at = poses[i].translation;
    tips.push_back({{"link", link},
                    {"position", {at.x(), at.y(), at.z()}},
                    {"quat_xyzw", {turn.x(), turn.y(), turn.z(), turn.w()}}});
  }
  return tips;
}

void print_tips(const Json& tips) {
  for (const Json& tip : tips) {
    fmt::print("tip {} at {:.6f}, quaternion xyzw {:.6f}\n",
               printable(tip["link"].get<std::string>()),
               fmt::join(tip["position"].get<std::vector<double>>(), ", "),
               fmt::join(tip["quat_xyzw"].get<std::vector<double>>(), ", "));
  }
}

void print_contact(const Contact& contact, std::string_view ending) {
  fmt::print("{} touches {} {} ({:.6f} m{}){}\n", printable(contact.link),
             contact.is_self ? "link" : "obstacle", printable(contact.other), contact.distance,
             contact.may_be_deeper ? " or deeper" : "", ending);
}

/// The distance of the exact geometry, where that and not the spheres decides.
std::string describe_exact(const CollisionChecker& checker, const Configuration& q,
                           const Contact& contact) {
  const auto behind = find_exact_contact(checker.robot(), checker.scene(), q, contact);
  if (!behind) return "";
  if (behind->distance == 0) return "; the exact geometry touches, too";
  return fmt::format("; by spheres: the exact geometry is {:.6f} m away", behind->distance);
}

ExitCode report_state(const CollisionChecker& checker, const Configuration& q, bool is_json) {
  const std::vector<Contact> contacts = checker.contacts(q);
  const Json tips = find_tip_poses(checker.robot(), q);
  if (is_json) {
    print_json({{"is_valid", contacts.empty()},
                {"violation", nullptr},
                {"contacts", to_json(contacts)},
                {"fixed_contacts", to_json(checker.fixed_contacts())},
                {"tips", tips}});
  } else {
    for (const Contact& contact : contacts) {
      print_contact(contact, describe_exact(checker, q, contact));
    }
    for (const Contact& contact : checker.fixed_contacts()) {
      print_contact(contact, "; ignored, because no joint moves either");
    }
    if (contacts.empty()) fmt::print("valid\n");
    print_tips(tips);
  }
  return contacts.empty() ? ExitCode::done : ExitCode::invalid_ends;
}

Result<ExitCode> run_check(const RobotCommandOptions& options) {
  const auto placed =
      MNEME_TRY(load_placed_robot(options.robot, options.robot_options, options.scene));
  const auto q = placed.robot.configuration_of(*options.q);
  if (!q) return fail(q.error().code, "--q: " + q.error().message);
  if (const auto violation = placed.robot.describe_violation(*q, "configuration")) {
    if (options.is_json) {
      print_json({{"is_valid", false},
                  {"violation", *violation},
                  {"contacts", Json::array()},
                  {"fixed_contacts", Json::array()},
                  {"tips", Json::array()}});
    } else {
      print_error(*violation);
    }
    return ExitCode::invalid_ends;
  }
  return CollisionChecker::make(placed.robot, placed.scene)
      .map([&](const CollisionChecker& checker) {
        return report_state(checker, *q, options.is_json);
      });
}

// planar

Result<ExitCode> run_planar(const PlanarOptions& options) {
  const std::string name =
      options.name.empty() ? fmt::format("planar{}", options.links.size()) : options.name;
  const std::string urdf = MNEME_TRY(planar_arm_urdf(name, options.links, options.thickness));
  if (options.output == "-") {
    fmt::print("{}", urdf);
    return ExitCode::done;
  }
  MNEME_TRY(write_file(options.output, urdf));
  if (options.is_json) {
    print_json({{"path", options.output}, {"name", name}, {"links", options.links}});
  } else {
    fmt::print("wrote {}: {}, {} links\n", options.output, name, options.links.size());
  }
  return ExitCode::done;
}

void check_planar(const CLI::App&, PlanarOptions& options) {
  if (options.is_json && options.output == "-") {
    throw CLI::ValidationError("--json", "needs -o, because the URDF goes to standard output");
  }
}

void add_planar(CLI::App& group, Action& action) {
  const auto options = std::make_shared<PlanarOptions>();
  CLI::App& command = add_command(group, action, "planar", "Write the URDF of a planar arm",
                                  "robot planar --links 1.6,1.4,1.8 -o arm.urdf", options,
                                  run_planar, check_planar);
  const auto read_links = [options](const std::string& text) {
    options->links = parse_numbers("--links", text);
    for (const double length : options->links) {
      if (length > 0 && length < kLongestLink) continue;
      throw CLI::ValidationError(
          "--links", fmt::format("{} is not a length of more than 0 m and less than {} m", length,
                                 kLongestLink));
    }
  };
  add_text(command, "--links", read_links, "lengths, metres")->type_name("X,X,..")->required();
  add_number(command, "--thickness", options->thickness, 0, 10, "diameter of the links, metres");
  command.add_option("--name", options->name, "name of the robot (default planar and the count)");
  command.add_option("-o,--output", options->output,
                     "file to write, - for standard output (default -)");
  add_json(command, options->is_json);
}

}  // namespace

void add_robot(CLI::App& program, Action& action) {
  CLI::App& group = add_group(
      program, "robot", "Show and check robots, solve inverse kinematics, make spheres and SRDFs",
      "robot info planar8");
  const auto options = std::make_shared<RobotCommandOptions>();
  CLI::App& info = add_command(group, action, "info", "Show joints, limits, links and hash",
                               "robot info planar8", options, run_info);
  CLI::App& check =
      add_command(group, action, "check", "Show the contacts and tips of a configuration",
                  "robot check planar8 --q 0,0,0,0,0,0,0,0 --scene shelf.yaml", options, run_check);
  for (CLI::App* command : {&info, &check}) {
    add_robot_argument(*command, options->robot, options->robot_options);
    add_json(*command, options->is_json);
  }
  add_configuration(check, "--q", options->q, "configuration")->required();
  check.add_option("--scene", options->scene, "scene or problem with the obstacles");
  add_isa(check);
  add_planar(group, action);
  add_robot_ik(group, action);
  add_robot_spheres(group, action);
  add_robot_srdf(group, action);
}

}  // namespace mneme::app
