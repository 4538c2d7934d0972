// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme bench: plans many problems and tells how long it took.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "mneme/report.h"

#include "bench_problems.h"
#include "bench_runs.h"
#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "interrupt.h"
#include "options.h"
#include "problem_part.h"

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct BenchOptions {
  std::vector<std::string> arguments;
  std::string part;
  std::string robot;
  RobotOptions robot_options;
  std::vector<std::string> planners = {"rrt_connect"};
  std::vector<std::string> samplers;
  int seed_count = 1;
  std::string db;
  std::string csv;
  bool is_resumed = false;
  bool is_json = false;
  SolveSettings settings;
};

/// The rows of a benchmark, on disk as they come.
class RowFile {
 public:
  /// Opens `path`, if it is not empty, for the rows to come; with `is_resumed` those that it holds
  /// are kept.
  Result<void> open(const std::string& path, bool is_resumed) {
    if (path.empty()) return {};
    path_ = path;
    if (is_resumed) {
      const Result<void> read = read_rows();
      if (!read) return read;
    }
    file_.open(path, is_resumed ? std::ios::app : std::ios::trunc);
    if (rows_.empty() && !has_header_) file_ << csv_header();
    return flush();
  }

  Result<void> add(const BenchmarkRow& row) {
    rows_.push_back(row);
    if (path_.empty()) return {};
    file_ << to_csv_line(row);
    return flush();
  }

  [[nodiscard]] const std::vector<BenchmarkRow>& rows() const { return rows_; }

 private:
  Result<void> read_rows() {
    std::error_code missing;
    if (!std::filesystem::exists(path_, missing)) return {};
    std::stringstream text;
    text << std::ifstream(path_, std::ios::binary).rdbuf();
    Result<CsvRuns> runs = parse_csv(text.str(), path_);
    if (!runs) return tl::unexpected(runs.error());
    has_header_ = runs->complete_bytes > 0;
    rows_ = std::move(runs->rows);
    std::error_code error;
    std::filesystem::resize_file(path_, runs->complete_bytes, error);
    if (error)
      return fail(ErrorCode::io, fmt::format("cannot write '{}': {}", path_, error.message()));
    return {};
  }

  Result<void> flush() {
    if (file_.flush()) return {};
    return fail(ErrorCode::io, fmt::format("cannot write '{}': {}", path_, std::strerror(errno)));
  }

  std::string path_;
  std::ofstream file_;
  std::vector<BenchmarkRow> rows_;
  bool has_header_ = false;
};

Result<void> check_same_limit(const std::vector<BenchmarkRow>& rows, double timeout_s) {
  for (const BenchmarkRow& row : rows) {
    if (row.timeout_s == timeout_s) continue;
    return fail(ErrorCode::invalid,
                fmt::format("cannot resume: a run there had a time limit of {} s, not {} s",
                            row.timeout_s, timeout_s));
  }
  return {};
}

Result<std::vector<LoadedProblem>> load_problems(const BenchOptions& options) {
  const auto found = find_bench_problems(options.arguments).and_then([&](auto all) {
    return take_part(std::move(all), options.part);
  });
  if (!found) return tl::unexpected(found.error());
  const Result<ProblemOptions> overrides = problem_options(options.robot, options.robot_options);
  if (!overrides) return tl::unexpected(overrides.error());
  std::vector<LoadedProblem> problems;
  std::set<std::string> warnings;
  for (const BenchProblem& bench : *found) {
    Result<Problem> problem = load_problem(bench.where, *overrides);
    if (!problem) return tl::unexpected(problem.error());
    for (const std::string& warning : problem->warnings) {
      if (warnings.insert(warning).second) print_note("warning: " + warning);
    }
    problems.push_back({bench.set, std::move(*problem)});
  }
  return problems;
}

Result<void> open_memories(const BenchOptions& options, BenchPlan& plan) {
  const bool has_gl = std::count(plan.samplers.begin(), plan.samplers.end(), "gl") > 0;
  if (options.db.empty() || !has_gl) return {};
  for (const LoadedProblem& loaded : plan.problems) {
    const Robot& robot = loaded.problem.robot;
    if (plan.memories.count(robot.hash()) > 0) continue;
    Result<Database> database = open_memory(options.db, robot, options.settings);
    if (!database) return tl::unexpected(database.error());
    plan.memories.emplace(robot.hash(), std::move(*database));
  }
  return {};
}

Result<BenchPlan> make_plan(const BenchOptions& options) {
  Result<std::vector<LoadedProblem>> problems = load_problems(options);
  if (!problems) return tl::unexpected(problems.error());
  BenchPlan plan;
  plan.problems = std::move(*problems);
  plan.planners = options.planners;
  plan.samplers = options.samplers;
  plan.seed_count = options.seed_count;
  plan.settings = options.settings;
  const Result<void> opened = open_memories(options, plan);
  if (!opened) return tl::unexpected(opened.error());
  return plan;
}

Json to_json(const SetSummary& summary) {
  return {{"set", summary.set},
          {"planner", summary.planner},
          {"sampler", summary.sampler},
          {"solved", summary.times.solved},
          {"valid", summary.valid},
          {"total", summary.total},
          {"invalid_paths", summary.invalid_paths},
          {"planning_p50_s", summary.times.p50},
          {"planning_p95_s", summary.times.p95},
          {"planning_p99_s", summary.times.p99},
          {"planning_max_s", summary.times.max},
          {"iterations_p50", summary.iterations_p50},
          {"simplification_p50_s", summary.simplification_p50_s}};
}

/// "cage#7" once for each problem whose ends are invalid.
std::vector<std::string> invalid_problems(const std::vector<BenchmarkRow>& rows) {
  std::vector<std::string> names;
  for (const BenchmarkRow& row : rows) {
    const std::string name = row.set + "#" + row.problem;
    const bool is_new = std::find(names.begin(), names.end(), name) == names.end();
    if (is_invalid_problem(row) && is_new) names.push_back(name);
  }
  return names;
}

