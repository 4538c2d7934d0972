// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What benchmarks measured: rows of runs, CSV files, summaries, ratios with intervals, a report
/// with figures, and logs for OMPL's benchmark tools.
#pragma once

#include "mneme/base.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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
