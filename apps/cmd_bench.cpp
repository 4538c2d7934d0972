// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme bench: plans many problems and measures.
#include "mneme/benchmark.h"
#include "mneme/report.h"

#include "bench_output.h"
#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "learning_run.h"
#include "options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <sstream>

namespace mneme::app {
namespace {

struct BenchOptions {
  std::vector<std::string> arguments;
  std::string part;
  std::string robot;
  RobotOptions robot_options;
  std::vector<std::string> planners = {"rrt_connect"};
  std::vector<std::string> samplers;
  int seed_count = 1;
  std::string db;
  DatabaseSettings kept;
  std::string csv;
  std::string out;
  std::string memories;
  std::vector<std::string> suite_settings;
  int jobs = 1;
  bool is_suite = false;
  bool has_seeds = false;
  bool has_timeout = false;
  bool is_resumed = false;
  bool is_cold = false;
  bool is_json = false;
  SolveSettings settings;
};

Result<void> check_files(const BenchOptions& options, const std::vector<LoadedProblem>& problems) {
  std::vector<ReadFile> inputs = {{"the memory", options.db}};
  for (const auto& [set, problem] : problems) {
    add_problem_files("a file of a problem", problem, options.robot_options.srdf_path, inputs);
  }
  return check_outputs(std::array{options.csv}, inputs);
}

Result<std::vector<LoadedProblem>> load_problems(const BenchOptions& options) {
  const auto found = MNEME_TRY(find_bench_problems(options.arguments, options.part));
  const auto overrides = MNEME_TRY(problem_options(options.robot, options.robot_options));
  auto loaded = MNEME_TRY(load_bench_problems(found, overrides, print_note));
  MNEME_TRY(check_files(options, loaded));
  return loaded;
}

Result<void> open_memories(const BenchOptions& options, BenchPlan& plan) {
  if (options.db.empty() || std::ranges::none_of(options.samplers, needs_memory)) return {};
  for (const LoadedProblem& loaded : plan.problems) {
    const Robot& robot = loaded.problem.robot;
    const std::pair key{options.db, robot.hash()};
    if (plan.memories.contains(key)) continue;
    Database database = MNEME_TRY(open_memory(options.db, robot, options.settings, options.kept));
    plan.memories.emplace(key, std::make_shared<Database>(std::move(database)));
  }
  return {};
}

Result<BenchPlan> make_plan(const BenchOptions& options) {
  BenchPlan plan;
  plan.problems = MNEME_TRY(load_problems(options));
  BenchCase base;
  base.memory = options.db;
  base.settings = options.settings;
  base.description = describe_settings(options.settings);
  append_cases(base, options.planners, options.samplers, plan.cases);
  plan.seed_count = options.seed_count;
  plan.first_seed = options.settings.plan.seed;
  plan.jobs = options.jobs;
  plan.is_cold = options.is_cold;
  plan.cancel = interrupt_flag();
  MNEME_TRY(open_memories(options, plan));
  return plan;
}

Result<ExitCode> run_problems(const BenchOptions& options) {
  BenchPlan plan = MNEME_TRY(make_plan(options));
  RowFile file;
  MNEME_TRY(file.open(options.csv, options.is_resumed));
  const bool is_complete = MNEME_TRY(run_bench(plan, file, show_rows()));
  print_bench_results(file.rows(), options.is_json);
  if (is_complete) return judge_rows(file.rows());
  print_note(options.csv.empty() ? "interrupted"
                                 : "interrupted; continue with the same command and --resume");
  return ExitCode::interrupted;
}

Result<ExitCode> run_suite_command(const BenchOptions& options) {
  const SuiteRun run{
      options.arguments.front(),
      options.out,
      options.memories,
      options.has_seeds ? std::optional(options.seed_count) : std::nullopt,
      options.has_timeout ? std::optional(options.settings.plan.timeout_s) : std::nullopt,
      options.suite_settings,
      options.jobs,
      options.is_resumed,
      options.is_cold};
  const SuiteResult result = MNEME_TRY(
      run_suite(run, SuiteHooks{print_note, watch_learning, show_rows(), interrupt_flag()}));
  print_bench_results(result.rows, options.is_json);
  if (!result.is_complete) {
    print_note("interrupted; continue with the same command and --resume");
    return ExitCode::interrupted;
  }
  print_note(fmt::format("the report is {}", result.report));
  return judge_rows(result.rows);
}

/// A flag for a comma-separated list of different `names`.
void add_name_list(CLI::App& command, const std::string& flag, const std::string& what,
                   std::vector<std::string>& values, const std::vector<std::string>& names,
                   const std::string& help) {
  const auto read = [=, &values](const std::string& text) {
    values.clear();
    std::istringstream items(text);
    for (std::string item; std::getline(items, item, ',');) {
      if (std::find(names.begin(), names.end(), item) == names.end()) {
        throw CLI::ValidationError(flag, fmt::format("unknown {} '{}': expected some of {}", what,
                                                     item, fmt::join(names, ",")));
      }
      if (std::find(values.begin(), values.end(), item) == values.end()) values.push_back(item);
    }
    if (values.empty())
      throw CLI::ValidationError(flag, fmt::format("needs at least one {}", what));
  };
  add_text(command, flag, read, fmt::format("{}: {}", help, fmt::join(names, ", ")))
      ->type_name("NAME,..");
}

void add_run_flags(CLI::App& command, BenchOptions& options) {
  add_problem_list(command, options.arguments, options.part,
                   ", or one suite (YAML with the key problems)");
  add_other_robot(command, options.robot, options.robot_options);
  add_name_list(command, "--planners", "planner", options.planners, planner_names(),
                "planners (default rrt_connect)");
  add_name_list(command, "--samplers", "sampler", options.samplers, sampler_names(),
                "sources of configurations (default uniform, with --db gl,uniform)");
  add_number(command, "--seeds", options.seed_count, 1, 1000000,
             "runs of each case, with seeds from --seed on");
  add_database(command, options.db, options.kept, "database for the sampler gl: an SQLite file");
  command.add_option("--csv", options.csv,
                     "file for one row per run, written while it runs; replaced if it exists");
  command.add_flag("--resume", options.is_resumed,
                   "keep the rows of --csv (for a suite: of --out) and run only the others");
  command.add_flag("--cold", options.is_cold,
                   "time runs cold: check each path before the next run, which evicts caches. "
                   "Default: the runs of a problem follow each other and are checked afterwards");
  add_number(command, "--jobs", options.jobs, 1, 4096,
             "runs at a time; more than there are idle cores make times longer");
  command.add_option(
      "--out", options.out,
      "output directory of a suite (default out/bench/NAME): runs.csv, report.html and its "
      "figures, logs for OMPL");
  command.add_option(
      "--memories", options.memories,
      "directory of the memories that a suite learns (default: memories in --out); existing "
      "ones are used");
  command
      .add_option("--setting", options.suite_settings,
                  "run only this setting of a suite; repeatable")
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_settings(command, options.settings);
  add_settings(command, options.settings.plan);
  add_memory_settings(command, options.settings.memory);
  add_settings(command, options.settings.learn);
  add_isa(command);
  add_json(command, options.is_json);
}

/// Refuses flags that a suite's file decides.
void check_suite_flags(const CLI::App& command) {
  const std::vector<std::string> allowed = {"PROBLEMS", "--seeds", "--timeout", "--resume",
                                            "--jobs",   "--out",   "--json",    "--memories",
                                            "--isa",    "--help",  "--setting", "--cold"};
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    const bool is_allowed = std::find(allowed.begin(), allowed.end(), name) != allowed.end();
    if (option->count() == 0 || is_allowed) continue;
    throw CLI::ValidationError(name,
                               "cannot be combined with a suite, whose file says what it runs");
  }
}

/// Refuses flags that no run would heed, although rows would name them.
void check_memory_flags(const CLI::App& command, const BenchOptions& options) {
  for (const char* flag : {"--learn-budget", "--remember-after", "--replay"}) {
    if (command.count(flag) == 0) continue;
    if (options.db.empty()) throw CLI::RequiresError(flag, "--db");
    if (std::ranges::none_of(options.samplers, needs_memory)) {
      throw CLI::ValidationError(flag, "needs a sampler that uses the memory, such as gl");
    }
  }
}

void check_problem_flags(const CLI::App& command, BenchOptions& options) {
  if (options.samplers.empty()) {
    options.samplers = options.db.empty() ? std::vector<std::string>{"uniform"}
                                          : std::vector<std::string>{"gl", "uniform"};
  }
  const auto drawing = std::ranges::find_if(options.samplers, needs_memory);
  if (drawing != options.samplers.end() && options.db.empty()) {
    throw CLI::ValidationError("--samplers", *drawing + " needs a database: --db FILE");
  }
  if (options.is_resumed && options.csv.empty()) {
    throw CLI::ValidationError("--resume", "needs --csv, the file with the earlier rows");
  }
  if (options.jobs > 1 && learns_while_planning(options.settings)) {
    throw CLI::ValidationError(
        "--jobs",
        "must be 1 with --learn-budget or --remember-after: later runs depend on earlier ones");
  }
  check_memory_flags(command, options);
  for (const auto& [flag, is_given] : {std::pair("--out", !options.out.empty()),
                                       std::pair("--memories", !options.memories.empty()),
                                       std::pair("--setting", !options.suite_settings.empty())}) {
    if (is_given) throw CLI::ValidationError(flag, "needs a suite");
  }
}

void check_bench_flags(const CLI::App& command, BenchOptions& options) {
  options.is_suite = options.arguments.size() == 1 && is_suite_file(options.arguments.front());
  if (!options.is_suite) return check_problem_flags(command, options);
  check_suite_flags(command);
  options.has_seeds = command.count("--seeds") > 0;
  options.has_timeout = command.count("--timeout") > 0;
}

Result<ExitCode> run(const BenchOptions& options) {
  return options.is_suite ? run_suite_command(options) : run_problems(options);
}

}  // namespace

void add_bench(CLI::App& program, Action& action) {
  CLI::App& group = add_group(program, "bench", "Plan many problems and measure",
                              "bench run problems.json --seeds 10 --csv runs.csv");
  const auto options = std::make_shared<BenchOptions>();
  CLI::App& command = add_command(
      group, action, "run", "Run problems x planners x samplers x seeds",
      "bench run problems/ --planners rrt_connect,prm --seeds 10 --timeout 4 "
      "--csv runs.csv\n  mneme bench run bench/suites/planar.yaml --seeds 5 --timeout 2",
      options, run, check_bench_flags);
  add_run_flags(command, *options);
  add_bench_report(group, action);
}

}  // namespace mneme::app