void print_results(const std::vector<BenchmarkRow>& rows, bool is_json) {
  const std::vector<SetSummary> summaries = summarize_sets(rows);
  const std::vector<std::string> invalid = invalid_problems(rows);
  if (!is_json) {
    fmt::print("{}", to_table(summaries));
    if (!invalid.empty()) {
      fmt::print("invalid start or goal, left out: {}\n", fmt::join(invalid, ", "));
    }
    return;
  }
  Json sets = Json::array();
  for (const SetSummary& summary : summaries) sets.push_back(to_json(summary));
  print_json({{"runs", rows.size()},
              {"isa", to_string(default_isa())},
              {"sets", sets},
              {"invalid", invalid}});
}

ExitCode judge(const std::vector<BenchmarkRow>& rows) {
  const auto wrong = std::count_if(rows.begin(), rows.end(), [](const BenchmarkRow& row) {
    return row.is_solved && !row.is_path_valid;
  });
  if (wrong == 0) return ExitCode::done;
  print_error(fmt::format("{} did not survive the check at ten times the resolution",
                          counted(static_cast<std::size_t>(wrong), "path", "paths")));
  return ExitCode::failure;
}

Result<ExitCode> run_bench_command(const BenchOptions& options) {
  Result<BenchPlan> plan = make_plan(options);
  if (!plan) return tl::unexpected(plan.error());
  catch_interrupts();
  RowFile file;
  const Result<void> opened = file.open(options.csv, options.is_resumed).and_then([&] {
    return check_same_limit(file.rows(), options.settings.plan.timeout_s);
  });
  if (!opened) return tl::unexpected(opened.error());
  const std::vector<BenchmarkRow> done = file.rows();
  Result<bool> is_complete = false;
  {
    Progress progress("planning");
    const auto total = static_cast<std::int64_t>(plan->run_count());
    is_complete = run_bench(*plan, done, [&](const BenchmarkRow& row) {
      progress.update(static_cast<std::int64_t>(file.rows().size()) + 1, total,
                      fmt::format("{}#{} {}", row.set, row.problem, to_string(row.status)));
      return file.add(row);
    });
  }
  if (!is_complete) return tl::unexpected(is_complete.error());
  print_results(file.rows(), options.is_json);
  if (*is_complete) return judge(file.rows());
  print_note(options.csv.empty() ? "interrupted"
                                 : "interrupted; the same command with --resume goes on from here");
  return ExitCode::interrupted;
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
  add_text(command, flag, read, fmt::format("{}: {}", help, fmt::join(names, ",")))
      ->type_name("NAME,..");
}

void add_run_flags(CLI::App& command, BenchOptions& options) {
  command
      .add_option("PROBLEMS", options.arguments,
                  "compact files, problems (FILE.json#NAME, YAML) or directories of them")
      ->required();
  command.add_option("--part", options.part,
                     "I/N: every N-th problem beginning with the I-th, such as 2/2");
  command.add_option("--robot", options.robot,
                     "robot to use instead of the problems': a URDF file or a name");
  add_robot_flags(command, options.robot_options);
  std::vector<std::string> names;
  for (const PlannerEntry& planner : planners()) names.emplace_back(planner.name);
  add_name_list(command, "--planners", "planner", options.planners, names,
                "planners (default rrt_connect)");
  add_name_list(command, "--samplers", "sampler", options.samplers,
                {sampler_names().begin(), sampler_names().end()},
                "sources of configurations (default uniform, with --db gl,uniform)");
  add_number(command, "--seeds", options.seed_count, 1, 1000000,
             "runs of each, with seeds from --seed on");
  command.add_option("--db", options.db, "memory of the sampler gl: an SQLite file");
  command.add_option("--csv", options.csv,
                     "file for one row per run, written while it runs; replaced if it exists");
  command.add_flag("--resume", options.is_resumed,
                   "keep the rows of --csv and run only what is missing");
  add_settings(command, options.settings);
  add_settings(command, options.settings.plan);
  add_decompose_settings(command, options.settings.decompose);
  add_settings(command, options.settings.learn);
  add_isa(command);
  add_json(command, options.is_json);
}

void check_run_flags(BenchOptions& options) {
  if (options.samplers.empty()) {
    options.samplers = options.db.empty() ? std::vector<std::string>{"uniform"}
                                          : std::vector<std::string>{"gl", "uniform"};
  }
  const bool has_gl = std::count(options.samplers.begin(), options.samplers.end(), "gl") > 0;
  if (has_gl && options.db.empty()) {
    throw CLI::ValidationError("--samplers", "gl needs --db, the memory that it draws from");
  }
  if (options.is_resumed && options.csv.empty()) {
    throw CLI::ValidationError("--resume", "needs --csv, the rows that are there already");
  }
}

}  // namespace

void add_bench(CLI::App& program, Action& action) {
  CLI::App* group = program.add_subcommand("bench", "Plan many problems and measure");
  group->require_subcommand(1);
  group->footer("Example:\n  mneme bench run problems.json --seeds 10 --csv runs.csv");
  CLI::App* command = group->add_subcommand("run", "Run problems x planners x samplers x seeds");
  command->footer(
      "Example:\n  mneme bench run problems/ --planners rrt_connect,prm --seeds 10 --timeout 4 "
      "--csv runs.csv");
  const auto options = std::make_shared<BenchOptions>();
  add_run_flags(*command, *options);
  command->callback([options, &action] {
    check_run_flags(*options);
    action = [options] { return run_bench_command(*options); };
  });
}

}  // namespace mneme::app
