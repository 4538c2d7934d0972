// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Benchmarks: problems, runs and their rows, suites of experiments (bench/suites/*.yaml), and what
/// becomes of the rows: tables, a report, and logs for OMPL's benchmark tools.
#pragma once

#include "mneme/base.h"
#include "mneme/learning.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"
#include "mneme/report.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme {

/// One run of a benchmark.
struct BenchmarkRow {
  std::string problem;
  std::string set;  ///< of problems, such as the name of a file; may be empty
  std::string planner;
  std::string sampler;
  std::uint64_t seed = 0;
  PlanStatus status = PlanStatus::timeout;
  bool is_solved = false;  ///< what the planner says, within the time limit
  bool is_path_valid =
      false;  ///< by an independent check at ten times the resolution, double precision
  /// The planner from call to return without simplification and verification, with retrieval and
  /// learning but without tables of the scene; the time limit if there is no path.
  double planning_time_s = 0;
  double total_time_s = 0;  ///< solve() from call to return
  double retrieval_time_s = 0;
  double simplification_time_s = 0;
  double verification_time_s = 0;
  std::uint64_t iterations = 0;
  std::uint64_t states_checked = 0;
  std::uint64_t motions_checked = 0;
  std::uint64_t nodes = 0;
  double path_length = 0;
  int components = 0;
  double timeout_s = 0;  ///< the time limit
  std::string setting;   ///< the settings' name in a suite; may be empty
  std::string settings;  ///< those that are not the defaults, such as "range=3.55 similarity=3"
  double learning_time_s = 0;
  std::string isa;                     ///< instruction set of the kernels
  std::string machine;                 ///< processor, number of cores and system
  std::string version;                 ///< of mneme and of the compiler
  std::string started;                 ///< UTC, ISO 8601
  std::vector<Improved> improvements;  ///< SolveResult::improvements
  std::uint64_t replayed = 0;          ///< Replay::row
  /// Of the path's trajectory within the robot's own limits (find_rate_limits); 0 without a path.
  double duration_s = 0;
};

/// The row of one call of solve() with `settings`; its path is checked again by `checker` without
/// trusting anything that helped to find it. A path that came after the time limit is none. Set,
/// setting, machine, version and time are left to the caller.
[[nodiscard]] BenchmarkRow make_row(const Problem& problem, const SolveSettings& settings,
                                    const SolveResult& result, const CollisionChecker& checker);
/// "AMD EPYC, 2 cores, Linux 6.1"
[[nodiscard]] std::string describe_machine();
/// "mneme 0.2.0, g++ 12.2"
[[nodiscard]] std::string describe_build();
/// Now, UTC, ISO 8601.
[[nodiscard]] std::string current_time();
/// The settings that differ from the defaults, such as "range=3.55 similarity=3"; names in order of
/// declaration; without time limit and seed.
[[nodiscard]] std::string describe_settings(const SolveSettings& settings);

/// True if the problem's start or goal is at fault: such a run says nothing about planners.
[[nodiscard]] bool is_invalid_problem(const BenchmarkRow& row);
/// True if there is a path and the independent check confirms it.
[[nodiscard]] bool is_success(const BenchmarkRow& row);

/// Nearest-rank order statistics of planning or total times, failures counted as longer than any
/// success.
struct TimeSummary {
  int runs = 0;
  int solved = 0;
  double p50 = 0, p95 = 0, p99 = 0, max = 0;  ///< seconds; a failure stands at its censored time
  double p25 = 0, p75 = 0, mean = 0;
};
[[nodiscard]] TimeSummary summarize(std::span<const BenchmarkRow> rows,
                                    double BenchmarkRow::*time_s = &BenchmarkRow::planning_time_s);

/// One line per run below a header (RFC 4180, but lines end in a line feed); is_valid is 0 or 1 and
/// says whether the path passed the independent check.
[[nodiscard]] std::string to_csv(std::span<const BenchmarkRow> rows);
/// The header and the line of one run, as in to_csv.
[[nodiscard]] std::string csv_header();
[[nodiscard]] std::string to_csv_line(const BenchmarkRow& row);

