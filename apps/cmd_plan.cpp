// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme plan: solves one problem.
#include "mneme/benchmark.h"
#include "mneme/pipeline.h"
#include "mneme/report.h"
#include "mneme/task_file.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"
#include "problem_primitives.h"
#include "task_run.h"
#include "trajectory_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace mneme::app {
namespace {

/// Paths of the pictures and pages to write; empty for none.
struct PlanFiles {
  std::string svg;
  std::string view;
  std::string trace;
  std::string beside;  ///< a sampler whose plan the page shows beside

  /// True if the planner must be watched.
  [[nodiscard]] bool needs_recorder() const { return !view.empty() || !trace.empty(); }
};

bool can_draw(const Problem& problem) {
  if (!problem.robot.is_configuration(problem.start)) return false;
  return std::none_of(problem.goals.begin(), problem.goals.end(), [&](const Configuration& goal) {
    return !problem.robot.is_configuration(goal);
  });
}

Result<void> write_picture(const std::string& path, const Problem& problem,
                           const SolveResult& result) {
  if (!problem.robot.is_planar() && !result.plan.is_solved()) {
    print_note(fmt::format("'{}' was not written: there is no path", path));
    return {};
  }
  const auto svg = problem.robot.is_planar() ? to_svg(make_picture(problem, result))
                                             : to_svg(MovingPicture{&problem, result.plan.path});
  return svg.and_then([&](const std::string& text) { return write_file(path, text); });
}

/// A plan with everything that its page needs.
struct ShownPlan {
  const Problem& problem;
  const SolveResult& result;
  const PlanRecorder& recorder;
  double load_time_s = 0;
  TraceSettings settings = {};
  TimedPlan timed = {};

