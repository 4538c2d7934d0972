// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme view: makes a page of a trace, or a page that plans in the browser.
#include "mneme/live.h"
#include "mneme/report.h"

#include "commands.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace mneme::app {
namespace {

struct ViewOptions {
  std::string trace;
  std::string beside;
  std::string page;
  std::string live;
  std::string problem;
  std::string robot;
  RobotOptions robot_options;
};

Result<ExitCode> write_page(const std::string& path, const std::string& page) {
  return write_file(path, page).map([&] {
    fmt::print("{}\n", path);
    return ExitCode::done;
  });
}

Result<ExitCode> show_trace(const ViewOptions& options) {
  const std::array<ReadFile, 2> inputs = {
      {{"the trace", options.trace}, {"the trace beside it", options.beside}}};
  Result<std::string> beside = "";
  if (!options.beside.empty()) beside = read_file(options.beside, kMaxTraceBytes);
  if (!beside) return tl::unexpected(beside.error());
  return check_outputs(std::array{options.page}, inputs)
      .and_then([&] { return read_file(options.trace, kMaxTraceBytes); })
      .and_then([&](const std::string& json) { return to_page(json, options.trace, *beside); })
      .and_then([&](const std::string& page) { return write_page(options.page, page); });
}

/// The problem, or the robot at rest, which is its goal, too: a problem file needs one.
Result<Problem> load_first(const ViewOptions& options) {
  if (options.problem.empty()) {
    return load_named_robot(options.robot, options.robot_options).map([&](const Robot& robot) {
      Problem resting = resting_problem(robot, robot_file(options.robot).value_or(""));
      resting.goals = {resting.start};
      return resting;
    });
  }
  return problem_options(options.robot, options.robot_options).and_then([&](const auto& overrides) {
    return read_problem(options.problem, overrides);
  });
}

Result<ExitCode> plan_in_page(const ViewOptions& options) {
  const auto module = MNEME_TRY(find_planner_module());
  const auto problem = MNEME_TRY(load_first(options));
  std::vector<ReadFile> inputs;
  add_problem_files("the problem", problem, options.robot_options.srdf_path, inputs);
  MNEME_TRY(check_outputs(std::array{options.live}, inputs));
  TraceSettings looks;
  looks.package_paths = options.robot_options.package_paths;
  return make_offline_page(problem, module, looks).and_then([&](const std::string& page) {
    return write_page(options.live, page);
  });
}

Result<ExitCode> run_view(const ViewOptions& options) {
  return options.live.empty() ? show_trace(options) : plan_in_page(options);
}

void check_view(const CLI::App&, ViewOptions& options) {
  using CLI::ValidationError;
  const bool is_live = !options.live.empty();
  const bool has_trace = !options.trace.empty(), has_page = !options.page.empty();
  if (!is_live && !has_trace) throw ValidationError("TRACE", "expected a trace, or --live PAGE");
  if (!is_live && !has_page) throw ValidationError("--output", "expected the page to write");
  if (is_live && (has_trace || has_page)) {
    throw ValidationError("--live", "needs no trace and no -o: its page makes plans of its own");
  }
  if (is_live && options.problem.empty() && options.robot.empty()) {
    throw ValidationError("--live", "needs --problem, --robot or both");
  }
}

}  // namespace

void add_view(CLI::App& program, Action& action) {
  const auto options = std::make_shared<ViewOptions>();
  CLI::App& command = add_command(
      program, action, "view", "Make a page from a saved trace, or one that plans in the browser",
      "plan scenes/planar/scenario1.yaml --trace s1.json\n"
      "  mneme view s1.json -o s1.html\n"
      "  mneme view --live fetch.html --problem scenes/shelf/thick.yaml",
      options, run_view, check_view);
  command.add_option("TRACE", options->trace, "file of 'mneme plan --trace'");
  CLI::Option* beside =
      command.add_option("--beside", options->beside,
                         "trace of another plan of the same problem, shown beside the first");
  command.add_option("-o,--output", options->page, "page to write; it needs no other file");
  CLI::Option* live = command.add_option(
      "--live", options->live,
      "page to write that plans by itself, in a browser without a network: goal and obstacles are "
      "dragged. Needs the WebAssembly module that script/wasm builds");
  live->excludes(beside);
  command
      .add_option("--problem", options->problem,
                  "problem that the live page begins with: YAML file, or FILE.json#NAME")
      ->needs(live);
  command.add_option("--robot", options->robot, "URDF file or name of the live page's robot")
      ->needs(live);
  add_robot_flags(command, options->robot_options);
}

}  // namespace mneme::app
