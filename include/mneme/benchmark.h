// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Suites of experiments (bench/suites/*.yaml), and what becomes of their runs: a report, a
/// database, and the files of OMPL's benchmark tools.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mneme/base.h"
#include "mneme/learning.h"
#include "mneme/pipeline.h"
#include "mneme/report.h"

namespace mneme {

/// Problems of a suite: whatever `mneme bench run` takes, relative to the suite's file.
struct SuiteProblems {
  std::string where;
  std::string set;   ///< the figure that they share; empty for the name of the file
  std::string part;  ///< "I/N" for every N-th beginning with the I-th; empty for all
};

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

/// The names that a suite may use.
struct SuiteNames {
  std::vector<std::string> planners;
  std::vector<std::string> samplers;
};

/// Reads a suite. Errors name file, line and key: unknown keys and names, values out of range, a
/// setting that draws from a memory and names none.
[[nodiscard]] Result<Suite> load_suite(const std::string& path, const SuiteNames& known);

/// True for samplers that draw from a database: "gl" and the baselines on the same memory.
[[nodiscard]] bool needs_memory(std::string_view sampler);

/// The settings that differ from the defaults, such as "range=3.55 similarity=3"; names in order of
/// declaration; without time limit and seed.
[[nodiscard]] std::string describe_settings(const SolveSettings& settings);

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

/// The ratios of every set, and of all sets if there are several, as a table of text. Samplers are
/// compared with `baseline`, settings with the first one, native planners with OMPL's. Empty if
/// there is nothing to compare.
[[nodiscard]] std::string to_ratio_table(std::span<const BenchmarkRow> rows,
                                         const std::string& baseline);

struct ReportOptions {
  std::string title = "mneme benchmark";
  std::string baseline = "uniform";  ///< the sampler that others are compared with
  bool by_problem = false;           ///< a figure per problem instead of one per set
};
struct ReportFigure {
  std::string name;  ///< of a file, without extension
  std::string svg;   ///< a document of its own
};
struct BenchmarkReport {
  std::string html;  ///< one page that needs nothing from elsewhere
  std::vector<ReportFigure> figures;
};
/// Box plots, solved-over-time curves, tables and paired ratios of the runs; `memories` may be
/// empty.
[[nodiscard]] BenchmarkReport make_benchmark_report(std::span<const BenchmarkRow> rows,
                                                    std::span<const MemoryRow> memories,
                                                    const ReportOptions& options);

/// "AMD EPYC, 2 cores, Linux 6.1"
[[nodiscard]] std::string describe_machine();
/// "mneme 0.1.0, g++ 12.2"
[[nodiscard]] std::string describe_build();
/// Now, UTC, ISO 8601.
[[nodiscard]] std::string current_time();

/// A table `runs` in an SQLite file, with the columns of the CSV file; other programs may read it
/// while it grows.
class RunDatabase {
 public:
  /// Replaces the table in `path` by `rows`. Errors: io; corrupt if it is no SQLite file; invalid
  /// if it has tables besides.
  [[nodiscard]] static Result<RunDatabase> open(const std::string& path,
                                                std::span<const BenchmarkRow> rows);
  RunDatabase(RunDatabase&&) noexcept;
  RunDatabase& operator=(RunDatabase&&) noexcept;
  ~RunDatabase();
  Result<void> add(const BenchmarkRow& row);

 private:
  struct State;
  explicit RunDatabase(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The runs of one problem as a log of OMPL's ompl::tools::Benchmark, which
/// ompl_benchmark_statistics reads. A planner is named "PLANNER_SAMPLER_SETTING".
struct OmplLog {
  std::string experiment;  ///< "SET_PROBLEM"
  std::string text;
};
[[nodiscard]] std::vector<OmplLog> to_ompl_logs(std::span<const BenchmarkRow> rows);

/// Writes `path` anew as ompl_benchmark_statistics would from the logs: what Planner Arena
/// (plannerarena.org) takes. Errors: io; `path` is no SQLite file.
[[nodiscard]] Result<void> write_planner_arena(const std::string& path,
                                               std::span<const BenchmarkRow> rows);

}  // namespace mneme
