// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task_run.h"

#include "mneme/report.h"
#include "mneme/task_file.h"

#include "console.h"
#include "inputs.h"
#include "options.h"
#include "task_page.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

namespace mneme::app {
namespace {

Result<Task> read_task(const TaskRunOptions& options) {
  ProblemOptions reading = options.reading;
  reading.on_approximated = show_sphere_progress();
  Task task = MNEME_TRY(load_task(options.file, reading));
  for (const std::string& warning : task.warnings) print_warning(warning);
  std::vector<ReadFile> inputs = {{"the task", options.file},
                                  {"the memory", options.db},
                                  {"the file of limits", options.trajectory.limits}};
  add_files("a file of the task", task.files, inputs);
  MNEME_TRY(check_files_to_write(std::array{options.view, options.trajectory.file}, inputs));
  task.robot = MNEME_TRY(narrow_positions(task.robot, options.trajectory.limits));
  return task;
}

void print_dropped(const StageResult& stage) {
  for (const Dropped& dropped : stage.dropped) {
    fmt::print("    dropped {}: {}{}\n", dropped.count, to_string(dropped.reason),
               dropped.what.empty() ? "" : printable(fmt::format(", {}", dropped.what)));
  }
}

void print_stages(const TaskResult& result) {
  std::size_t width = 0;
  for (const StageResult& stage : result.stages) width = std::max(width, stage.name.size());
  for (const StageResult& stage : result.stages) {
    fmt::print("  {:<{}}  {:<7}", printable(stage.name), width, to_string(stage.kind));
    if (stage.path.size() > 1) {
      fmt::print(" {:6.3f} s  {:2} configurations", stage.path_time_s, stage.path.size());
    }
    if (stage.alternative >= 0 && stage.alternatives > 1) {
      fmt::print("  choice {} of {}", stage.alternative + 1, stage.alternatives);
    }
    fmt::print("\n");
    print_dropped(stage);
  }
}

void print_answer(const TaskRunOptions& options, const Task& task, const TaskResult& result,
                  const TaskMotion* motion) {
  if (options.is_json) {
    fmt::print("{}\n", to_json(task, result, motion));
  } else {
    fmt::print("{}: {}, seed {}\n", to_string(result.status),
               counted(task.stages.size(), "stage", "stages"), options.settings.solve.plan.seed);
    print_preparation(result.preparation_time_s);
    if (result.is_solved()) {
      fmt::print("planning    {:.3f} ms to the first plan, {:.3f} ms in all\n",
                 1e3 * result.first_plan_time_s,
                 1e3 * (result.total_time_s - result.preparation_time_s));
      fmt::print("path time   {:.3f} s at the velocity limits", result.path_time_s);
      if (result.plans > 1) {
        fmt::print(", the best of {} plans, the first {:.3f} s", result.plans,
                   result.first_path_time_s);
      }
      fmt::print("\n");
    }
    fmt::print("search      {} states checked\n", result.states_checked);
    if (result.remembered_rows > 0) {
      fmt::print("memory      {} ranked the alternatives\n",
                 counted(result.remembered_rows, "plan", "plans"));
    }
    print_stages(result);
  }
  for (const std::string& note : result.notes) print_note(note);
  const bool is_improved = options.settings.improve > 0 || options.settings.solve.plan.improve > 0;
  if (result.is_solved() && is_improved) note_interrupted("the plan");
  if (!result.is_solved()) print_error(result.message);
}

Result<void> write_files(const TaskRunOptions& options, const Task& task, const TaskResult& result,
                         const TaskMotion& motion, const RateLimits& limits) {
  if (options.trajectory.is_wanted()) {
    MNEME_TRY(write_trajectory(options.trajectory, task.robot, motion.trajectory,
                               stage_begins(result, motion)));
  }
  if (options.view.empty()) return {};
  TraceSettings shown;
  shown.waypoints = 2 * shown.waypoints;
  shown.package_paths = options.robot.package_paths;
  const PlanTrace trace = MNEME_TRY(
      trace_task(result, motion, limits, options.settings.solve, options.trajectory, shown));
  return to_page(to_json(trace), options.view).and_then([&](const std::string& page) {
    return write_file(options.view, page);
  });
}

struct TimedTask {
  TaskMotion motion;
  RateLimits limits;
};

Result<RateLimits> limits_of(const TaskRunOptions& options, const Task& task) {
  return find_rate_limits(task.robot, options.trajectory.settings, options.trajectory.limits,
                          options.robot.strict);
}

Result<TimedTask> time_plan(const TaskRunOptions& options, const Task& task,
                            const TaskResult& result, const SolveSettings& settings) {
  RateLimits limits = MNEME_TRY(limits_of(options, task));
  for (const std::string& warning : limits.warnings) print_warning(warning);
  TaskMotion motion = MNEME_TRY(time_task(task, result, settings, limits,
                                          options.trajectory.settings, options.trajectory.limits));
  return TimedTask{std::move(motion), std::move(limits)};
}

}  // namespace

Result<ExitCode> run_task(const TaskRunOptions& options) {
  const Task task = MNEME_TRY(read_task(options));
  TaskSettings settings = options.settings;
  settings.solve.plan.cancel = interrupt_flag();
  if (!task.start_velocity.empty()) {  // they say where the robot can stop
    settings.solve.plan.limits =
        std::make_shared<const RateLimits>(MNEME_TRY(limits_of(options, task)));
  }
  std::optional<Database> database;
  const bool is_off = settings.solve.memory_mode == MemoryMode::off;
  if (!options.db.empty() && !is_off) {
    database = MNEME_TRY(
        open_memory(options.db, task.robot.without_attached(), settings.solve, options.kept));
  }
  const TaskResult result = MNEME_TRY(solve_task(task, database ? &*database : nullptr, settings));
  if (result.is_remembered) store_remembered(*database, "the choices were");
  const bool needs_motion = options.trajectory.is_wanted() || !options.view.empty();
  if (!result.is_solved() || !needs_motion) {
    print_answer(options, task, result, nullptr);
    for (const std::string& file : {options.view, options.trajectory.file}) {
      if (!file.empty()) print_note(fmt::format("'{}' was not written: there is no plan", file));
    }
    return exit_code(result.status);
  }
  // An error of the motion is reported last: the plan is still valid.
  const Result<TimedTask> timed = time_plan(options, task, result, settings.solve);
  print_answer(options, task, result, timed ? &timed->motion : nullptr);
  if (!timed) return tl::unexpected(timed.error());
  if (!options.is_json) fmt::print("motion      {:.3f} s\n", timed->motion.trajectory.duration_s());
  MNEME_TRY(write_files(options, task, result, timed->motion, timed->limits));
  return exit_code(result.status);
}

}  // namespace mneme::app