/// What a CSV file of runs holds.
struct CsvRuns {
  std::vector<BenchmarkRow> rows;
  /// Bytes of the text that are whole lines: a process that was killed may leave a broken last one.
  std::size_t complete_bytes = 0;
};
/// Reads what to_csv wrote, also by versions before the column `setting`; `source` names it in
/// messages.
[[nodiscard]] Result<CsvRuns> parse_csv(std::string_view text, const std::string& source);

/// All runs of one planner, sampler and setting on the problems of one set. Times are of the runs
/// on valid problems; runs without a valid path count as longer than any other.
struct SetSummary {
  std::string set;  ///< "all" for the sets together
  std::string planner;
  std::string sampler;
  std::string setting;
  int total = 0;            ///< runs
  int valid = 0;            ///< runs on problems whose start and goals are valid
  int invalid_paths = 0;    ///< paths that did not survive the independent check; not solved
  TimeSummary times;        ///< of planning, seconds; `runs` is `valid`
  TimeSummary total_times;  ///< the same of solve() from call to return
  std::uint64_t iterations_p50 = 0;  ///< of runs on valid problems
  std::uint64_t states_p50 = 0;      ///< checked for the path, shortening and verification included
  double simplification_p50_s = 0;   ///< of solved runs
  double path_length_mean = 0;       ///< of solved runs, L2 joint distance
  double duration_mean_s = 0;        ///< of solved runs, BenchmarkRow::duration_s
};
/// One per set, planner, sampler and setting in order of appearance; if there are several sets,
/// those of all sets together follow.
[[nodiscard]] std::vector<SetSummary> summarize_sets(std::span<const BenchmarkRow> rows);
/// A text table of them; ">" marks times of failures. Settings have a column if they have names.
[[nodiscard]] std::string to_table(std::span<const SetSummary> summaries);
/// A text table: one line per problem, planner and sampler, in order of appearance. Planning times
/// in ms;
/// ">" marks those of failures.
[[nodiscard]] std::string to_table(std::span<const BenchmarkRow> rows);

/// Problems of a benchmark: whatever `mneme bench run` takes, in a suite relative to its file.
struct SuiteProblems {
  std::string where;       ///< a file, FILE.json#NAME, SCENE.yaml,REQUEST.yaml or a directory
  std::string set;         ///< the figure that they share; empty for the name of the file
  std::string part;        ///< "I/N" for every N-th beginning with the I-th; empty for all
  std::string robot = {};  ///< URDF instead of the problems' own robot; empty for that
  std::string srdf = {};   ///< of that robot; empty for the one beside it
};
/// The single problems of `arguments`, in order, or the `part` "I/N" of them, 1 <= I <= N, so that
/// some can be learned from and the others measured. A compact file stands for all its problems,
/// and a directory for all problems below it, sorted by path. A set is a file of many problems, or
/// a directory of files of one.
[[nodiscard]] Result<std::vector<SuiteProblems>> find_bench_problems(
    const std::vector<std::string>& arguments, const std::string& part = "");

/// The share "I/N" of a list.
struct Part {
  std::size_t index = 0;
  std::size_t count = 1;
  /// True of every N-th entry beginning with the I-th, counted from 1; 0 and N are the same I.
  [[nodiscard]] bool holds(std::size_t position) const {
    return (position + 1) % count == index % count;
  }
};
/// "I/N" with whole numbers 0 <= I <= N and N >= 1; nothing for other texts.
[[nodiscard]] std::optional<Part> parse_part(std::string_view text);
/// Hears what people should know, such as a warning, in a sentence.
using OnNote = std::function<void(const std::string& note)>;

struct LoadedProblem {
  std::string set;
  Problem problem;
};
/// The problems that `found` names. `on_note`, if any, hears their warnings, each once.
[[nodiscard]] Result<std::vector<LoadedProblem>> load_bench_problems(
    const std::vector<SuiteProblems>& found, const ProblemOptions& overrides,
    const OnNote& on_note);
/// The same to be learned from: all of one robot, and each named "SET#NAME".
[[nodiscard]] Result<std::vector<Problem>> load_lesson_problems(
    const std::vector<SuiteProblems>& found, const ProblemOptions& overrides,
    const OnNote& on_note);

