// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme learn: fills a database with local samplers.
#include "mneme/benchmark.h"
#include "mneme/learning.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "learning_run.h"
#include "lessons.h"
#include "options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

/// Learning on many machines.
struct Sharing {
  Part shard;
  bool is_worker = false;
  double lease_s = SharedWork().lease_s;
};

struct LearnOptions {
  LessonSource source;
  std::vector<std::string> problems;
  std::string part;
  std::string grid;
  std::string db;
  DatabaseSettings kept;
  std::optional<int> count;
  std::optional<double> similarity_error;
  bool is_json = false;
  Sharing sharing;
  LearnJob job;
  ProblemLesson lesson;
};

Result<PrimitiveGrid> read_grid(const LearnOptions& options) {
  return load_grid(options.grid).map([&](PrimitiveGrid grid) {
    grid.count = options.count.value_or(grid.count);
    grid.max_similarity_error = options.similarity_error.value_or(grid.max_similarity_error);
    return grid;
  });
}

Json to_json(const LearnSummary& summary, const Database& database) {
  return {{"learned", summary.learned},  {"skipped", summary.skipped},
          {"empty", summary.empty},      {"components", summary.components},
          {"time_s", summary.time_s},    {"is_cancelled", summary.is_cancelled},
          {"samplers", database.size()}, {"bytes", database.info().bytes}};
}

/// Json writes errors that are infinite, because there is no key, as null.
Json to_json(const Coverage& coverage, double threshold) {
  return {{"probes", coverage.probes},
          {"threshold", threshold},
          {"median", coverage.median},
          {"p95", coverage.p95},
          {"max", coverage.max}};
}

void print_summary(const LearnSummary& summary, const Database& database) {
  fmt::print("learned {} ({} of them impassable) in {:.1f} s, {}\n",
             counted(summary.learned, "primitive", "primitives"), summary.empty, summary.time_s,
             counted(summary.components, "component", "components"));
  if (summary.skipped > 0) {
    fmt::print("skipped {}: already learned\n", summary.skipped);
  }
  const DatabaseInfo info = database.info();
  fmt::print("{} now holds {} with {} in {} bytes\n", info.url,
             counted(info.samplers, "sampler", "samplers"),
             counted(info.components, "component", "components"), info.bytes);
}

void print_coverage(const Coverage& coverage, double threshold) {
  if (!std::isfinite(coverage.max)) {
    fmt::print("coverage: none, because the database is empty\n");
    return;
  }
  fmt::print(
      "coverage: similarity error of the nearest row, over {} random primitives of the range:\n",
      coverage.probes);
  fmt::print("  median {:.3f}, p95 {:.3f}, max {:.3f} m^2; wanted below {}\n", coverage.median,
             coverage.p95, coverage.max, threshold);
}

ExitCode end_of(const LearnSummary& summary) {
  if (!summary.is_cancelled) return ExitCode::done;
  print_note("interrupted; continue with the same command");
  return ExitCode::interrupted;
}

Result<ExitCode> report(const LearnOptions& options, const LearnSummary& summary,
                        const Database& database, const std::optional<PrimitiveGrid>& grid) {
  std::optional<Coverage> coverage;
  if (grid) coverage = MNEME_TRY(measure_coverage(database, *grid));
  if (options.is_json) {
    Json json = to_json(summary, database);
    json["coverage"] = coverage ? to_json(*coverage, grid->max_similarity_error) : Json();
    print_json(json);
  } else {
    print_summary(summary, database);
    if (coverage) print_coverage(*coverage, grid->max_similarity_error);
  }
  return end_of(summary);
}

void report_problems(const LearnOptions& options, const LearnSummary& summary,
                     const Database& database) {
  if (options.is_json) {
    print_json({{"learned", summary.learned},
                {"skipped", summary.skipped},
                {"unsolved", summary.unsolved.size()},
                {"rows", summary.rows},
                {"components", summary.components},
                {"time_s", summary.time_s},
                {"is_cancelled", summary.is_cancelled},
                {"samplers", database.size()},
                {"bytes", database.info().bytes}});
    return;
  }
  fmt::print("learned from {} ({} learned before, {} unsolved) in {:.1f} s\n",
             counted(summary.learned, "problem", "problems"), summary.skipped,
             summary.unsolved.size(), summary.time_s);
  fmt::print("added {} with {}; {} now holds {}\n", counted(summary.rows, "sampler", "samplers"),
             counted(summary.components, "component", "components"), database.info().url,
             database.size());
}

