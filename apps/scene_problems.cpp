// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene threaded, enclosed, composed, blocked, repeat: compact files of random problems,
/// with a path or a proof that there is none.
#include "mneme/benchmark.h"
#include "mneme/instances.h"
#include "mneme/planning.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostProblems = 1000000;
constexpr int kMostEnclosed = 100000;
constexpr int kMaxBoxes = 100000;
constexpr std::uint64_t kProofIterations = 100000;
constexpr double kMostMetres = 10;
constexpr int kMostLinks = 1000;
constexpr int kMostPassages = 8;

/// Options of all commands.
struct GeneratorOptions {
  std::string robot;
  RobotOptions robot_options;
  std::string output;
  std::uint64_t seed = 1;
  int count = 0;
  bool is_json = false;
};

std::string absolute_path(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// The robot's name, or its absolute path, so that the file can be read from anywhere.
std::string robot_reference(const std::string& robot) {
  const bool is_name = robot.find('/') == std::string::npos && !robot.ends_with(".urdf");
  return is_name ? robot : absolute_path(robot);
}

/// From start to goal of a generated instance.
template <class Instance>
Problem problem_of(const GeneratorOptions& options, const std::string& name, const Robot& robot,
                   const Instance& instance) {
  return {.name = name,
          .robot = robot,
          .scene = instance.scene,
          .start = instance.start,
          .goals = {instance.goal},
          .srdf_path = options.robot_options.srdf_path};
}

/// Appends `problem` to a file of problems of one robot; returns its entry.
Json& append_problem(const Problem& problem, const std::string& robot, Json& file) {
  Json one = Json::parse(to_compact_json(problem, robot_reference(robot)));
  if (file.is_null()) {
    file = std::move(one);
    if (!problem.srdf_path.empty()) file["srdf"] = absolute_path(problem.srdf_path);
  } else {
    file["problems"].push_back(std::move(one["problems"][0]));
  }
  return file["problems"].back();
}

/// True after an interrupt that came before the first problem: an earlier file is not replaced.
bool is_cut_off(const Json& file) {
  const bool has_problems = file.contains("problems") && !file.at("problems").empty();
  return interrupt_flag()->load() && !has_problems;
}

/// Writes the file, then prints `summary` with the file's name, or the sentence.
Result<ExitCode> write_problems(const GeneratorOptions& options, const Json& file, Json summary,
                                const std::string& sentence) {
  if (is_cut_off(file)) {
    print_note("interrupted before the first problem; nothing is written");
    return ExitCode::interrupted;
  }
  if (options.output == "-") {
    fmt::print("{}\n", file.dump());
  } else {
    MNEME_TRY(write_file(options.output, file.dump() + "\n"));
    summary["file"] = options.output;
    if (options.is_json) print_json(summary);
    if (!options.is_json) fmt::print("{}\n", sentence);
  }
  return interrupt_flag()->load() ? ExitCode::interrupted : ExitCode::done;
}

/// Makes a generator react to an interrupt and show its progress.
void watch(const GeneratorOptions& options, Progress& progress, GeneratorRun& run) {
  run.cancel = interrupt_flag();
  run.on_progress = [&](int made, int dropped) {
    progress.update(made, options.count, fmt::format("{} dropped", dropped));
  };
}

struct ThreadedOptions : GeneratorOptions {
  std::array<double, 2> depth = {3, 5};
  ThreadedSettings settings;
};

/// The range as whole numbers from 1 to `most`; otherwise a usage error.
std::array<int, 2> whole_range(const std::string& flag, const std::array<double, 2>& range,
                               int most) {
  const auto is_whole = [](double value) { return value == std::floor(value); };
  const bool is_range = range[0] >= 1 && range[0] <= range[1] && range[1] <= most;
  if (!is_range || !std::ranges::all_of(range, is_whole)) {
    throw CLI::ValidationError(
        flag, fmt::format("{}:{} is no range LEAST:MOST of whole numbers from 1 to {}", range[0],
                          range[1], most));
  }
  return {static_cast<int>(range[0]), static_cast<int>(range[1])};
}

void check_threaded(const CLI::App&, ThreadedOptions& options) {
  options.settings.depth = whole_range("--depth", options.depth, kMostLinks);
}

Json to_json(const ThreadedOptions& options, const ThreadedInstances& made) {
  Json problems = Json::array();
  for (const ThreadedInstance& instance : made.instances) {
    problems.push_back({{"name", fmt::format("s{}_{:04}", options.seed, problems.size())},
                        {"circles", instance.circles},
                        {"start", instance.start},
                        {"goal", instance.goal},
                        {"gap", instance.gap},
                        {"depth", instance.depth},
                        {"witness", instance.witness}});
  }
  return {{"robot", robot_reference(options.robot)},
          {"generator", kThreadedVersion},
          {"seed", options.seed},
          {"gap", options.settings.gap},
          {"depth", options.settings.depth},
          {"passages", options.settings.passages},
          {"dropped", made.dropped},
          {"problems", problems}};
}

Result<ExitCode> run_threaded(const ThreadedOptions& given) {
  ThreadedOptions options = given;
  const Robot robot = MNEME_TRY(load_named_robot(options.robot, {}, std::array{options.output}));
  Progress progress("threading");
  watch(options, progress, options.settings);
  const auto made =
      MNEME_TRY(make_threaded_instances(robot, options.count, options.settings, options.seed));
  return write_problems(options, to_json(options, made),
                        {{"generator", kThreadedVersion},
                         {"instances", made.instances.size()},
                         {"dropped", made.dropped}},
                        fmt::format("{} instances in {}, {} dropped that the proof did not solve",
                                    made.instances.size(), options.output, made.dropped));
}

struct EnclosedOptions : GeneratorOptions {
  EnclosedSettings settings;
};

/// Each problem with its witness.
Json to_json(const EnclosedOptions& options, const Robot& robot, const EnclosedInstances& made) {
  Json file;
  for (std::size_t i = 0; i < made.instances.size(); ++i) {
    const EnclosedInstance& instance = made.instances[i];
    const std::string name = fmt::format("e{}_{:04}", options.seed, i);
    const Problem problem = problem_of(options, name, robot, instance);
    append_problem(problem, options.robot, file)["witness"] = instance.witness;
  }
  file["generator"] = kEnclosedVersion;
  return file;
}

/// Makes the instances of a robot with `make` and writes them. `where` completes "20 instances".
template <class Options, class Make>
Result<ExitCode> make_and_write(Options options, const char* activity, std::string_view version,
                                const Make& make, std::string_view where) {
  const Robot robot =
      MNEME_TRY(load_named_robot(options.robot, options.robot_options, std::array{options.output}));
  Progress progress(activity);
  watch(options, progress, options.settings);
  const auto made = MNEME_TRY(make(robot, options.count, options.settings, options.seed));
  const std::size_t count = made.instances.size();
  return write_problems(
      options, to_json(options, robot, made),
      {{"generator", version}, {"instances", count}, {"dropped", made.dropped}},
      fmt::format("{}{}{}", counted(count, "instance", "instances"), where, options.output));
}

Result<ExitCode> run_enclosed(const EnclosedOptions& options) {
  return make_and_write(options, "enclosing", kEnclosedVersion, make_enclosed_instances, " in ");
}

struct BlockedOptions : GeneratorOptions {
  GeneratorRun settings;
};

/// Each problem with the proof that it has no path.
Json to_json(const BlockedOptions& options, const Robot& robot, const BlockedInstances& made) {
  Json file;
  for (std::size_t i = 0; i < made.instances.size(); ++i) {
    const BlockedInstance& instance = made.instances[i];
    const std::string name = fmt::format("b{}_{:04}", options.seed, i);
    const Problem problem = problem_of(options, name, robot, instance);
    append_problem(problem, options.robot, file)["blocked"] = {
        {"joint", instance.joint}, {"angles", instance.angles}, {"link", instance.link}};
  }
  file["generator"] = kBlockedVersion;
  return file;
}

Result<ExitCode> run_blocked(const BlockedOptions& options) {
  return make_and_write(options, "blocking", kBlockedVersion, make_blocked_instances,
                        " without a path in ");
}

struct ComposedOptions : GeneratorOptions {
  std::string lessons, foreign;  ///< files of modules; empty: not written
  std::array<double, 2> passages = {1, 3};
  ComposedSettings settings;
};

void check_composed(const CLI::App&, ComposedOptions& options) {
  ComposedSettings& settings = options.settings;
  settings.passages = whole_range("--passages", options.passages, kMostPassages);
  if (settings.modules < settings.passages[1]) {
    throw CLI::ValidationError("--modules",
                               fmt::format("{} are fewer than the {} of --passages in one problem",
                                           settings.modules, settings.passages[1]));
  }
}

Json to_json(const ComposedInstance& instance) {
  Json parts = Json::array();
  for (const ComposedPart& part : instance.parts) {
    parts.push_back(
        {{"module", part.module}, {"turn", part.turn}, {"is_reversed", part.is_reversed}});
  }
  return parts;
}

/// Each problem with its witness and its modules.
Json to_json(const ComposedOptions& options, const Robot& robot, const ComposedInstances& made) {
  Json file;
  for (std::size_t i = 0; i < made.instances.size(); ++i) {
    const ComposedInstance& instance = made.instances[i];
    const std::string name = fmt::format("c{}_{:04}_{}", options.seed, i, instance.parts.size());
    const Problem problem = problem_of(options, name, robot, instance);
    Json& entry = append_problem(problem, options.robot, file);
    entry["witness"] = instance.witness;
    entry["parts"] = to_json(instance);
  }
  file["generator"] = kComposedVersion;
  return file;
}

/// A problem per module: its motion alone, from end to end.
Json modules_to_json(const ComposedOptions& options, const Robot& robot,
                     std::span<const ComposedModule> modules) {
  Json file;
  for (std::size_t i = 0; i < modules.size(); ++i) {
    const ComposedModule& module = modules[i];
    const std::string name = fmt::format("m{}_{:04}", options.seed, i);
    const Problem problem{.name = name,
                          .robot = robot,
                          .scene = module.scene,
                          .start = module.motion.front(),
                          .goals = {module.motion.back()},
                          .srdf_path = options.robot_options.srdf_path};
    append_problem(problem, options.robot, file)["witness"] = module.motion;
  }
  file["generator"] = kComposedVersion;
  return file;
}

Result<ExitCode> run_composed(const ComposedOptions& given) {
  ComposedOptions options = given;
  std::vector<std::string> outputs = {options.output};
  for (const std::string& file : {options.lessons, options.foreign}) {
    if (!file.empty()) outputs.push_back(file);
  }
  if (!options.foreign.empty()) options.settings.foreign = options.settings.modules;
  const Robot robot = MNEME_TRY(load_named_robot(options.robot, options.robot_options, outputs));
  Progress progress("composing");
  watch(options, progress, options.settings);
  const auto made =
      MNEME_TRY(make_composed_instances(robot, options.count, options.settings, options.seed));
  const auto own =
      std::min(made.modules.size(), static_cast<std::size_t>(options.settings.modules));
  const std::span<const ComposedModule> modules = made.modules;
  const Json problems = to_json(options, robot, made);
  const bool is_written = !is_cut_off(problems);
  if (is_written && !options.lessons.empty()) {
    const Json file = modules_to_json(options, robot, modules.first(own));
    MNEME_TRY(write_file(options.lessons, file.dump() + "\n"));
  }
  if (is_written && !options.foreign.empty()) {
    const Json file = modules_to_json(options, robot, modules.subspan(own));
    MNEME_TRY(write_file(options.foreign, file.dump() + "\n"));
  }
  return write_problems(
      options, problems,
      {{"generator", kComposedVersion},
       {"instances", made.instances.size()},
       {"modules", own},
       {"dropped", made.dropped}},
      fmt::format("{} of {} in {}, {} candidates dropped",
                  counted(made.instances.size(), "instance", "instances"),
                  counted(own, "module", "modules"), options.output, made.dropped));
}

struct RepeatOptions : GeneratorOptions {
  std::vector<std::string> problems;
  std::string part;
  int tasks = 20;
  RepeatSettings settings;
};

/// An error, with the reason, unless the problem has a path.
Result<void> prove(const Problem& problem) {
  const auto checker = MNEME_TRY(CollisionChecker::make(problem.robot, problem.scene));
  PlanSettings settings;
  settings.max_iterations = kProofIterations;
  const PlanResult proof = plan_with(rrt_connect, checker, {problem.start, problem.goals},
                                     *make_uniform_sampler(problem.robot), settings);
  if (proof.is_solved()) return {};
  return fail(ErrorCode::invalid, fmt::format("problem '{}': {}", problem.name, proof.message));
}

/// The first problems that have a path.
Result<std::vector<Problem>> choose_tasks(const RepeatOptions& options) {
  const auto overrides = MNEME_TRY(problem_options(options.robot, options.robot_options));
  const auto found = MNEME_TRY(find_bench_problems(options.problems, options.part));
  auto problems = MNEME_TRY(load_lesson_problems(found, overrides, print_note));
  std::vector<Problem> tasks;
  for (Problem& problem : problems) {
    if (std::ssize(tasks) == options.tasks) break;
    if (const auto proven = prove(problem)) {
      tasks.push_back(std::move(problem));
    } else {
      print_note("excluded: " + proven.error().message);
    }
  }
  if (std::ssize(tasks) == options.tasks) return tasks;
  return fail(ErrorCode::invalid, fmt::format("--tasks: expected {} problems with a path, got {}; "
                                              "name more problems, or fewer tasks",
                                              options.tasks, tasks.size()));
}

/// Tasks alternate, as they do in a cell.
Result<Json> make_repeats(const RepeatOptions& options, const std::vector<Problem>& tasks) {
  Json file;
  Progress progress("repeating");
  for (int i = 1; i <= options.count && !interrupt_flag()->load(); ++i) {
    for (std::size_t task = 0; task < tasks.size(); ++task) {
      Rng rng(derive_seed(derive_seed(options.seed, task), static_cast<std::uint64_t>(i)));
      Problem repeated = MNEME_TRY(repeat(tasks[task], options.settings, rng));
      repeated.name = fmt::format("t{:02}_{:04}", task + 1, i);
      append_problem(repeated, repeated.robot_path, file);
    }
    progress.update(i, options.count, "");
  }
  return file;
}

Result<ExitCode> run_repeat(const RepeatOptions& options) {
  const auto tasks = MNEME_TRY(choose_tasks(options));
  std::vector<ReadFile> inputs;
  for (const Problem& task : tasks) {
    add_problem_files("a file of a problem", task, options.robot_options.srdf_path, inputs);
  }
  MNEME_TRY(check_files_to_write(std::array{options.output}, inputs));
  const Json file = MNEME_TRY(make_repeats(options, tasks));
  const std::size_t problems = file.is_null() ? 0 : file.at("problems").size();
  return write_problems(options, file,
                        {{"seed", options.seed}, {"tasks", tasks.size()}, {"problems", problems}},
                        fmt::format("{} of {} in {}", counted(problems, "problem", "problems"),
                                    counted(tasks.size(), "task", "tasks"), options.output));
}

/// Adds a command with the flags that all generators have; the robot is `options.robot`.
template <class Options>
CLI::App& add_generator(CLI::App& group, Action& action, const std::string& name,
                        const std::string& sentence, const std::string& example,
                        const std::shared_ptr<Options>& options,
                        Result<ExitCode> (*run)(const Options&), int most,
                        void (*check)(const CLI::App&, Options&) = nullptr) {
  CLI::App& command = add_command(group, action, name, sentence, example, options, run, check);
  command.add_option("-o,--output", options->output, "compact file to write, - to print it")
      ->required();
  add_seed(command, options->seed, "seed; problem number n depends on it and on n only");
  add_number(command, "-n,--count", options->count, 1, most,
             "number of problems; of 'repeat': number per task");
  add_isa(command);
  add_json(command, options->is_json);
  return command;
}

}  // namespace