/// True for samplers that draw from a database: "gl" and the baselines on the same memory.
[[nodiscard]] bool needs_memory(std::string_view sampler);

/// What is run on each problem with each seed.
struct BenchCase {
  std::string setting;
  std::string memory;             ///< that the sampler gl draws from
  std::vector<std::string> sets;  ///< of problems; empty for all
  SolveSettings settings;         ///< with planner and sampler
  std::string description;        ///< of the settings, for the rows
  bool is_serial = false;         ///< its runs take turns: see PlannerEntry::is_exclusive

  [[nodiscard]] bool is_of_set(const std::string& set) const {
    return sets.empty() || std::find(sets.begin(), sets.end(), set) != sets.end();
  }
};
/// Appends a case for each of `planners` with each of `samplers`.
void append_cases(const BenchCase& setting, const std::vector<std::string>& planners,
                  const std::vector<std::string>& samplers, std::vector<BenchCase>& cases);

/// True if runs change the memory, so that later ones depend on earlier ones.
[[nodiscard]] bool learns_while_planning(const SolveSettings& settings);

/// Solves a problem as the case says, whose settings have the run's seed.
using SolveRun = std::function<Result<SolveResult>(const Problem& problem, Database* database,
                                                   const BenchCase& bench_case)>;
/// By mneme, or by the rival that has the planner's place.
[[nodiscard]] Result<SolveResult> solve_case(const Problem& problem, Database* database,
                                             const BenchCase& bench_case);

/// Problems x cases x seeds.
struct BenchPlan {
  std::vector<LoadedProblem> problems;
  std::vector<BenchCase> cases;
  int seed_count = 1;
  std::uint64_t first_seed = 1;
  int jobs = 1;  ///< threads; with one, all callbacks come from the caller's
  /// Every other seed takes the cases in reverse, because the first one of a problem finds the
  /// caches cold.
  bool alternates = true;
  /// A case whose first runs on a problem, this many, are all unsolved is not run on it further; 0
  /// for no such limit. Repeats itself with one job.
  int hopeless_after = 0;
  /// By the name of the memory and the hash of the robot.
  std::map<std::pair<std::string, std::string>, std::shared_ptr<Database>> memories;
  SolveRun solve = solve_case;
  const std::atomic<bool>* cancel = nullptr;  ///< ends the run under way, which leaves no row

  [[nodiscard]] std::size_t run_count() const;
};

/// An error if `rows` were run with other settings or limits than `plan` has under the same name.
[[nodiscard]] Result<void> check_same_settings(const BenchPlan& plan,
                                               std::span<const BenchmarkRow> rows);
/// Puts rows into the order in which one job runs the plan; those of other plans go last.
void sort_rows(const BenchPlan& plan, std::vector<BenchmarkRow>& rows);

/// Receives each run as soon as it is done, one at a time. An error ends the benchmark.
using OnRow = std::function<Result<void>(const BenchmarkRow& row, const SolveResult& result)>;
/// Runs what `done` does not hold yet, all problems with one seed before the next seed. True if it
/// was not cancelled. With one job, exceptions of callbacks pass through.
[[nodiscard]] Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done,
                                     const OnRow& on_row);

/// Rows in memory and, with a name, in a CSV file that grows with them.
class RowFile {
 public:
  /// Begins the file `csv`; none if it is empty. With `is_resumed` the rows that it holds are kept;
  /// a broken last line is left out.
  Result<void> open(const std::string& csv, bool is_resumed);
  Result<void> add(const BenchmarkRow& row);
  /// Puts the rows, also those of the file, into the order of sort_rows().
  Result<void> sort(const BenchPlan& plan);

  [[nodiscard]] const std::vector<BenchmarkRow>& rows() const { return rows_; }

 private:
  Result<void> write_all();
  Result<void> flush();

