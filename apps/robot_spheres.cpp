// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/spheres.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <vector>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct SpheresOptions {
  std::string robot;
  std::string output;
  std::string srdf_output;
  RobotOptions reading;
  SphereSettings spheres;
  std::vector<std::string> link_excess;  ///< LINK=METRES each
  PairSettings pairs;
  bool is_json = false;
};

struct Made {
  RobotSpheres robot;
  std::vector<std::string> reasons;  ///< of the allowed pairs
};

/// The link and excess of `text`, LINK=METRES. Errors: no such link, or nothing to approximate.
Result<std::pair<Link*, double>> parse_link_excess(const std::string& text, Robot::Parts& parts) {
  const std::size_t sign = text.rfind('=');
  const std::string name = text.substr(0, sign);
  const auto link = std::ranges::find(parts.links, name, &Link::name);
  if (sign == std::string::npos || link == parts.links.end() || link->solids.empty()) {
    return fail(ErrorCode::invalid,
                fmt::format("--link-excess {}: expected LINK=METRES, a link of the robot with "
                            "boxes, cylinders or meshes",
                            text));
  }
  double excess = 0;
  const bool is_number = CLI::detail::lexical_cast(text.substr(sign + 1), excess);
  if (!is_number || !(excess >= 0.001 && excess <= 1)) {
    return fail(ErrorCode::invalid,
                fmt::format("--link-excess {}: expected metres from 0.001 to 1", text));
  }
  return std::pair(&*link, excess);
}

/// Approximates the links that have an excess of their own; the other links remain.
Result<std::vector<LinkSpheres>> approximate_named(const SpheresOptions& options,
                                                   Robot::Parts& parts) {
  std::vector<LinkSpheres> result;
  for (const std::string& text : options.link_excess) {
    const auto named = MNEME_TRY(parse_link_excess(text, parts));
    const auto& [link, excess] = named;
    SphereSettings settings = options.spheres;
    settings.excess = excess;
    auto made = MNEME_TRY(approximate_link(*link, settings));
    link->solids.clear();
    link->spheres.insert(link->spheres.end(), made.spheres.begin(), made.spheres.end());
    link->capsules.insert(link->capsules.end(), made.capsules.begin(), made.capsules.end());
    result.push_back(std::move(made));
  }
  return result;
}

Result<Made> make(const std::string& path, const SpheresOptions& options) {
  auto parts = MNEME_TRY(read_robot(path, options.reading));
  for (const std::string& warning : parts.warnings) print_warning(warning);
  auto named = approximate_named(options, parts);
  if (!named) return fail(named.error().code, fmt::format("{}: {}", path, named.error().message));
  auto robot = approximate_robot(std::move(parts), options.spheres, show_sphere_progress());
  if (!robot) {
    return fail(robot.error().code, fmt::format("{}: {}", path, robot.error().message));
  }
  for (const std::string& note : robot->notes) print_note(note);
  std::ranges::move(*named, std::back_inserter(robot->links));
  Made made{std::move(*robot), {}};
  if (options.srdf_output.empty()) return made;
  // The written robot has its spheres only.
  for (Link& link : made.robot.parts.links) link.approximation.reset();
  made.reasons = MNEME_TRY(allow_derived_pairs(made.robot.parts, options.pairs));
  return made;
}

Result<void> write(const Made& made, const SpheresOptions& options) {
  const std::string comment = fmt::format(
      "Collision geometry as spheres, made by mneme robot spheres with an excess of {} m, {} m at "
      "the tips, and at most {} spheres per link",
      options.spheres.excess, options.spheres.tip_excess, options.spheres.max_spheres);
  auto written = write_file(options.output, to_urdf(made.robot.parts, comment));
  if (!written || options.srdf_output.empty()) return written;
  const std::string srdf_comment = fmt::format(
      "Allowed pairs derived from {} samples by mneme robot spheres", options.pairs.samples);
  return write_file(options.srdf_output, to_srdf(made.robot.parts, made.reasons, srdf_comment));
}

std::size_t count_spheres(const Robot::Parts& parts) {
  std::size_t count = 0;
  for (const Link& link : parts.links) count += link.spheres.size();
  return count;
}

std::vector<std::pair<std::string, std::size_t>> count_reasons(
    const std::vector<std::string>& reasons) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const std::string reason : {"Adjacent", "Always", "Never", "Default", "User"}) {
    counts.emplace_back(reason, static_cast<std::size_t>(std::ranges::count(reasons, reason)));
  }
  return counts;
}

/// As "3 Adjacent, 1 Never".
std::string describe_reasons(const std::vector<std::string>& reasons) {
  std::string text;
  for (const auto& [reason, count] : count_reasons(reasons)) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, reason);
  }
  return text;
}

void print_table(const Made& made, const SpheresOptions& options) {
  fmt::print("{:<28} {:>7} {:>9} {:>13} {:>12}\n", "link", "spheres", "uncovered", "mean excess m",
             "max excess m");
  for (const LinkSpheres& link : made.robot.links) {
    fmt::print("{:<28} {:>7} {:>9.2g} {:>13.4f} {:>12.4f}\n", link.link, link.spheres.size(),
               link.uncovered, link.mean_excess, link.max_excess);
  }
  fmt::print("wrote {}: {}; {} of {} approximated\n", options.output,
             counted(count_spheres(made.robot.parts), "sphere", "spheres"), made.robot.links.size(),
             counted(made.robot.parts.links.size(), "link", "links"));
  if (options.srdf_output.empty()) return;
  fmt::print("wrote {}: {} ({})\n", options.srdf_output,
             counted(made.reasons.size(), "allowed pair", "allowed pairs"),
             describe_reasons(made.reasons));
}

