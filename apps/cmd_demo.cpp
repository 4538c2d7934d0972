// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme demo: learns the planar grid, then plans the planar scenarios with and without that
/// memory.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mneme/base.h"
#include "mneme/learning.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "demo_runs.h"
#include "inputs.h"
#include "learning_run.h"
#include "options.h"
#include "output_file.h"

namespace mneme::app {
namespace {

constexpr const char* kRobot = "planar8";
constexpr const char* kProblems[] = {"scenario1",   "scenario2",   "scenario3",
                                     "threaded_b0", "threaded_b2", "threaded_b4"};

struct DemoOptions {
  std::string out = "out/demo";
  std::string scenes;  ///< empty: those that came with mneme
  std::optional<int> primitive_count;
  int seed_count = 20;
  std::optional<double> timeout_s;
  bool is_json = false;
  LearnJob job;
};

struct DemoResults {
  std::vector<BenchmarkRow> rows;
  std::vector<ReportPicture> pictures;
  bool is_interrupted = false;
};

struct DemoMemory {
  Database database;
  LearnSummary summary;
};

Result<std::string> scene_file(const DemoOptions& options, const std::string& name) {
  if (options.scenes.empty()) return find_scene(name);
  return options.scenes + "/" + name;
}

Result<DemoMemory> learn_grid(const DemoOptions& options) {
  Result<PrimitiveGrid> grid = scene_file(options, "planar/grid.yaml").and_then(load_grid);
  if (!grid) return tl::unexpected(grid.error());
  grid->count = options.primitive_count.value_or(grid->count);
  const Result<Robot> robot = load_named_robot(kRobot);
  if (!robot) return tl::unexpected(robot.error());
  Result<Database> database = open_database(options.out + "/planar.db", *robot, OpenMode::create);
  if (!database) return tl::unexpected(database.error());
  const std::vector<PrimitiveKey> keys = cover_grid(*grid, options.job.seed);
  Result<LearnSummary> summary = learn_with_progress(*robot, keys, *database, options.job);
  if (!summary) return tl::unexpected(summary.error());
  print_note(fmt::format("learned {} primitives in {:.1f} s; {} were known", summary->learned,
                         summary->time_s, summary->skipped));
  return DemoMemory{std::move(*database), *summary};
}

Result<std::vector<Problem>> load_problems(const DemoOptions& options) {
  std::vector<Problem> problems;
  for (const char* name : kProblems) {
    const Result<std::string> path = scene_file(options, fmt::format("planar/{}.yaml", name));
    if (!path) return tl::unexpected(path.error());
    if (!std::filesystem::exists(*path)) {
      print_note(fmt::format("skipped: there is no '{}'", *path));
      continue;
    }
    Result<Problem> problem = read_problem(*path);
    if (!problem) return tl::unexpected(problem.error());
    problems.push_back(std::move(*problem));
  }
  return problems;
}

Result<ReportPicture> draw(const DemoCell& cell, const DemoOutcome& outcome) {
  PlanarPicture picture;
  picture.problem = cell.problem;
  picture.title = cell.problem->name;
  std::string caption = fmt::format("{}: no path found", cell.problem->name);
  if (outcome.first_solved) {
    picture.gl = &outcome.first_solved->gl;
    picture.path = outcome.first_solved->plan.path;
    caption = fmt::format("{}: planned from memory in {:.2f} ms, {} samples", cell.problem->name,
                          1e3 * outcome.first_solved->planning_time_s,
                          outcome.first_solved->plan.iterations);
  }
  return to_svg(picture).map([&](const std::string& svg) { return ReportPicture{caption, svg}; });
}

Result<DemoResults> run_cells(const std::vector<DemoCell>& cells, Database& database,
                              int seed_count) {
  DemoResults results;
  Progress progress("planning");
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(cells.size()) * seed_count;
  for (std::size_t i = 0; i < cells.size() && !results.is_interrupted; ++i) {
    const DemoCell& cell = cells[i];
    const std::string detail =
        fmt::format("{} {} {}", cell.problem->name, cell.planner, cell.sampler);
    const Result<DemoOutcome> outcome =
        run_cell(cell, database, seed_count, [&] { progress.update(++done, total, detail); });
    if (!outcome) return tl::unexpected(outcome.error());
    done = static_cast<std::int64_t>(i + 1) * seed_count;
    results.is_interrupted = outcome->is_interrupted;
    results.rows.insert(results.rows.end(), outcome->rows.begin(), outcome->rows.end());
    if (cell.planner != "rrt_connect" || cell.sampler != "gl" || results.is_interrupted) continue;
    const Result<ReportPicture> picture = draw(cell, *outcome);
    if (!picture) return tl::unexpected(picture.error());
    results.pictures.push_back(*picture);
  }
  return results;
}

std::string introduction(const DemoMemory& memory) {
  const DatabaseInfo info = memory.database.info();
  return fmt::format(
      "A planar arm of {} joints plans with three planners. The sampler gl draws half of its "
      "configurations from local samplers that were retrieved from a memory of {} primitives "
      "({} components); uniform draws all of them uniformly, with the same planners and the same "
      "tuned range. The memory covers a range of pairs of circles and was not told about these "
      "scenes. Times are planning times, retrieval included, on the instruction set {}. Every "
      "path was checked again by exact distances at ten times the resolution. A planner whose "
      "first {} runs on a problem all reached the time limit was not run further.",
      info.space.joint_count, info.samplers, info.components, to_string(default_isa()),
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

void print_results(const DemoOptions& options, const DemoMemory& memory, const DemoResults& results,
                   const std::string& report) {
  if (!options.is_json) {
    fmt::print("{}\nThe report is in {}\n", to_table(results.rows), report);
    return;
  }
  Json rows = Json::array();
  for (const BenchmarkRow& row : results.rows) rows.push_back(to_json(row));
  print_json({{"database", options.out + "/planar.db"},
              {"results", options.out + "/results.csv"},
              {"report", report},
              {"learned", memory.summary.learned},
              {"skipped", memory.summary.skipped},
              {"learning_time_s", memory.summary.time_s},
              {"rows", rows}});
}

ExitCode judge(const std::vector<BenchmarkRow>& rows) {
  const auto wrong = std::count_if(rows.begin(), rows.end(), [](const BenchmarkRow& row) {
    return row.is_solved && !row.is_path_valid;
  });
  if (wrong == 0) return ExitCode::done;
  print_error(fmt::format("{} paths failed the independent check", wrong));
  return ExitCode::failure;
}

Result<ExitCode> run_demo(const DemoOptions& options) {
  const Result<std::vector<Problem>> problems = load_problems(options);
  if (!problems) return tl::unexpected(problems.error());
  const Result<void> made = make_directory(options.out);
  if (!made) return tl::unexpected(made.error());
  Result<DemoMemory> memory = learn_grid(options);
  if (!memory) return tl::unexpected(memory.error());
  if (memory->summary.is_cancelled) return ExitCode::interrupted;
  const std::vector<DemoCell> cells = demo_cells(*problems, options.timeout_s);
  const Result<DemoResults> results = run_cells(cells, memory->database, options.seed_count);
  if (!results) return tl::unexpected(results.error());
  if (results->is_interrupted) return ExitCode::interrupted;

  const std::string report = options.out + "/report.html";
  const std::string page = to_html("mneme: the planar arm, planned from memory",
                                   introduction(*memory), results->rows, results->pictures);
  const Result<void> written =
      write_file(options.out + "/results.csv", to_csv(results->rows)).and_then([&] {
        return write_file(report, page);
      });
  if (!written) return tl::unexpected(written.error());
  print_results(options, *memory, *results, report);
  return judge(results->rows);
}

}  // namespace

void add_demo(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand(
      "demo", "Learn, then plan with and without memory, and write a report");
  command->footer("Example:\n  mneme demo --out out/demo");
  const auto options = std::make_shared<DemoOptions>();
  command->add_option("--out", options->out,
                      "directory for planar.db, results.csv and report.html (default out/demo)");
  command->add_option("--scenes", options->scenes,
                      "directory with planar/grid.yaml and the problems (default: those that came "
                      "with mneme)");
  add_number(*command, "--primitives-count", options->primitive_count, 0, 100000000,
             "at least this many primitives to learn, instead of the grid's number");
  add_number(*command, "--seeds", options->seed_count, 1, 1000000, "runs per table row");
  add_number(*command, "--timeout", options->timeout_s, 0, 1e6,
             "time limit of a run in seconds, instead of 5 for rrt_connect and 2 for the others");
  add_number(*command, "--seed", options->job.seed, 0, ~std::uint64_t{0}, "seed of the learning");
  add_jobs(*command, options->job.jobs);
  add_isa(*command);
  add_json(*command, options->is_json);
  command->callback([options, &action] { action = [options] { return run_demo(*options); }; });
}

}  // namespace mneme::app