void add_scene_threaded(CLI::App& group, Action& action) {
  const auto options = std::make_shared<ThreadedOptions>();
  options->robot = "planar8";
  options->count = 100;
  CLI::App& command = add_generator(
      group, action, "threaded", "Write random problems of a planar arm in a gap, proven feasible",
      "scene threaded --robot planar8 --seed 1 -n 100 --gap 0.1:0.3 --depth 3:5 -o threaded.json",
      options, run_threaded, kMostProblems, check_threaded);
  command.add_option("--robot", options->robot, "planar arm: URDF file or name (default planar8)");
  add_range(command, "--gap", options->settings.gap, "distance of the two circles, metres");
  add_range(command, "--depth", options->depth,
            "number of links from the first one in the gap to the last");
  add_number(command, "--passages", options->settings.passages, 1, 3,
             "number of gaps. 1: at the start; 2: also at the goal; 3: one more in reach");
}

void add_scene_enclosed(CLI::App& group, Action& action) {
  const auto options = std::make_shared<EnclosedOptions>();
  options->robot = "panda";
  options->count = 20;
  CLI::App& command = add_generator(
      group, action, "enclosed", "Write random problems whose path is enclosed by boxes",
      "scene enclosed --robot panda --seed 1 -n 20 --clearance 0.01 --boxes 600 -o enclosed.json",
      options, run_enclosed, kMostEnclosed);
  command.add_option("--robot", options->robot, "URDF file or name (default panda)");
  add_robot_flags(command, options->robot_options);
  add_number(command, "--clearance", options->settings.clearance, 1e-4, 1,
             "least distance between the boxes and the known path, metres");
  add_number(command, "--boxes", options->settings.boxes, 1, kMaxBoxes,
             "boxes around the path, if there is room");
  add_range(command, "--size", options->settings.size, "full extents of a box, metres");
  add_number(command, "--through", options->settings.through, 0, 100,
             "random configurations on the path");
}