Result<ExitCode> run_problem_lesson(const LearnOptions& options) {
  const auto overrides =
      MNEME_TRY(problem_options(options.source.robot, options.source.robot_options));
  const auto found = MNEME_TRY(find_bench_problems(options.problems, options.part));
  const auto problems = MNEME_TRY(load_lesson_problems(found, overrides, print_note));
  if (problems.empty()) return fail(ErrorCode::invalid, "--part: this part has no problems");
  const Robot& robot = problems.front().robot;
  MemorySettings memory = options.source.memory;
  if (!memory.kind) memory.kind = default_kind_of_paths(robot).name;
  Database database =
      MNEME_TRY(Database::open(options.db, make_signature(robot), OpenMode::create, options.kept));
  note_record_flaw(database);
  ProblemLesson lesson = options.lesson;
  static_cast<LearnRun&>(lesson) = options.job;
  const auto summary = MNEME_TRY(learn_with_progress(problems, memory, database, lesson));
  report_problems(options, summary, database);
  return end_of(summary);
}

/// The items of a shard.
template <class T>
std::vector<T> take_shard(std::vector<T> all, const Part& shard) {
  std::size_t position = 0;
  std::erase_if(all, [&](const T&) { return !shard.holds(position++); });
  return all;
}

/// Learns a shard of the lesson's primitives and of those that cover the grid.
Result<LearnSummary> learn_lesson(PrimitiveLesson lesson, const std::optional<PrimitiveGrid>& grid,
                                  const Part& shard, Database& database, const LearnJob& job) {
  std::vector<PrimitiveKey> keys = std::move(lesson.keys);
  if (grid) {
    const std::vector<PrimitiveKey> covering = cover_grid(*grid, job.seed);
    keys.insert(keys.end(), covering.begin(), covering.end());
  }
  const auto mine = take_shard(std::move(keys), shard);
  return learn_with_progress(lesson.robot, std::span(mine), database, job);
}

Result<ExitCode> run_learn(const LearnOptions& options) {
  if (!options.problems.empty()) return run_problem_lesson(options);
  PrimitiveLesson lesson = MNEME_TRY(load_primitive_lesson(options.source));
  const Robot& robot = lesson.robot;
  std::optional<PrimitiveGrid> grid;
  if (!options.grid.empty()) {
    if (!robot.is_planar()) {
      return fail(ErrorCode::unsupported, "--primitives is for planar arms: give --problems");
    }
    grid = MNEME_TRY(read_grid(options));
  }
  if (lesson.keys.empty() && !grid) {
    print_note("these scenes have no primitives: no two obstacles in reach are within --max-gap");
  }
  Database database =
      MNEME_TRY(Database::open(options.db, make_signature(robot), OpenMode::create, options.kept));
  note_record_flaw(database);
  LearnJob job = options.job;
  if (options.sharing.is_worker) job.shared = {options.db, options.sharing.lease_s};
  const LearnSummary summary =
      MNEME_TRY(learn_lesson(std::move(lesson), grid, options.sharing.shard, database, job));
  // A shard alone does not cover the range.
  if (options.sharing.shard.count > 1) grid.reset();
  return report(options, summary, database, grid);
}

void add_sharing(CLI::App& command, Sharing& sharing) {
  const auto read_shard = [&sharing](const std::string& text) {
    const std::optional<Part> shard = parse_part(text);
    if (!shard) {
      throw CLI::ValidationError(
          "--shard", fmt::format("'{}' is not I/N with whole numbers 0 <= I <= N", text));
    }
    sharing.shard = *shard;
  };
  add_text(
      command, "--shard", read_shard,
      "every N-th primitive, starting with the I-th, into a database of its own; 'mneme db merge' "
      "joins the shards. I counts from 1 or from 0: shards 0 and N are the same")
      ->type_name("I/N");
  command.add_flag("--worker", sharing.is_worker,
                   "share the work with all processes that have the same command line, through the "
                   "PostgreSQL database; ends when everything is learned");
  add_number(command, "--lease", sharing.lease_s, 0.1, 86400.0,
             "with --worker: seconds of silence after which other processes take over a process's "
             "primitives");
}

/// Throws a usage error for flags that contradict each other.
void check_sharing(const CLI::App& command, const Sharing& sharing, const std::string& url,
                   bool has_problems) {
  const bool has_shard = command.count("--shard") > 0;
  if (has_problems) {
    if (has_shard) throw CLI::ExcludesError("--shard", "--problems, whose shards are --part");
    if (sharing.is_worker) throw CLI::ExcludesError("--worker", "--problems");
  }
  if (sharing.is_worker && has_shard) throw CLI::ExcludesError("--worker", "--shard");
  if (sharing.is_worker && !url.starts_with("postgres")) {
    throw CLI::ValidationError("--worker", "needs a database on a server: --db postgresql://...");
  }
}

