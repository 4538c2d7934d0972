// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Results of benchmarks: rows of runs, CSV files, summaries, ratios with intervals, a report with
/// figures, and logs for OMPL's benchmark tools.
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
  std::string set = {};  ///< group of problems, such as the name of a file; may be empty
  std::string planner;
  std::string sampler;
  std::uint64_t seed = 0;
  PlanStatus status = PlanStatus::timeout;
  bool is_solved = false;  ///< the planner reports a path within the time limit
  /// The path passed an independent check in double precision at ten times the resolution.
  bool is_path_valid = false;
  /// Time of the planner from call to return, with retrieval and learning, without scene tables,
  /// simplification and verification. Without a path: the time limit.
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
  double timeout_s = 0;       ///< time limit
  std::string setting = {};   ///< name of the settings in a suite; may be empty
  std::string settings = {};  ///< describe_settings(), such as "range=3.55 similarity=3"
  double learning_time_s = 0;
  std::string isa = {};                     ///< instruction set of the kernels
  std::string machine = {};                 ///< describe_machine()
  std::string version = {};                 ///< describe_build()
  std::string started = {};                 ///< time at the start, UTC, ISO 8601
  std::vector<Improved> improvements = {};  ///< SolveResult::improvements
  std::uint64_t replayed = 0;               ///< Replay::row
  /// Seconds of the trajectory within the robot's own limits (find_rate_limits); 0 without a path.
  double duration_s = 0;
  bool is_warm = false;  ///< timed warm: right after another run of the problem, without the exact
                         ///< check of a path between
};

/// The row of one call of solve() with `settings`. The path is checked again with exact distances
/// at a tenth of the checker's resolution, unless `is_path_valid` says what such a check of the
/// same path has found. A path found after the time limit counts as a timeout. The caller sets
/// `set`, `setting`, `machine`, `version` and `started`.
[[nodiscard]] BenchmarkRow make_row(const Problem& problem, const SolveSettings& settings,
                                    const SolveResult& result, const CollisionChecker& checker,
                                    std::optional<bool> is_path_valid = {});
/// Returns processor, number of cores and system, such as "AMD EPYC, 2 cores, Linux 6.1".
[[nodiscard]] std::string describe_machine();
/// Returns version and compiler of this build, such as "mneme 0.2.0, g++ 12.2".
[[nodiscard]] std::string describe_build();
/// The settings that differ from the defaults, such as "range=3.55 similarity=3", in order of
/// declaration, without time limit and seed.
[[nodiscard]] std::string describe_settings(const SolveSettings& settings);

/// "warm", "cold" or "mixed": how the runs were timed.
[[nodiscard]] std::string_view describe_timing(std::span<const BenchmarkRow> rows);

/// True if the problem has an invalid start or goal. Such runs do not count for planners.
[[nodiscard]] bool is_invalid_problem(const BenchmarkRow& row);
/// True if there is a path and the independent check confirms it.
[[nodiscard]] bool is_success(const BenchmarkRow& row);

/// Nearest-rank percentiles of times in seconds. Failures rank after all successes; a percentile
/// that is a failure has that run's recorded time, mostly the time limit.
struct TimeSummary {
  int runs = 0;
  int solved = 0;
  double p50 = 0, p95 = 0, p99 = 0, max = 0, mean = 0;
};
[[nodiscard]] TimeSummary summarize(std::span<const BenchmarkRow> rows,
                                    double BenchmarkRow::*time_s = &BenchmarkRow::planning_time_s);

/// Returns CSV (RFC 4180, but lines end in a line feed): a header and one line per run. The column
/// is_valid is BenchmarkRow::is_path_valid, 0 or 1.
[[nodiscard]] std::string to_csv(std::span<const BenchmarkRow> rows);
/// The header and the line of one run, as in to_csv.
[[nodiscard]] std::string csv_header();
[[nodiscard]] std::string to_csv_line(const BenchmarkRow& row);

/// The runs of a CSV file.
struct CsvRuns {
  std::vector<BenchmarkRow> rows;
  /// Size of the complete lines: a killed process may leave an incomplete last line.
  std::size_t complete_bytes = 0;
};
/// Reads the text of to_csv(), also of older versions with fewer columns. `source` names the text
/// in messages. Errors name line and column.
[[nodiscard]] Result<CsvRuns> parse_csv(std::string_view text, const std::string& source);