  [[nodiscard]] Result<std::string> to_trace() const {
    return make_trace(problem, result, &recorder, load_time_s, settings, timed)
        .map([](const PlanTrace& trace) { return to_json(trace); });
  }
};

Result<void> write_trace_and_page(const PlanFiles& files, const ShownPlan& shown,
                                  const std::string& beside) {
  const std::string json = MNEME_TRY(shown.to_trace());
  if (!files.trace.empty()) {
    if (auto written = write_file(files.trace, json + "\n"); !written) return written;
  }
  if (files.view.empty()) return {};
  return to_page(json, files.view, beside).and_then([&](const std::string& page) {
    return write_file(files.view, page);
  });
}

/// Writes the files; if start or goal is no configuration, a note says that there is nothing to
/// draw.
Result<void> write_plan_files(const PlanFiles& files, const ShownPlan& shown,
                              const std::string& beside) {
  if (!can_draw(shown.problem)) {
    for (const std::string& path : {files.svg, files.view, files.trace}) {
      if (path.empty()) continue;
      print_note(fmt::format("'{}' was not written: start or goal is no configuration", path));
    }
    return {};
  }
  Result<void> written;
  if (files.needs_recorder()) {
    written = write_trace_and_page(files, shown, beside);
  }
  if (files.svg.empty()) return written;
  const Result<void> drawn = write_picture(files.svg, shown.problem, shown.result);
  return written ? drawn : written;
}

struct PlanOptions {
  std::string problem;
  std::string robot;
  RobotOptions robot_options;
  std::optional<GivenConfiguration> start;
  std::optional<GivenConfiguration> goal;
  std::optional<std::vector<double>> start_velocity, end_velocity;
  std::vector<PoseGoal> goal_poses;
  std::vector<OrientationConstraint> upright;
  std::optional<double> self_filter;
  std::string db;
  DatabaseSettings kept;
  PlanFiles files;
  TrajectoryOptions trajectory;
  bool is_json = false;
  SolveSettings settings;
};

struct LoadedPlan {
  Problem problem;
  std::optional<Database> database;
  std::shared_ptr<const RateLimits> limits;  ///< of a trajectory, if one is wanted
  double load_time_s = 0;
};

Result<std::optional<Database>> open_memory_if_any(const PlanOptions& options,
                                                   const Problem& problem) {
  const SolveSettings& settings = options.settings;
  const bool is_off = settings.memory_mode == MemoryMode::off;
  if (is_off && (!options.db.empty() || settings.replay > 0 || settings.remember_after)) {
    print_note("--memory off: --db, --replay and --remember-after have no effect");
  }
  if (options.db.empty() || is_off) return std::nullopt;
  std::error_code ignored;
  if (!std::filesystem::exists(options.db, ignored)) {
    MNEME_TRY(check_query(problem, options.settings));
  }
  return open_memory(options.db, problem.robot, options.settings, options.kept)
      .map([](Database database) { return std::optional<Database>(std::move(database)); });
}

/// Refuses outputs that would replace an input, before anything is planned.
Result<void> check_files(const PlanOptions& options, const Problem& problem) {
  std::vector<ReadFile> inputs = {{"the memory", options.db},
                                  {"the file of limits", options.trajectory.limits}};
  add_problem_files("a file of the problem", problem, options.robot_options.srdf_path, inputs);
  const std::array outputs = {options.files.svg, options.files.view, options.files.trace,
                              options.trajectory.file};
  return check_files_to_write(outputs, inputs);
}

Result<LoadedPlan> load(const PlanOptions& options) {
  const Stopwatch stopwatch;
  ProblemOptions overrides = MNEME_TRY(problem_options(options.robot, options.robot_options));
  overrides.start = options.start;
  overrides.goal = options.goal;
  overrides.start_velocity = options.start_velocity;
  overrides.end_velocity = options.end_velocity;
  overrides.pose_goals = options.goal_poses;
  overrides.constraints = options.upright;
  overrides.self_filter = options.self_filter;
  Problem problem = MNEME_TRY(read_problem(options.problem, overrides));
  MNEME_TRY(check_files(options, problem));
  problem.robot = MNEME_TRY(narrow_positions(problem.robot, options.trajectory.limits));
  std::shared_ptr<const RateLimits> limits;
  if (options.trajectory.is_wanted()) {
    limits = std::make_shared<const RateLimits>(
        MNEME_TRY(find_rate_limits(problem.robot, options.trajectory.settings,
                                   options.trajectory.limits, options.robot_options.strict)));
    for (const std::string& warning : limits->warnings) print_warning(warning);
  }
  std::optional<Database> database = MNEME_TRY(open_memory_if_any(options, problem));
  return LoadedPlan{std::move(problem), std::move(database), std::move(limits),
                    stopwatch.elapsed_s()};
}

void print_memory(const Problem& problem, const SolveResult& result) {
  const std::string replay = describe_replay(problem, result.replay);
  if (!replay.empty()) fmt::print("known task  {}\n", printable(replay));
  if (result.replay.is_hit() || !needs_memory(result.sampler)) return;
  const GlSampler& gl = result.gl;
  if (gl.retrieval_time_s == 0) {
    const PlanStatus status = result.plan.status;
    const bool is_refused =
        status == PlanStatus::invalid_start || status == PlanStatus::invalid_goal;
    fmt::print("memory      not used: {}\n", is_refused ? "the query was refused before any search"
                                             : result.plan.is_solved()
                                                 ? "solved before --retrieve-after"
                                                 : "the search ended before --retrieve-after");
    return;
  }
  fmt::print("memory      {}, {} retrieved, {}\n",
             counted(gl.primitives.size(), "primitive", "primitives"),
             counted(gl.retrieved_count(), "sampler", "samplers"),
             counted(gl.mixture ? static_cast<std::size_t>(gl.mixture->component_count()) : 0,
                     "component", "components"));
  for (std::size_t i = 0; i < gl.primitives.size(); ++i) {
    const PrimitiveRetrieval& found = gl.primitives[i];
    fmt::print("  {}", describe(problem.scene, found.primitive, i));
    if (!found.primitive.is_whole_query) fmt::print(", gap {:.3f} m", found.primitive.gap);
    fmt::print(": {}", counted(found.matches.size(), "match", "matches"));
    if (!found.matches.empty()) {
      fmt::print(", similarity error {:.3f} to {:.3f} {}", found.matches.front().similarity_error,
                 found.matches.back().similarity_error, unit_of_error(found.primitive));
    }
    fmt::print("{}\n", found.is_learned ? ", learned just now" : "");
  }
}

void print_path(const PathMeasures& measures, const Path& path) {
  if (path.empty()) return;
  std::string clearance;
  if (measures.clearance) {
    clearance =
        fmt::format(", least clearance {:.1f} mm at {} and {}", 1e3 * measures.clearance->distance,
                    measures.clearance->link, measures.clearance->obstacle);
  }
  fmt::print("path        {} configurations, length {:.4f} (straight {:.4f}){}\n", path.size(),
             measures.length, measures.straight, printable(clearance));
  for (const Configuration& q : path) fmt::print("  {:.6f}\n", fmt::join(q, ","));
}

void print_result(const LoadedPlan& loaded, const SolveResult& result,
                  const PathMeasures& measures) {
  const PlanResult& plan = result.plan;
  fmt::print("{}: {}, sampler {}, seed {}, {}\n", to_string(plan.status), result.planner,
             result.sampler, result.seed, to_string(result.isa));
  print_preparation(result.preparation_time_s);
  fmt::print("planning    {:.3f} ms, of it retrieval {:.3f} ms and learning {:.3f} ms\n",
             1e3 * result.planning_time_s, 1e3 * result.gl.retrieval_time_s,
             1e3 * result.gl.learning_time_s);
  if (!loaded.problem.pose_goals.empty()) {
    fmt::print("goal        {} for {}, {:.3f} ms of planning\n",
               counted(result.goals.size(), "configuration", "configurations"),
               counted(loaded.problem.pose_goals.size(), "pose", "poses"),
               1e3 * result.goal_time_s);
  }
  fmt::print("afterwards  simplification {:.3f} ms, verification {:.3f} ms\n",
             1e3 * plan.simplification_time_s, 1e3 * plan.verification_time_s);
  if (result.improvement_time_s > 0) {
    // Without --improve, paths of trajectories are improved a little, and nothing is counted.
    const std::size_t paths = result.improvements.size();
    fmt::print("improved    {}in {:.3f} ms\n",
               paths > 0 ? counted(paths - 1, "time ", "times ") : "",
               1e3 * result.improvement_time_s);
  }
  fmt::print("in all      {:.3f} ms, after {:.3f} ms of loading\n", 1e3 * result.total_time_s,
             1e3 * loaded.load_time_s);
  fmt::print("search      {} samples, {} nodes, {} states and {} motions checked\n",
             plan.iterations, plan.nodes, plan.states_checked, plan.motions_checked);
  if (loaded.database) print_memory(loaded.problem, result);
  if (result.remembered.is_queued) {
    fmt::print("remembered  queued in {:.3f} ms\n", 1e3 * result.remembered.time_s);
  }
  print_path(measures, plan.path);
}

/// Nothing if none is wanted, or if there is no path.
Result<std::optional<Trajectory>> time_path(const PlanOptions& options, const LoadedPlan& loaded,
                                            const SolveSettings& settings, const Path& path) {
  if (!options.trajectory.is_wanted()) return std::nullopt;
  if (path.empty()) {
    print_note(fmt::format("'{}' was not written: there is no path", options.trajectory.file));
    return std::nullopt;
  }
  return make_trajectory(loaded.problem, settings, path, *loaded.limits,
                         options.trajectory.settings)
      .map([](Trajectory timed) { return std::optional(std::move(timed)); });
}

/// Measures the path; without its clearance if that takes long, as beside meshes of many thousand
/// triangles, or once interrupted.
PathMeasures measure_in_time(const Robot& robot, const Scene& scene, const Path& path) {
  constexpr double kLongest_s = 1;
  try {
    const Stopwatch stopwatch;
    const InterruptScope scope(
        [&] { return interrupt_flag()->load() || stopwatch.elapsed_s() > kLongest_s; });
    return measure_path(robot, scene, path);
  } catch (const Interrupted&) {
    print_note(interrupt_flag()->load()
                   ? "the least clearance is not measured: interrupted"
                   : "the least clearance is not measured: that takes too long in this scene");
    return measure_path(robot, {}, path);
  }
}

void print_answer(const PlanOptions& options, const LoadedPlan& loaded, const SolveResult& result,
                  const std::optional<Trajectory>& trajectory) {
  const PathMeasures measures = measure_in_time(
      loaded.problem.robot, checked_scene(loaded.problem, result), result.plan.path);
  if (options.is_json) {
    std::optional<MotionMeasures> motion;
    if (trajectory) motion = measure_motion(*trajectory, *loaded.limits);
    fmt::print("{}\n", to_json(loaded.problem, result, loaded.load_time_s, &measures,
                               motion ? &*motion : nullptr));
  } else {
    print_result(loaded, result, measures);
    if (trajectory) fmt::print("motion      {:.3f} s\n", trajectory->duration_s());
  }
  for (const std::string& note : result.notes) print_note(note);
  if (result.plan.is_solved() && options.settings.plan.improve > 0) note_interrupted("the path");
  if (!result.plan.is_solved()) print_error(result.plan.message);
  if (!result.remembered.failure.empty()) {
    print_note("the path was not remembered: " + result.remembered.failure);
  }
}

/// True if all queued rows were made and stored and none of them is new. Rows are made within
/// milliseconds; one that waits longer, such as for a locked file, counts as new.
bool teaches_nothing(Database& database) {
  constexpr double kWait_s = 0.5;
  const bool is_done = database.flush(kWait_s).has_value();
  const QueuedRows rows = database.queued_rows();
  return is_done && rows.stored == 0 && rows.lost == 0;
}

/// Plans a file with stages instead of goals.
Result<ExitCode> run_stages(const PlanOptions& options) {
  const bool has_goal = options.goal || !options.goal_poses.empty();
  if (has_goal) print_note("--goal and --goal-pose have no effect: the file has stages");
  const PlanFiles& files = options.files;
  if (!files.svg.empty() || !files.trace.empty() || !files.beside.empty()) {
    print_note("--svg, --trace and --beside have no effect on a task");
  }
  if (options.end_velocity) {
    return fail(ErrorCode::unsupported,
                "--end-velocity: a task ends at rest; plan the motion after it by itself");
  }
  TaskRunOptions task;
  task.file = options.problem;
  task.reading = MNEME_TRY(problem_options(options.robot, options.robot_options));
  task.reading.start = options.start;
  task.reading.start_velocity = options.start_velocity;
  task.reading.constraints = options.upright;
  task.reading.self_filter = options.self_filter;
  task.robot = options.robot_options;
  task.db = options.db;
  task.kept = options.kept;
  task.view = files.view;
  task.trajectory = options.trajectory;
  task.is_json = options.is_json;
  task.settings.solve = options.settings;
  return run_task(task);
}

/// Prints a note if the sampler lacks a database, or the database has no use.
void note_unused_memory(const PlanOptions& options, bool has_database) {
  const SolveSettings& settings = options.settings;
  const bool samples_memory = needs_memory(settings.sampler);
  if (samples_memory && options.db.empty()) {
    print_note(fmt::format("without --db there is no memory: the sampler '{}' is uniform",
                           settings.sampler));
  }
  if (has_database && !samples_memory && !(settings.replay > 0) && !settings.remember_after) {
    print_note(
        fmt::format("--db has no effect: the sampler '{}' uses no memory; --replay 0.5 "
                    "tries known tasks all the same",
                    settings.sampler));
  }
}

Result<ExitCode> run_plan(const PlanOptions& options) {
  if (is_task_file(options.problem)) return run_stages(options);
  LoadedPlan loaded = MNEME_TRY(load(options));
  SolveSettings settings = options.settings;
  settings.plan.cancel = interrupt_flag();
  settings.plan.limits = loaded.limits;
  note_unused_memory(options, loaded.database.has_value());
  PlanRecorder recorder;
  if (options.files.needs_recorder()) settings.plan.observer = &recorder;
  Database* database = loaded.database ? &*loaded.database : nullptr;
  SolveResult result = MNEME_TRY(solve(loaded.problem, database, settings));
  if (result.remembered.is_queued) result.remembered.is_queued = !teaches_nothing(*database);

  // An error of the trajectory is reported last: the path is still valid.
  const auto timed = time_path(options, loaded, settings, result.plan.path);
  print_answer(options, loaded, result, timed ? *timed : std::nullopt);
  if (result.remembered.is_queued) store_remembered(*database, "the path was");
  ShownPlan shown{loaded.problem, result, recorder, loaded.load_time_s};
  shown.settings.package_paths = options.robot_options.package_paths;
  if (timed && *timed) shown.timed = {&**timed, loaded.limits.get()};
  std::string beside;
  if (!options.files.beside.empty()) {
    settings.sampler = options.files.beside;
    beside = MNEME_TRY(plan_and_trace(loaded.problem, database, settings, shown.settings));
  }
  MNEME_TRY(write_plan_files(options.files, shown, beside));
  if (!timed) return tl::unexpected(timed.error());
  if (*timed) {
    MNEME_TRY(write_trajectory(options.trajectory, loaded.problem.robot, **timed));
  }
  return exit_code(result.plan.status);
}

void add_problem_flags(CLI::App& command, PlanOptions& options) {
  begin_rare_flags(command, "Problem");
  command
      .add_option("PROBLEM", options.problem, "YAML file, also one with stages, or FILE.json#NAME")
      ->required();
  add_other_robot(command, options.robot, options.robot_options);
  add_configuration(command, "--start", options.start, "start instead of the problem's");
  add_configuration(command, "--goal", options.goal, "goal instead of the problem's");
  command
      .add_option("--start-velocity", options.start_velocity,
                  "velocity of each joint at the start, rad/s or m/s: the path begins with the "
                  "motion in which the robot can stop (default: at rest)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("X,X,..");
  command
      .add_option("--end-velocity", options.end_velocity,
                  "velocity of each joint at the goal, rad/s or m/s: the path ends with the motion "
                  "in which the robot gets it (default: at rest)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("X,X,..");
  add_poses(
      command, "--goal-pose", options.goal_poses,
      "pose of a link instead of the problem's goals, in the frame of the problem's scene; any "
      "rotation without the quaternion; repeatable, also with --goal: the path ends at any one");
  add_upright(command, options.upright);
  command
      .add_option(
          "--self-filter", options.self_filter,
          "drop points of clouds within this distance of the robot at its start, metres; 0: only "
          "those in contact (default: none)")
      ->type_name("X");
  add_database(command, options.db, options.kept,
               "database: an SQLite file or postgresql://...; created if planning adds to it");
}

void add_solve_flags(CLI::App& command, PlanOptions& options) {
  SolveSettings& settings = options.settings;
  begin_rare_flags(command, "Planner");
  add_choice(command, "--planner", "planner", settings.planner, planner_names(),
             fmt::format("planner (default {})", settings.planner));
  add_choice(command, "--sampler", "sampler", settings.sampler, sampler_names(),
             "source of configurations (default gl with --db, uniform without)");
  add_settings(command, settings.plan);
  add_isa(command);
  begin_rare_flags(command, "Memory");
  const auto read_mode = [&settings](const std::string& name) {
    const auto mode = parse_memory_mode(name);
    if (!mode) throw CLI::ValidationError("--memory", mode.error().message);
    settings.memory_mode = *mode;
  };
  add_text(command, "--memory", read_mode,
           "use of memory: auto, off, or paper: all settings as in the paper (default auto)")
      ->type_name("MODE");
  add_settings(command, settings);
  add_memory_settings(command, settings.memory);
  for (const char* flag : {"--learn-budget", "--remember-after", "--replay"}) {
    command.get_option(flag)->needs("--db");
  }
  begin_rare_flags(command, "Learning");
  add_settings(command, settings.learn);
  begin_rare_flags(command, "Inverse kinematics");
  add_settings(command, settings.ik);
}

void add_output_flags(CLI::App& command, PlanOptions& options) {
  begin_rare_flags(command, "Output");
  command.add_option("--view", options.files.view,
                     "write a page that shows the plan in any browser, also offline");
  add_choice(command, "--beside", "sampler", options.files.beside, sampler_names(),
             "show a second plan, with this sampler, beside that of --view")
      ->needs("--view");
  command.add_option("--svg", options.files.svg,
                     "write a picture of the plan; of a robot in space, the moving path");
  command.add_option("--trace", options.files.trace,
                     "write what the page shows as JSON, for 'mneme view' and other programs");
  for (const char* flag : {"--view", "--svg", "--trace"}) {
    command.get_option(flag)->check([](const std::string& path) {
      return std::string(path.empty() ? "expected the name of a file, got an empty one" : "");
    });
  }
  add_trajectory_flags(command, options.trajectory);
  add_json(command, options.is_json);
}

/// The flags that --help shows.
const std::vector<FlagGroup> kUsualFlags = {
    {"Usual", {"help", "help-all", "db", "memory", "timeout", "improve", "seed"}},
    {"Problem", {"robot", "group", "start", "goal"}},
    {"Output", {"view", "trajectory", "json"}},
};

void choose_sampler(const CLI::App& command, PlanOptions& options) {
  if (command.count("--sampler") > 0) {
    const std::string& name = options.settings.sampler;
    const bool is_default = name == SolveSettings().sampler;  // it then samples uniformly
    if (options.db.empty() && !is_default && needs_memory(name)) {
      throw CLI::ValidationError("--sampler", name + " needs a database: --db FILE");
    }
    return;
  }
  const bool has_memory = !options.db.empty() && options.settings.memory_mode != MemoryMode::off;
  options.settings.sampler = has_memory ? "gl" : "uniform";
}

}  // namespace

void add_plan(CLI::App& program, Action& action) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = add_command(program, action, "plan", "Solve a motion planning problem",
                                  "plan scenes/shelf/thin.yaml --view plan.html", options, run_plan,
                                  choose_sampler);
  add_problem_flags(command, *options);
  add_solve_flags(command, *options);
  add_output_flags(command, *options);
  show_flags(command, kUsualFlags);
}

}  // namespace mneme::app