  std::string path_;
  std::ofstream file_;
  std::vector<BenchmarkRow> rows_;
};
/// The rows of a CSV file that a RowFile wrote.
[[nodiscard]] Result<std::vector<BenchmarkRow>> read_rows(const std::string& path);
/// Hears after each run all rows until then, and how many there will be.
using OnRows = std::function<void(std::span<const BenchmarkRow> rows, std::size_t total)>;
/// Runs what `file` does not hold yet and adds it there. False if it was cancelled. Errors: also
/// rows of other settings.
[[nodiscard]] Result<bool> run_bench(BenchPlan& plan, RowFile& file, const OnRows& on_rows);

/// A database that a suite's runs draw from: a file that is there, or one that is learned first.
struct SuiteMemory {
  std::string name;
  std::string file;          ///< an existing database; empty if it is learned
  std::string robot;         ///< with `primitives`: a URDF file or a name
  std::string primitives;    ///< a grid to cover (see load_grid)
  std::optional<int> count;  ///< at least this many primitives instead of the grid's number
  std::vector<SuiteProblems> problems;  ///< to be solved with uniform samples and learned from
  std::optional<std::string> kind;      ///< with `problems`; left out, default_kind_of_paths()
  int paths = 5;                        ///< per problem
  double path_timeout_s = 10;           ///< per path
  std::uint64_t seed = 1;
  LearnSettings learn;
};

/// Settings under a name. `solve.planner`, `solve.sampler` and the seed are the run's.
struct SuiteSetting {
  std::string name;
  std::string memory;  ///< name of the memory that gl draws from; may be empty
  std::vector<std::string> planners;
  std::vector<std::string> samplers;
  std::vector<std::string> sets;  ///< empty for all
  SolveSettings solve;
};

struct Suite {
  std::string name;  ///< of the file, without its extension
  std::vector<SuiteProblems> problems;
  std::vector<SuiteMemory> memories;
  std::vector<SuiteSetting> settings;
  std::uint64_t first_seed = 1;
  int seed_count = 20;
};

/// Reads a suite. Errors name file, line and key: unknown keys and names, values out of range, a
/// setting that draws from a memory and names none. A planner of OMPL's may be named also where it
/// was not built in.
[[nodiscard]] Result<Suite> load_suite(const std::string& path);

/// What a database holds, and what it cost.
struct MemoryRow {
  std::string name;
  std::int64_t primitives = 0;
  std::int64_t components = 0;
  std::int64_t bytes = 0;
  double learning_time_s = 0;  ///< 0 if it was there already
};
[[nodiscard]] std::string to_csv(std::span<const MemoryRow> rows);
/// Reads what to_csv wrote; `source` names it in messages.
[[nodiscard]] Result<std::vector<MemoryRow>> parse_memory_csv(std::string_view text,
                                                              const std::string& source);

/// The rows that a suite wrote of its memories; none if there is no such file.
[[nodiscard]] Result<std::vector<MemoryRow>> read_memories(const std::string& path);

/// True of a YAML file that has a line of its own for the key `problems`.
[[nodiscard]] bool is_suite_file(const std::string& path);
/// A suite to be run, and what of it is to be different.
struct SuiteRun {
  std::string suite;     ///< path
  std::string out;       ///< directory; empty for out/bench/NAME
  std::string memories;  ///< directory; empty for OUT/memories
  std::optional<int> seed_count;
  std::optional<double> timeout_s;    ///< of all settings
  std::vector<std::string> settings;  ///< names; empty for all
  int jobs = 1;
  bool is_resumed = false;
};
/// How a suite shows what it does. Each may be empty.
struct SuiteHooks {
  OnNote on_note;
  /// Hears what is to be learned, such as "800 primitives", and may set the run's `on_progress`.
  std::function<void(LearnRun& run, const std::string& what)> watch;
  OnRows on_rows;
  const std::atomic<bool>* cancel = nullptr;
};
struct SuiteResult {
  std::vector<BenchmarkRow> rows;
  std::string report;        ///< path of the page
  bool is_complete = false;  ///< otherwise it was cancelled
};
/// Learns the memories of a suite, unless they are there, runs what its rows do not hold yet, and
/// leaves rows, memories, report and logs for OMPL in a directory (docs/benchmarks.md). Planners
/// that this build lacks are left out with a note. Errors: those of load_suite() and of what it
/// reads; a result that would replace an input; a planner with experience of its own and a memory
/// that is not learned from problems; rows there of other settings.
[[nodiscard]] Result<SuiteResult> run_suite(const SuiteRun& run, const SuiteHooks& hooks);