/// Summary of the runs of one planner, sampler and setting on the problems of one set. Times are
/// those of runs on problems with valid start and goal. A run without a valid path counts as a
/// failure with the time limit as its time.
struct SetSummary {
  std::string set;  ///< "all" for the sets together
  std::string planner;
  std::string sampler;
  std::string setting;
  int total = 0;            ///< all runs
  int valid = 0;            ///< runs on problems with valid start and goal
  int invalid_paths = 0;    ///< paths that failed the independent check; they count as failures
  TimeSummary times;        ///< planning times
  TimeSummary total_times;  ///< times of solve() from call to return
  std::uint64_t iterations_p50 = 0;
  std::uint64_t states_p50 = 0;     ///< states checked, also by shortening and verification
  double simplification_p50_s = 0;  ///< of successes
  double path_length_mean = 0;      ///< of successes, L2 joint distance
  double duration_mean_s = 0;       ///< of successes, BenchmarkRow::duration_s
};
/// One summary per set, planner, sampler and setting, in order of appearance. With several sets,
/// summaries of all sets together follow.
[[nodiscard]] std::vector<SetSummary> summarize_sets(std::span<const BenchmarkRow> rows);
/// A text table, one line per summary; ">" marks times that are lower bounds. The column setting is
/// omitted if no setting has a name.
[[nodiscard]] std::string to_table(std::span<const SetSummary> summaries);
/// A text table, one line per problem, planner and sampler, with planning times in ms.
[[nodiscard]] std::string to_table(std::span<const BenchmarkRow> rows);

/// Contents and cost of a database.
struct MemoryRow {
  std::string name;
  std::int64_t primitives = 0;
  std::int64_t components = 0;
  std::int64_t bytes = 0;
  double learning_time_s = 0;  ///< 0 if the database existed already
};
[[nodiscard]] std::string to_csv(std::span<const MemoryRow> rows);
/// Reads the text of to_csv(). `source` names the text in messages.
[[nodiscard]] Result<std::vector<MemoryRow>> parse_memory_csv(std::string_view text,
                                                              const std::string& source);

/// A ratio with its 95 % interval.
struct TimeRatio {
  double value = 0;
  double low = 0, high = 0;
  bool is_at_least = false;  ///< a lower bound: the reference failed at its time limit
  bool is_at_most = false;   ///< an upper bound: the compared run failed at its time limit
};
/// Ratios of a reference's planning times to those of a compared series, on the same problems and
/// seeds. Above 1 the compared series is faster. Runs without a path count with their time limit.
struct PairedRatio {
  int pairs = 0;
  TimeRatio p50, p95, p99;  ///< ratios of percentiles
  TimeRatio mean;           ///< ratio of arithmetic means; a bound if any run failed
  TimeRatio geometric;      ///< geometric mean of the pairs' ratios; a bound if any run failed
};
/// Compares runs with equal set, problem and seed, without those on problems with an invalid start
/// or goal. Intervals are bootstrap percentiles: whole problems are resampled if there are ten or
/// more, otherwise the runs of each problem. Deterministic.
[[nodiscard]] PairedRatio compare_runs(std::span<const BenchmarkRow> reference,
                                       std::span<const BenchmarkRow> other);

/// Comparison of two samplers, settings or planners on the problems of one set.
struct SeriesRatio {
  std::string set;        ///< "all" for the sets together
  std::string other;      ///< compared series, such as "rrt_connect, gl, tuned"
  std::string reference;  ///< such as "rrt_connect, uniform, tuned"
  PairedRatio ratio;
};
/// Ratios for each set and, with several sets, for all together. Samplers are compared with
/// `baseline`, settings with the first one, mneme's planners with OMPL's of the same name.
[[nodiscard]] std::vector<SeriesRatio> compare_series(std::span<const BenchmarkRow> rows,
                                                      const std::string& baseline);
/// A text table, one line per ratio; empty if there are none.
[[nodiscard]] std::string to_table(std::span<const SeriesRatio> ratios);

struct ReportPicture {
  std::string caption;
  std::string svg;
  std::string page = {};  ///< link target, relative to the report; may be empty
};
struct ReportOptions {
  std::string title = "mneme benchmark";
  std::string introduction = {};             ///< first paragraph; line breaks are kept
  std::vector<ReportPicture> pictures = {};  ///< below the introduction
  std::string baseline = "uniform";          ///< sampler that others are compared with
  bool by_problem = false;                   ///< a figure per problem instead of one per set
};
struct ReportFigure {
  std::string name;  ///< file name without extension
  std::string svg;   ///< an SVG document
};
struct BenchmarkReport {
  std::string html;  ///< one self-contained page
  std::vector<ReportFigure> figures;
};
/// A page with introduction, pictures, curves of solved runs over time, tables and paired ratios.
/// `memories` may be empty.
[[nodiscard]] BenchmarkReport make_benchmark_report(std::span<const BenchmarkRow> rows,
                                                    std::span<const MemoryRow> memories,
                                                    const ReportOptions& options);
/// Writes the page to `path` and each figure to PAGE_FIGURE.svg in the same directory.
[[nodiscard]] Result<void> write_report(const std::string& path, const BenchmarkReport& report);

/// The runs of one problem as a log of ompl::tools::Benchmark. ompl_benchmark_statistics.py
/// converts such logs into a database for Planner Arena. Planners are named
/// "PLANNER_SAMPLER_SETTING".
struct OmplLog {
  std::string experiment;  ///< "SET_PROBLEM"
  std::string text;
};
[[nodiscard]] std::vector<OmplLog> to_ompl_logs(std::span<const BenchmarkRow> rows);
/// Writes a log per problem into `directory`, which is created if needed.
[[nodiscard]] Result<void> write_ompl_logs(const std::string& directory,
                                           std::span<const BenchmarkRow> rows);

}  // namespace mneme
