// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What came out, for people and programs: JSON, SVG pictures, tables, CSV and HTML.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mneme/base.h"
#include "mneme/pipeline.h"

namespace mneme {

/// The keys that `mneme plan --json` prints. `load_time_s` is what opening files and the database
/// took.
[[nodiscard]] std::string to_json(const Problem& problem, const SolveResult& result,
                                  double load_time_s);

/// A planar picture in the manner of the paper's figures; metres, y upwards.
struct PlanarPicture {
  const Problem* problem = nullptr;
  const GlSampler* gl =
      nullptr;  ///< primitives in coloured rectangles and faint arms of components; may be null
  Path path;    ///< drawn as a fan of arms from start (blue) to goal (red); may be empty
  std::string title;
  int max_arms = 60;  ///< component arms drawn at most
};
/// Errors: unsupported if the robot is not planar; invalid if a configuration, a primitive or the
/// mixture does not fit it.
[[nodiscard]] Result<std::string> to_svg(const PlanarPicture& picture);

/// One run of a benchmark.
struct BenchmarkRow {
  std::string problem;
  std::string set;  ///< of problems, such as the name of a file; may be empty
  std::string planner;
  std::string sampler;
  std::uint64_t seed = 0;
  PlanStatus status = PlanStatus::timeout;
  bool is_solved = false;  ///< what the planner says
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
  std::string isa;      ///< instruction set of the kernels
  std::string machine;  ///< processor, number of cores and system
  std::string version;  ///< of mneme and of the compiler
  std::string started;  ///< UTC, ISO 8601
};

/// True if the problem's start or goal is at fault: such a run says nothing about planners.
[[nodiscard]] bool is_invalid_problem(const BenchmarkRow& row);
/// True if there is a path and the independent check confirms it.
[[nodiscard]] bool is_success(const BenchmarkRow& row);

/// Nearest-rank order statistics of planning times, failures counted as longer than any success.
struct TimeSummary {
  int runs = 0;
  int solved = 0;
  double p50 = 0, p95 = 0, p99 = 0, max = 0;  ///< seconds; a failure stands at its censored time
  double p25 = 0, p75 = 0;
};
[[nodiscard]] TimeSummary summarize(std::span<const BenchmarkRow> rows);

/// True if every state of `path` at `resolution` radians or finer is free, by exact distances in
/// double precision that share no code with the kernels. False for an empty path and for one that
/// leaves the joint limits.
[[nodiscard]] bool is_path_free(const CollisionChecker& checker, const Path& path,
                                double resolution);

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

/// All runs of one planner, sampler and setting on the problems of one set. Times are of the runs on valid
/// problems; runs without a valid path count as longer than any other.
struct SetSummary {
  std::string set;  ///< "all" for the sets together
  std::string planner;
  std::string sampler;
  std::string setting;
  int total = 0;          ///< runs
  int valid = 0;          ///< runs on problems whose start and goals are valid
  int invalid_paths = 0;  ///< paths that did not survive the independent check; not solved
  TimeSummary times;      ///< of planning, seconds; `runs` is `valid`
  std::uint64_t iterations_p50 = 0;  ///< of runs on valid problems
  double simplification_p50_s = 0;   ///< of solved runs
};
/// One per set, planner, sampler and setting in order of appearance; if there are several sets, those of all
/// sets together follow.
[[nodiscard]] std::vector<SetSummary> summarize_sets(std::span<const BenchmarkRow> rows);
/// A text table of them; ">" marks times of failures. Settings have a column if they have names.
[[nodiscard]] std::string to_table(std::span<const SetSummary> summaries);
/// A text table: one line per problem, planner and sampler, in order of appearance. Planning times
/// in ms;
/// ">" marks those of failures.
[[nodiscard]] std::string to_table(std::span<const BenchmarkRow> rows);

struct ReportPicture {
  std::string caption;
  std::string svg;
};
/// One self-contained page: pictures, the table and a log-scale chart of times per problem and
/// sampler.
[[nodiscard]] std::string to_html(const std::string& title, const std::string& introduction,
                                  std::span<const BenchmarkRow> rows,
                                  std::span<const ReportPicture> pictures);

}  // namespace mneme
