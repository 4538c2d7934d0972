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
  std::string planner;
  std::string sampler;
  std::uint64_t seed = 0;
  bool is_solved = false;
  bool is_path_valid =
      false;  ///< by an independent check at ten times the resolution, double precision
  double planning_time_s = 0;  ///< censored at the time limit if not solved
  double total_time_s = 0;
  double retrieval_time_s = 0;
  std::uint64_t iterations = 0;
  std::uint64_t states_checked = 0;
  double path_length = 0;
  int components = 0;
};

/// Nearest-rank order statistics of planning times, failures counted as longer than any success.
struct TimeSummary {
  int runs = 0;
  int solved = 0;
  double p50 = 0, p95 = 0, p99 = 0, max = 0;  ///< seconds; a failure stands at its censored time
};
[[nodiscard]] TimeSummary summarize(std::span<const BenchmarkRow> rows);

/// True if every state of `path` at `resolution` radians or finer is free, by exact distances in
/// double precision that share no code with the kernels. False for an empty path and for one that
/// leaves the joint limits.
[[nodiscard]] bool is_path_free(const CollisionChecker& checker, const Path& path,
                                double resolution);

/// One line per run below a header (RFC 4180, but lines end in a line feed); solved and path_valid
/// are 0 or 1.
[[nodiscard]] std::string to_csv(std::span<const BenchmarkRow> rows);
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