void add_scene_composed(CLI::App& group, Action& action) {
  const auto options = std::make_shared<ComposedOptions>();
  options->robot = "panda";
  options->count = 20;
  CLI::App& command = add_generator(
      group, action, "composed",
      "Write random problems that consist of passages, and the passages alone",
      "scene composed --robot panda --seed 1 -n 30 --modules 12 --passages 1:3 -o composed.json "
      "--lessons lessons.json",
      options, run_composed, kMostEnclosed, check_composed);
  command.add_option("--robot", options->robot, "URDF file or name (default panda)");
  add_robot_flags(command, options->robot_options);
  ComposedSettings& settings = options->settings;
  command.add_option("--lessons", options->lessons,
                     "compact file to write: each module that problems contain, alone");
  command.add_option("--foreign", options->foreign,
                     "compact file to write: as many modules that no problem contains");
  add_number(command, "--modules", settings.modules, 1, 1000, "modules to compose");
  add_range(command, "--passages", options->passages, "modules in a problem");
  add_number(command, "--clearance", settings.clearance, 1e-4, 1,
             "least distance between a module's boxes and the known path, metres");
  add_number(command, "--open", settings.open, 1e-4, 1,
             "distance that boxes keep to the rest of the known path, metres");
  add_number(command, "--boxes", settings.boxes, 1, kMaxBoxes,
             "boxes of a module, if there is room");
  add_range(command, "--size", settings.size, "full extents of a box, metres");
}

