// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene repeat: tasks of a cell, each again and again with small changes.
#include "mneme/benchmark.h"
#include "mneme/instances.h"
#include "mneme/planning.h"

#include "commands.h"
#include "console.h"
#include "files.h"
#include "inputs.h"
#include "lessons.h"
#include "options.h"
#include "problem_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <limits>
#include <memory>
#include <numbers>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostProblems = 1000000;
constexpr std::uint64_t kProofIterations = 100000;
constexpr double kMostMetres = 10;

struct RepeatOptions {
  std::vector<std::string> problems;
  std::string part;
  std::string output;
  std::string robot;
  RobotOptions robot_options;
  std::uint64_t seed = 1;
  int tasks = 20;
  int count = 500;
  RepeatSettings settings;
  bool is_json = false;
};

/// Why a problem is no task, or nothing: start or goal is in contact, or there is no path.
Result<void> prove(const Problem& problem) {
  const auto checker = CollisionChecker::make(problem.robot, problem.scene);
  if (!checker) return tl::unexpected(checker.error());
  PlanSettings settings;
  settings.max_iterations = kProofIterations;
  const PlanResult proof = plan_with(rrt_connect, *checker, {problem.start, problem.goals},
                                     *make_uniform_sampler(problem.robot), settings);
  if (proof.is_solved()) return {};
  return fail(ErrorCode::invalid, fmt::format("problem '{}': {}", problem.name, proof.message));
}

/// The first problems that have a path.
Result<std::vector<Problem>> choose_tasks(const RepeatOptions& options) {
  const auto overrides = problem_options(options.robot, options.robot_options);
  if (!overrides) return tl::unexpected(overrides.error());
  auto problems = load_problem_lesson(options.problems, options.part, *overrides);
  if (!problems) return problems;
  std::vector<Problem> tasks;
  for (Problem& problem : *problems) {
    if (std::ssize(tasks) == options.tasks) break;
    if (const auto proven = prove(problem)) {
      tasks.push_back(std::move(problem));
    } else {
      print_note("left out: " + proven.error().message);
    }
  }
  if (std::ssize(tasks) == options.tasks) return tasks;
  return fail(ErrorCode::invalid, fmt::format("--tasks: expected {} tasks with a path, "
                                              "got {}",
                                              options.tasks, tasks.size()));
}

Result<void> check_output(const RepeatOptions& options, const std::vector<Problem>& tasks) {
  std::vector<ReadFile> inputs;
  for (const Problem& task : tasks) {
    add_problem_files("a file of a problem", task, options.robot_options.srdf_path, inputs);
  }
  return check_files_to_write(std::array{options.output}, inputs);
}

/// Tasks take turns, as they do in a cell.
Result<Json> make_repeats(const RepeatOptions& options, const std::vector<Problem>& tasks) {
  Json file;
  Progress progress("repeating");
  for (int i = 1; i <= options.count && !interrupt_flag()->load(); ++i) {
    for (std::size_t task = 0; task < tasks.size(); ++task) {
      Rng rng(derive_seed(derive_seed(options.seed, task), static_cast<std::uint64_t>(i)));
      auto repeated = repeat(tasks[task], options.settings, rng);
      if (!repeated) return tl::unexpected(repeated.error());
      repeated->name = fmt::format("t{:02}_{:04}", task + 1, i);
      append_problem(*repeated, repeated->robot_path, file);
    }
    progress.update(i, options.count, "");
  }
  return file;
}

Result<ExitCode> run(const RepeatOptions& options) {
  const auto tasks = choose_tasks(options);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto checked = check_output(options, *tasks); !checked) {
    return tl::unexpected(checked.error());
  }
  const Result<Json> file = make_repeats(options, *tasks);
  if (!file) return tl::unexpected(file.error());
  const auto written = write_file(options.output, file->dump() + "\n");
  if (!written) return tl::unexpected(written.error());
  const std::size_t problems = file->is_null() ? 0 : file->at("problems").size();
  if (options.is_json) {
    print_json({{"seed", options.seed},
                {"tasks", tasks->size()},
                {"problems", problems},
                {"file", options.output}});
  } else {
    fmt::print("{} of {} in {}\n", counted(problems, "problem", "problems"),
               counted(tasks->size(), "task", "tasks"), options.output);
  }
  return interrupt_flag()->load() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

void add_scene_repeat(CLI::App& group, Action& action) {
  const auto options = std::make_shared<RepeatOptions>();
  CLI::App* command = group.add_subcommand(
      "repeat", "Write the tasks of a cell, each again and again with small changes");
  command->footer(
      "Example:\n  mneme scene repeat problems.json --tasks 20 -n 500 --obstacles 0.02 --goal 0.03 "
      "-o repeats.json");
  command
      ->add_option(
          "PROBLEMS", options->problems,
          "compact files, problems (FILE.json#NAME, YAML) or directories of them; those in "
          "contact are left out")
      ->required();
  command->add_option("--part", options->part,
                      "I/N: every N-th problem beginning with the I-th, such as 2/2");
  command->add_option("--robot", options->robot,
                      "robot to use instead of the problems': a URDF file or a name");
  add_robot_flags(*command, options->robot_options);
  command->add_option("-o,--output", options->output, "compact problem file to write")->required();
  add_number(*command, "--tasks", options->tasks, 1, kMostProblems,
             "of the problems, the first ones");
  add_number(*command, "-n,--count", options->count, 1, kMostProblems, "problems per task");
  add_number(*command, "--obstacles", options->settings.obstacles, 0, kMostMetres,
             "metres that each obstacle is moved at most");
  add_number(*command, "--goal", options->settings.goal, 0, kMostMetres,
             "metres that the tip of the arm is moved at most at the goal");
  add_number(*command, "--base", options->settings.base, 0, kMostMetres,
             "metres that the robot's base stands elsewhere at most");
  add_number(*command, "--turn", options->settings.turn, 0, std::numbers::pi,
             "radians that the robot's base is turned at most");
  add_number(*command, "--seed", options->seed, 0, std::numeric_limits<std::uint64_t>::max(),
             "seed of all random numbers; the n-th repeat of a task depends on it and on n alone");
  add_json(*command, options->is_json);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace mneme::app
