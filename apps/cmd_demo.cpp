// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme demo: an arm in space repeats the tasks of a cell, and a planar arm plans the paper's
/// scenarios; each with and without memory.
#include "mneme/benchmark.h"
#include "mneme/learning.h"
#include "mneme/report.h"

#include "bench_output.h"
#include "commands.h"
#include "console.h"
#include "demo_cell.h"
#include "demo_finding.h"
#include "inputs.h"
#include "learning_run.h"
#include "options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

namespace mneme::app {
namespace {

constexpr double kConnectTimeout = 5;
constexpr double kOtherTimeout = 2;
constexpr int kHopelessRuns = 5;
constexpr const char* kRobot = "planar8";
constexpr const char* kCell = "shelf/thin.yaml";
constexpr int kTasks = 20;
constexpr int kRepeats = 5;
constexpr const char* kProblems[] = {"scenario1",   "scenario2",   "scenario3",
                                     "threaded_b0", "threaded_b2", "threaded_b4"};

struct DemoOptions {
  std::string out = "out/demo";
  std::string scenes;  ///< empty: mneme's own
  std::optional<int> primitive_count;
  int seed_count = 10;
  std::optional<double> timeout_s;
  bool is_json = false;
  bool is_opened = false;
  LearnJob job;
};

struct DemoResults {
  std::vector<BenchmarkRow> rows;
  std::vector<ReportPicture> pictures;
  bool is_interrupted = false;
};

/// The runs of the arm in space; empty without a cell.
struct DemoCell {
  std::string robot;
  CellRuns runs;
  std::vector<ReportPicture> pictures;
};

struct DemoMemory {
  std::shared_ptr<Database> database;
  LearnSummary summary;
};

Result<std::string> scene_file(const DemoOptions& options, const std::string& name) {
  if (options.scenes.empty()) return find_scene(name);
  return options.scenes + "/" + name;
}

/// The moving picture of the longest stored path, and its page.
Result<ReportPicture> draw_cell(const DemoOptions& options, const CellRuns& runs,
                                Database& memory) {
  const std::string svg = MNEME_TRY(to_svg(MovingPicture{&*runs.shown, runs.longest}));
  SolveSettings settings;
  settings.replay = 0.5;
  const std::string trace = MNEME_TRY(plan_and_trace(*runs.shown, &memory, settings));
  const std::string page = MNEME_TRY(to_page(trace, "cell.html", ""));
  MNEME_TRY(write_file(options.out + "/cell.html", page));
  return ReportPicture{fmt::format("{} in its cell, {}; click to turn and scrub it",
                                   runs.shown->robot.name(), runs.shown->name),
                       svg, "cell.html"};
}

Result<DemoCell> run_demo_cell(const DemoOptions& options) {
  DemoCell cell;
  const Result<std::string> path = scene_file(options, kCell);
  if (!path || !std::filesystem::exists(*path)) {
    print_note(fmt::format("skipped: there is no '{}'", kCell));
    return cell;
  }
  const Problem base = MNEME_TRY(read_problem(*path));
  const std::string file = options.out + "/cell.db";
  remove_database(file);
  Database memory = MNEME_TRY(Database::open(file, make_signature(base.robot), OpenMode::create));
  print_note(fmt::format("{} repeats {} tasks of a cell", base.robot.name(), kTasks));
  cell.robot = base.robot.name();
  cell.runs = MNEME_TRY(run_cell(base, kTasks, kRepeats, options.job.seed, memory));
  if (cell.runs.longest.empty()) return cell;
  ReportPicture picture = MNEME_TRY(draw_cell(options, cell.runs, memory));
  cell.pictures.push_back(std::move(picture));
  return cell;
}

Result<DemoMemory> learn_grid(const DemoOptions& options) {
  PrimitiveGrid grid = MNEME_TRY(scene_file(options, "planar/grid.yaml").and_then(load_grid));
  grid.count = options.primitive_count.value_or(grid.count);
  const Robot robot = MNEME_TRY(load_named_robot(kRobot));
  Database database = MNEME_TRY(
      Database::open(options.out + "/planar.db", make_signature(robot), OpenMode::create));
  const std::vector<PrimitiveKey> keys = cover_grid(grid, options.job.seed);
  LearnSummary summary = MNEME_TRY(learn_with_progress(robot, keys, database, options.job));
  print_note(fmt::format("learned {} in {:.1f} s; {} were known",
                         counted(summary.learned, "primitive", "primitives"), summary.time_s,
                         summary.skipped));
  return DemoMemory{std::make_shared<Database>(std::move(database)), summary};
}

Result<std::vector<Problem>> load_problems(const DemoOptions& options) {
  std::vector<Problem> problems;
  for (const char* name : kProblems) {
    const std::string path = MNEME_TRY(scene_file(options, fmt::format("planar/{}.yaml", name)));
    if (!std::filesystem::exists(path)) {
      print_note(fmt::format("skipped: there is no '{}'", path));
      continue;
    }
    Problem problem = MNEME_TRY(read_problem(path));
    problems.push_back(std::move(problem));
  }
  return problems;
}

/// Each planner with and without memory on each problem. One that gets nowhere is not run further.
BenchPlan make_plan(const DemoOptions& options, const std::vector<Problem>& problems,
                    const std::shared_ptr<Database>& database) {
  BenchPlan plan;
  for (const Problem& problem : problems) {
    plan.problems.push_back({"", problem});
    plan.memories[{kRobot, problem.robot.hash()}] = database;
  }
  for (const char* planner : {"rrt_connect", "prm", "rrt"}) {
    const bool is_connect = std::string_view(planner) == "rrt_connect";
    BenchCase base;
    base.memory = kRobot;
    base.settings.plan.timeout_s =
        options.timeout_s.value_or(is_connect ? kConnectTimeout : kOtherTimeout);
    append_cases(base, {planner}, {"gl", "uniform"}, plan.cases);
  }
  plan.seed_count = options.seed_count;
  plan.hopeless_after = kHopelessRuns;
  plan.cancel = interrupt_flag();
  return plan;
}

/// The page of a plan that was made before, as DIRECTORY/PROBLEM.html: it is planned again, and
/// with uniform samples beside it.
Result<std::string> write_page(const DemoOptions& options, const Problem& problem,
                               Database& database, const SolveSettings& settings) {
  const std::string own = MNEME_TRY(plan_and_trace(problem, &database, settings));
  SolveSettings uniform = settings;
  uniform.sampler = "uniform";
  const std::string beside = MNEME_TRY(plan_and_trace(problem, &database, uniform));
  const std::string name = problem.name + ".html";
  return to_page(own, name, beside)
      .and_then([&](const std::string& page) { return write_file(options.out + "/" + name, page); })
      .map([&] { return name; });
}

Result<ReportPicture> draw(const Problem& problem, const SolveResult* result) {
  PlanarPicture picture;
  picture.problem = &problem;
  picture.title = problem.name;
  std::string caption = fmt::format("{}: no path found", problem.name);
  if (result != nullptr) {
    picture.gl = &result->gl;
    picture.path = result->plan.path;
    caption = fmt::format("{}: planned from memory in {:.2f} ms, {} samples; click to see it move",
                          problem.name, 1e3 * result->planning_time_s, result->plan.iterations);
  }
  return to_svg(picture).map([&](const std::string& svg) {
    return ReportPicture{caption, svg, ""};
  });
}

/// The rows of each case on each problem together, in the order of the plan.
void sort_by_case(std::vector<BenchmarkRow>& rows) {
  using Name = std::tuple<std::string, std::string, std::string>;
  std::map<Name, std::size_t> positions;
  const auto position = [&](const BenchmarkRow& row) {
    return positions.try_emplace({row.problem, row.planner, row.sampler}, positions.size())
        .first->second;
  };
  for (const BenchmarkRow& row : rows) static_cast<void>(position(row));
  std::ranges::stable_sort(rows, {}, position);
}

/// The settings of a run of the plan.
SolveSettings settings_of(const BenchPlan& plan, const BenchmarkRow& row) {
  const auto base = std::ranges::find_if(plan.cases, [&](const BenchCase& c) {
    return c.settings.planner == row.planner && c.settings.sampler == row.sampler;
  });
  SolveSettings settings = base->settings;
  settings.plan.seed = row.seed;
  settings.plan.cancel = interrupt_flag();
  return settings;
}

Result<DemoResults> run_plan(BenchPlan& plan, const DemoOptions& options, Database& database) {
  DemoResults results;
  std::map<std::string, ReportPicture> pictures;
  Progress progress("planning");
  const auto total = static_cast<std::int64_t>(plan.run_count());
  const auto take = [&](const BenchmarkRow& row, const SolveResult& result) -> Result<void> {
    results.rows.push_back(row);
    progress.update(static_cast<std::int64_t>(results.rows.size()), total,
                    fmt::format("{} {} {}", row.problem, row.planner, row.sampler));
    const bool is_shown = row.planner == "rrt_connect" && row.sampler == "gl" &&
                          result.plan.is_solved() && !pictures.contains(row.problem);
    if (!is_shown) return {};
    const auto problem = std::ranges::find(plan.problems, row.problem,
                                           [](const LoadedProblem& p) { return p.problem.name; });
    auto picture = MNEME_TRY(draw(problem->problem, &result));
    auto page = MNEME_TRY(write_page(options, problem->problem, database, settings_of(plan, row)));
    picture.page = std::move(page);
    pictures[row.problem] = std::move(picture);
    return {};
  };
  const bool is_complete = MNEME_TRY(run_bench(plan, {}, take));
  results.is_interrupted = !is_complete;
  for (const LoadedProblem& loaded : plan.problems) {
    const auto found = pictures.find(loaded.problem.name);
    const ReportPicture picture =
        MNEME_TRY(found != pictures.end() ? found->second : draw(loaded.problem, nullptr));
    results.pictures.push_back(picture);
  }
  sort_by_case(results.rows);
  return results;
}

std::string introduction(const DemoMemory& memory) {
  const DatabaseInfo info = memory.database->info();
  return fmt::format(
      "The figures below are of the planar arm of {} joints and three planners. The sampler gl "
      "takes a part of its samples from a memory of {} primitives ({} components); uniform takes "
      "none. Planners and settings are the same. The memory covers a range of pairs of circles, "
      "and was not learned from these scenes. Times are planning times with retrieval, on {}. "
      "Every path was checked by exact distances at ten times the resolution. A planner whose "
      "first {} runs on a problem all reached the time limit was not run further.",
      info.signature.joint_count, info.samplers, info.components, to_string(default_isa()),
      kHopelessRuns);
}

using Json = nlohmann::ordered_json;

Json to_json(const BenchmarkRow& row) {
  return {{"problem", row.problem},
          {"planner", row.planner},
          {"sampler", row.sampler},
          {"seed", row.seed},
          {"is_solved", row.is_solved},
          {"is_path_valid", row.is_path_valid},
          {"planning_time_s", row.planning_time_s},
          {"total_time_s", row.total_time_s},
          {"retrieval_time_s", row.retrieval_time_s},
          {"iterations", row.iterations},
          {"states_checked", row.states_checked},
          {"path_length", row.path_length},
          {"components", row.components}};
}

Json to_json(const DemoCell& cell) {
  const CellRuns& runs = cell.runs;
  const auto replayed = std::ranges::count_if(runs.repeats, &RepeatedTask::is_replayed);
  return {{"robot", cell.robot},
          {"tasks", runs.tasks},
          {"repeats", runs.repeats.size()},
          {"replayed", replayed},
          {"unsolved", runs.unsolved},
          {"wrong", runs.wrong},
          {"finding", describe_cell(cell.robot, runs)}};
}

void print_results(const DemoOptions& options, const DemoCell& cell, const DemoMemory& memory,
                   const DemoResults& results, const std::string& report) {
  if (!options.is_json) {
    fmt::print("{}{}{}\nThe report is {}\n", describe_cell(cell.robot, cell.runs),
               describe_finding(results.rows), to_table(results.rows), report);
    return;
  }
  Json rows = Json::array();
  for (const BenchmarkRow& row : results.rows) rows.push_back(to_json(row));
  print_json({{"database", options.out + "/planar.db"},
              {"results", options.out + "/results.csv"},
              {"report", report},
              {"cell", to_json(cell)},
              {"learned", memory.summary.learned},
              {"skipped", memory.summary.skipped},
              {"learning_time_s", memory.summary.time_s},
              {"rows", rows}});
}

Result<std::string> write_demo_report(const DemoOptions& options, const DemoCell& cell,
                                      const DemoMemory& memory, const DemoResults& results) {
  ReportOptions page;
  page.title = "mneme: planned with and without memory";
  page.introduction =
      describe_cell(cell.robot, cell.runs) + describe_finding(results.rows) + introduction(memory);
  page.pictures = cell.pictures;
  page.pictures.insert(page.pictures.end(), results.pictures.begin(), results.pictures.end());
  page.by_problem = true;
  const std::string report = options.out + "/report.html";
  MNEME_TRY(write_file(options.out + "/results.csv", to_csv(results.rows)));
  MNEME_TRY(write_file(report, make_benchmark_report(results.rows, {}, page).html));
  return report;
}

/// Shows a file in the desktop's browser, which outlives this program; a note if that fails.
void open_in_browser(const std::string& file) {
  constexpr useconds_t kStart = 200000;  // xdg-open that fails does so at once
  const pid_t child = fork();
  if (child == 0) {
    setsid();
    execlp("xdg-open", "xdg-open", file.c_str(), nullptr);
    _exit(127);
  }
  usleep(kStart);
  int status = 0;
  const bool has_ended = child < 0 || waitpid(child, &status, WNOHANG) == child;
  if (has_ended && status != 0) {
    print_note(fmt::format("xdg-open failed; open '{}' in a browser", file));
  }
}

Result<ExitCode> run_demo(const DemoOptions& options) {
  const std::vector<Problem> problems = MNEME_TRY(load_problems(options));
  MNEME_TRY(make_directory(options.out));
  const DemoCell cell = MNEME_TRY(run_demo_cell(options));
  DemoMemory memory = MNEME_TRY(learn_grid(options));
  if (memory.summary.is_cancelled) return ExitCode::interrupted;
  BenchPlan plan = make_plan(options, problems, memory.database);
  const DemoResults results = MNEME_TRY(run_plan(plan, options, *memory.database));
  if (results.is_interrupted) return ExitCode::interrupted;
  const std::string report = MNEME_TRY(write_demo_report(options, cell, memory, results));
  print_results(options, cell, memory, results, report);
  if (options.is_opened) open_in_browser(report);
  if (cell.runs.wrong > 0) {
    print_error(fmt::format("{} of the cell failed the exact check",
                            counted(cell.runs.wrong, "path", "paths")));
    return ExitCode::failure;
  }
  return judge_rows(results.rows);
}

}  // namespace

void add_demo(CLI::App& program, Action& action) {
  const auto options = std::make_shared<DemoOptions>();
  CLI::App& command =
      add_command(program, action, "demo", "Plan with and without memory, and write a report",
                  "demo --open", options, run_demo);
  command.add_flag("--open", options->is_opened, "show the report in the browser");
  command.add_option("--out", options->out,
                     "directory for databases, results.csv and report.html (default out/demo)");
  command.add_option("--scenes", options->scenes,
                     "directory with planar/grid.yaml and the problems (default: mneme's own)");
  add_number(command, "--primitives-count", options->primitive_count, 0, 100000000,
             "least number of primitives to learn, instead of the grid's");
  add_number(command, "--seeds", options->seed_count, 1, 1000000, "runs per row of the table");
  add_number(command, "--timeout", options->timeout_s, 0, 1e6,
             "time limit of a run, seconds, instead of 5 for rrt_connect and 2 for the others");
  add_seed(command, options->job.seed, "seed of the learning");
  add_jobs(command, options->job.jobs);
  add_isa(command);
  add_json(command, options->is_json);
}

}  // namespace mneme::app