void add_scene_blocked(CLI::App& group, Action& action) {
  const auto options = std::make_shared<BlockedOptions>();
  options->robot = "panda";
  options->count = 100;
  CLI::App& command = add_generator(group, action, "blocked",
                                    "Write random problems without a path, each with a proof",
                                    "scene blocked --robot panda --seed 1 -n 100 -o blocked.json",
                                    options, run_blocked, kMostEnclosed);
  command.add_option("--robot", options->robot, "URDF file or name (default panda)");
  add_robot_flags(command, options->robot_options);
}

void add_scene_repeat(CLI::App& group, Action& action) {
  const auto options = std::make_shared<RepeatOptions>();
  options->count = 500;
  CLI::App& command = add_generator(
      group, action, "repeat", "Write the tasks of a cell again and again with small changes",
      "scene repeat problems.json --tasks 20 -n 500 --obstacles 0.02 --goal 0.03 -o repeats.json",
      options, run_repeat, kMostProblems);
  add_problem_list(command, options->problems, options->part);
  add_other_robot(command, options->robot, options->robot_options);
  add_number(command, "--tasks", options->tasks, 1, kMostProblems,
             "number of tasks: the first problems that have a path");
  RepeatSettings& changes = options->settings;
  add_number(command, "--obstacles", changes.obstacles, 0, kMostMetres,
             "largest displacement of each obstacle, metres");
  add_number(command, "--goal", changes.goal, 0, kMostMetres,
             "largest displacement of the tip at the goal, metres");
  add_number(command, "--base", changes.base, 0, kMostMetres,
             "largest displacement of the robot's base, metres");
  add_number(command, "--turn", changes.turn, 0, std::numbers::pi,
             "largest rotation of the robot's base, radians");
}

}  // namespace mneme::app