/// A ratio with its 95 % interval.
struct TimeRatio {
  double value = 0;
  double low = 0, high = 0;
  bool is_at_least = false;  ///< the reference's is a failure at its limit: a lower bound
  bool is_at_most = false;   ///< the other's is one: an upper bound
};
/// How planning times compare with those of a reference on the same problems and seeds. Values
/// above 1 say that they are shorter. Runs without a path stand at their limit in both.
struct PairedRatio {
  int pairs = 0;
  TimeRatio p50, p95, p99;  ///< of the reference's percentile to the other's
  TimeRatio mean;           ///< of the arithmetic means; a bound if any run failed
  TimeRatio geometric;      ///< geometric mean of the ratios of pairs; never marked as a bound
};
/// 95 % intervals by bootstrap percentiles: whole problems are drawn if there are ten or more,
/// otherwise runs of each problem. Pairs are equal in set, problem and seed; runs on problems with
/// an invalid start or goal are left out. The same rows give the same numbers.
[[nodiscard]] PairedRatio compare_runs(std::span<const BenchmarkRow> reference,
                                       std::span<const BenchmarkRow> other);

/// One sampler, setting or planner beside another one, on the problems of one set.
struct SeriesRatio {
  std::string set;        ///< "all" for the sets together
  std::string other;      ///< such as "rrt_connect, gl, tuned"
  std::string reference;  ///< what it is compared with, such as "rrt_connect, uniform, tuned"
  PairedRatio ratio;
};
/// The ratios of every set, and of all sets if there are several. Samplers are compared with
/// `baseline`, settings with the first one, native planners with OMPL's.
[[nodiscard]] std::vector<SeriesRatio> compare_series(std::span<const BenchmarkRow> rows,
                                                      const std::string& baseline);
/// A text table of them; empty without any.
[[nodiscard]] std::string to_table(std::span<const SeriesRatio> ratios);

struct ReportPicture {
  std::string caption;
  std::string svg;
  std::string page = {};  ///< that opens when it is clicked, relative to the report; empty: none
};
struct ReportOptions {
  std::string title = "mneme benchmark";
  std::string introduction;             ///< text above all else; line breaks are kept
  std::vector<ReportPicture> pictures;  ///< shown below the introduction
  std::string baseline = "uniform";     ///< the sampler that others are compared with
  bool by_problem = false;              ///< a figure per problem instead of one per set
};
struct ReportFigure {
  std::string name;  ///< of a file, without extension
  std::string svg;   ///< a document of its own
};
struct BenchmarkReport {
  std::string html;  ///< one page that needs nothing from elsewhere
  std::vector<ReportFigure> figures;
};
/// Introduction, pictures, box plots, solved-over-time curves, tables and paired ratios of the
/// runs; `memories` may be empty.
[[nodiscard]] BenchmarkReport make_benchmark_report(std::span<const BenchmarkRow> rows,
                                                    std::span<const MemoryRow> memories,
                                                    const ReportOptions& options);
/// Writes the page to `path` and its figures beside it, as PAGE_FIGURE.svg.
[[nodiscard]] Result<void> write_report(const std::string& path, const BenchmarkReport& report);

/// The runs of one problem as a log of OMPL's ompl::tools::Benchmark, of which
/// ompl_benchmark_statistics makes the database that Planner Arena reads. A planner is named
/// "PLANNER_SAMPLER_SETTING".
struct OmplLog {
  std::string experiment;  ///< "SET_PROBLEM"
  std::string text;
};
[[nodiscard]] std::vector<OmplLog> to_ompl_logs(std::span<const BenchmarkRow> rows);
/// Writes a log per problem into `directory`, which is made if it is missing.
[[nodiscard]] Result<void> write_ompl_logs(const std::string& directory,
                                           std::span<const BenchmarkRow> rows);

}  // namespace mneme