Json to_json(const Made& made, const SpheresOptions& options) {
  Json links = Json::array();
  for (const LinkSpheres& link : made.robot.links) {
    links.push_back({{"name", link.link},
                     {"spheres", link.spheres.size()},
                     {"uncovered", link.uncovered},
                     {"mean_excess", link.mean_excess},
                     {"max_excess", link.max_excess}});
  }
  Json json = {{"path", options.output},
               {"name", made.robot.parts.name},
               {"spheres", count_spheres(made.robot.parts)},
               {"links", links},
               {"srdf_path", nullptr},
               {"allowed_pairs", nullptr}};
  if (options.srdf_output.empty()) return json;
  json["srdf_path"] = options.srdf_output;
  for (const auto& [reason, count] : count_reasons(made.reasons)) {
    json["allowed_pairs"][reason] = count;
  }
  return json;
}

Result<ExitCode> run_spheres(const SpheresOptions& options) {
  const std::string path = MNEME_TRY(robot_file(options.robot));
  const std::array outputs = {options.output, options.srdf_output};
  MNEME_TRY(check_files_to_write(outputs, robot_files(path, options.reading.srdf_path)));
  const Made made = MNEME_TRY(make(path, options));
  MNEME_TRY(write(made, options));
  if (options.is_json) {
    print_json(to_json(made, options));
  } else {
    print_table(made, options);
  }
  return ExitCode::done;
}

void add_pair_samples(CLI::App& command, PairSettings& pairs) {
  add_number(command, "--samples", pairs.samples, 1, 100'000'000,
             "random configurations that decide which pairs need no check");
}

}  // namespace

void add_robot_spheres(CLI::App& group, Action& action) {
  const auto options = std::make_shared<SpheresOptions>();
  CLI::App& command =
      add_command(group, action, "spheres", "Approximate boxes, cylinders and meshes by spheres",
                  "robot spheres arm.urdf -o arm_spheres.urdf --srdf-out arm_spheres.srdf", options,
                  run_spheres);
  command.add_option("ROBOT", options->robot, "URDF file or name of a robot")->required();
  command.add_option("-o,--output", options->output, "URDF file to write")->required();
  command.add_option("--srdf-out", options->srdf_output,
                     "SRDF file to write: groups, and pairs that need no check");
  command.add_option("--srdf", options->reading.srdf_path,
                     "SRDF with groups and pairs to keep (default: next to ROBOT)");
  add_reading_flags(command, options->reading);
  add_settings(command, options->spheres);
  command
      .add_option("--link-excess", options->link_excess,
                  "how far the spheres of one link may stick out, metres; repeatable")
      ->allow_extra_args(false)
      ->type_name("LINK=METRES");
  add_pair_samples(command, options->pairs);
  command.add_flag("--allow-rest", options->pairs.allow_at_rest,
                   "also allow pairs that touch where all joints are zero");
  add_json(command, options->is_json);
}

namespace {

struct SrdfOptions {
  std::string robot;
  std::string output = "-";
  RobotOptions reading;
  PairSettings pairs{.allow_at_rest = true, .is_exact = true};
};

Result<ExitCode> run_srdf(const SrdfOptions& options) {
  const std::string path = MNEME_TRY(robot_file(options.robot));
  if (options.output != "-") {
    const std::array outputs = {options.output};
    std::vector<ReadFile> inputs = robot_files(path, options.reading.srdf_path);
    // An SRDF beside the robot is an input only if there is one.
    std::erase_if(inputs, [](const ReadFile& file) { return !std::filesystem::exists(file.path); });
    MNEME_TRY(check_files_to_write(outputs, inputs));
  }
  const auto made =
      MNEME_TRY(derive_srdf(path, options.reading, options.pairs, show_sphere_progress()));
  for (const std::string& note : made.notes) print_note(note);
  print_note(fmt::format("{} ({})", counted(made.reasons.size(), "allowed pair", "allowed pairs"),
                         describe_reasons(made.reasons)));
  if (options.output == "-") {
    fmt::print("{}", made.text);
    return ExitCode::done;
  }
  MNEME_TRY(write_file(options.output, made.text));
  return ExitCode::done;
}

}  // namespace

void add_robot_srdf(CLI::App& group, Action& action) {
  const auto options = std::make_shared<SrdfOptions>();
  CLI::App& command =
      add_command(group, action, "srdf", "Find the pairs of links that need no check, as an SRDF",
                  "robot srdf arm.urdf -o arm.srdf", options, run_srdf);
  command.add_option("ROBOT", options->robot, "URDF file or name of a robot")->required();
  command.add_option("-o,--output", options->output,
                     "SRDF file to write (default: standard output)");
  command.add_option("--srdf", options->reading.srdf_path,
                     "SRDF with groups, states and pairs to keep (default: next to ROBOT)");
  add_reading_flags(command, options->reading);
  add_pair_samples(command, options->pairs);
  command.add_flag_callback(
      "--check-rest", [options] { options->pairs.allow_at_rest = false; },
      "check pairs that touch where all joints are zero");
}

}  // namespace mneme::app