/// Makes flags without the source of lessons that they are for usage errors.
void bind_to_sources(CLI::App& command) {
  for (const char* flag : {"--part", "--paths", "--path-timeout"}) {
    command.get_option(flag)->needs(command.get_option("--problems"));
  }
  for (const char* flag : {"--count", "--similarity-error"}) {
    command.get_option(flag)->needs(command.get_option("--primitives"));
  }
  command.get_option("--lease")->needs(command.get_option("--worker"));
}

void add_flags(CLI::App& command, LearnOptions& options) {
  command.add_option("--robot", options.source.robot,
                     "URDF file or name of a robot (default with --problems: the problems' robot)");
  add_robot_flags(command, options.source.robot_options);
  command.add_option("--primitives", options.grid,
                     "YAML file with a range of primitives, for planar arms");
  command.add_option("--scenes", options.source.scenes,
                     "scenes or problems whose primitives are learned: files or patterns");
  command.add_option(
      "--problems", options.problems,
      "problems to solve; their paths are stored: files, FILE.json#NAME or directories");
  add_part(command, options.part);
  add_number(command, "--paths", options.lesson.paths, 1, 1000,
             "with --problems: paths per problem");
  add_number(command, "--path-timeout", options.lesson.timeout_s, 0.0, 1e6,
             "with --problems: seconds per path");
  add_database(command, options.db, options.kept,
               "SQLite file to add to, made if missing, or postgresql://...")
      ->required();
  add_jobs(command, options.job.jobs);
  add_seed(command, options.job.seed, "seed; another one adds other primitives");
  add_number(command, "--count", options.count, 0, 100000000,
             "least number of primitives, instead of the grid's");
  add_number(
      command, "--similarity-error", options.similarity_error, 1e-3, 1e9,
      "largest similarity error to the nearest row in the range, m^2, instead of the grid's");
  add_sharing(command, options.sharing);
  bind_to_sources(command);
  add_settings(command, options.job.settings);
  add_memory_settings(command, options.source.memory);
}

/// Throws a usage error for a flag of local queries, which learning from problems does not plan.
void refuse_settings(const CLI::App& command, const LearnSettings& settings) {
  visit_settings(settings, [&](const char* name, const auto&, auto, auto, std::string_view) {
    const std::string flag = fmt::format("--{}", name);
    if (command.count(flag) > 0) throw CLI::ExcludesError(flag, "--problems");
  });
}

void check_learn_flags(const CLI::App& command, LearnOptions& options) {
  const bool has_primitives = !options.grid.empty() || !options.source.scenes.empty();
  if (has_primitives && !options.problems.empty()) {
    throw CLI::ValidationError("--problems", "excludes --primitives and --scenes");
  }
  if (!has_primitives && options.problems.empty()) {
    throw CLI::RequiredError("either --problems, or --primitives or --scenes,");
  }
  const std::string kind(memory_kinds().front()->name);
  if (!options.grid.empty() && options.source.memory.kind.value_or(kind) != kind) {
    throw CLI::ValidationError("--kind", fmt::format("--primitives needs the kind '{}'", kind));
  }
  check_sharing(command, options.sharing, options.db, !has_primitives);
  if (!has_primitives) refuse_settings(command, options.job.settings);
  if (has_primitives && options.source.robot.empty()) throw CLI::RequiredError("--robot");
}

}  // namespace

void add_learn(CLI::App& program, Action& action) {
  const auto options = std::make_shared<LearnOptions>();
  CLI::App& command = add_command(
      program, action, "learn", "Learn a database from problems, scenes or primitives; resumable",
      "learn --problems problems/ --part 1/2 --db arm.db\n"
      "  mneme learn --robot planar8 --primitives scenes/planar/grid.yaml --db planar.db\n"
      "On a cluster, as an array of jobs:\n  mneme learn --robot planar8 --primitives grid.yaml "
      "--shard $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT --db shard$SLURM_ARRAY_TASK_ID.db\n"
      "  mneme db merge planar.db shard*.db",
      options, run_learn, check_learn_flags);
  add_flags(command, *options);
  add_isa(command);
  add_json(command, options->is_json);
}

}  // namespace mneme::app
