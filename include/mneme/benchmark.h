// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Benchmarks: problems, runs, and suites of experiments (bench/suites/*.yaml).
#pragma once

#include "mneme/base.h"
#include "mneme/learning.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"
#include "mneme/report.h"
#include "mneme/statistics.h"

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

/// Names problems of a benchmark that load_bench_problems() loads: an argument of `mneme bench run`
/// or an entry of a suite.
struct SuiteProblems {
  std::string where;       ///< A file, FILE.json#NAME, SCENE.yaml,REQUEST.yaml or a directory.
  std::string set = {};    ///< Name of the problems' group. Empty: the name of the file.
  std::string part = {};   ///< "I/N": every N-th problem, from the I-th on. Empty: all.
  std::string robot = {};  ///< URDF that replaces the problems' robot. Empty: no replacement.
  std::string srdf = {};   ///< SRDF of `robot`. Empty: the SRDF beside that URDF.
};
/// Lists the single problems of `arguments` in order. A compact file stands for all its problems, a
/// directory for all problems below it, sorted by path. `part` "I/N", with 1 <= I <= N, selects
/// every N-th problem, so that one can learn from one part and measure on another. Problems of one
/// file form a set; so do files of one problem in the same directory.
[[nodiscard]] Result<std::vector<SuiteProblems>> find_bench_problems(
    const std::vector<std::string>& arguments, const std::string& part = "");

/// The share "I/N" of a list: every N-th entry, from the I-th on.
struct Part {
  std::size_t index = 0;
  std::size_t count = 1;
  /// True for every N-th position, from the I-th on, counted from 1. I = 0 is the same as I = N.
  [[nodiscard]] bool holds(std::size_t position) const {
    return (position + 1) % count == index % count;
  }
};
/// Reads "I/N" with whole numbers 0 <= I <= N and N >= 1; nothing for other texts.
[[nodiscard]] std::optional<Part> parse_part(std::string_view text);
/// Receives notes for users, such as warnings.
using OnNote = std::function<void(const std::string& note)>;

struct LoadedProblem {
  std::string set;
  Problem problem;
};
/// Loads the problems that find_bench_problems() found. `on_note`, if set, receives each warning
/// once.
[[nodiscard]] Result<std::vector<LoadedProblem>> load_bench_problems(
    const std::vector<SuiteProblems>& found, const ProblemOptions& overrides,
    const OnNote& on_note);
/// Loads problems to learn from, named "SET#NAME". Errors: as load_bench_problems(), and problems
/// with different robots.
[[nodiscard]] Result<std::vector<Problem>> load_lesson_problems(
    const std::vector<SuiteProblems>& found, const ProblemOptions& overrides,
    const OnNote& on_note);

/// True for samplers that need a database: "gl" and the baselines of add_baseline_samplers().
[[nodiscard]] bool needs_memory(std::string_view sampler);

/// One configuration to run on each problem with each seed.
struct BenchCase {
  std::string setting;
  std::string memory = {};             ///< name of the memory
  std::vector<std::string> sets = {};  ///< sets of problems; empty: all
  SolveSettings settings = {};         ///< with planner and sampler
  std::string description = {};        ///< the settings as text, for BenchmarkRow::settings
  bool is_serial = false;              ///< never two runs at once: PlannerEntry::is_exclusive

  [[nodiscard]] bool is_of_set(const std::string& set) const {
    return sets.empty() || std::find(sets.begin(), sets.end(), set) != sets.end();
  }
};
/// Appends a case for each of `planners` with each of `samplers`.
void append_cases(const BenchCase& setting, const std::vector<std::string>& planners,
                  const std::vector<std::string>& samplers, std::vector<BenchCase>& cases);

/// True if runs change the memory, so that later runs depend on earlier ones.
[[nodiscard]] bool learns_while_planning(const SolveSettings& settings);

/// Solves a problem with the settings of a case, which include the run's seed.
using SolveRun = std::function<Result<SolveResult>(const Problem& problem, Database* database,
                                                   const BenchCase& bench_case)>;
/// Solves with mneme, or with the rival that the planner's name refers to.
[[nodiscard]] Result<SolveResult> solve_case(const Problem& problem, Database* database,
                                             const BenchCase& bench_case);

/// A benchmark: problems x cases x seeds.
struct BenchPlan {
  std::vector<LoadedProblem> problems;
  std::vector<BenchCase> cases;
  int seed_count = 1;
  std::uint64_t first_seed = 1;
  int jobs = 1;  ///< threads; with one, all callbacks come from the caller's
  /// True (cold): runs all problems with one seed before the next seed, and checks each path
  /// exactly before the next run. This evicts CPU caches, so that each phase takes longer. False
  /// (warm): all runs of a problem follow each other, and their paths are checked afterwards.
  bool is_cold = false;
  /// Change the order of cases from seed to seed, and from problem to problem if runs are warm: a
  /// case takes longer after another one than after its like. Every second time in reverse, and
  /// each case first in its turn.
  bool alternates = true;
  /// Skip a case on a problem once this many runs were all unsolved; 0: never. Deterministic with
  /// one job.
  int hopeless_after = 0;
  /// Databases by name of the memory and hash of the robot.
  std::map<std::pair<std::string, std::string>, std::shared_ptr<Database>> memories = {};
  SolveRun solve = solve_case;
  const std::atomic<bool>* cancel = nullptr;  ///< cancels the current run, which leaves no row

  [[nodiscard]] std::size_t run_count() const;
  /// False if `is_cold`, or if cases learn while planning, which makes the order matter.
  [[nodiscard]] bool is_warm() const;
};

/// Fails if `rows` were run with settings or limits that differ from those of the plan's setting
/// with the same name.
[[nodiscard]] Result<void> check_same_settings(const BenchPlan& plan,
                                               std::span<const BenchmarkRow> rows);
/// Sorts rows into the order in which one job runs the plan. Rows of other plans go last.
void sort_rows(const BenchPlan& plan, std::vector<BenchmarkRow>& rows);

/// Receives each finished run, one at a time. An error ends the benchmark.
using OnRow = std::function<Result<void>(const BenchmarkRow& row, const SolveResult& result)>;
/// Runs the part of the plan that `done` lacks, in the order of BenchPlan::is_cold. False if
/// cancelled. With one job, exceptions of callbacks pass through.
[[nodiscard]] Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done,
                                     const OnRow& on_row);

/// Rows of a benchmark in RAM, and in a CSV file if open() names one.
class RowFile {
 public:
  /// Opens the file `csv`, or no file if `csv` is empty. With `is_resumed` the file's rows are
  /// kept, except an incomplete last line.
  Result<void> open(const std::string& csv, bool is_resumed);
  Result<void> add(const BenchmarkRow& row);
  /// Sorts the rows, also in the file, with sort_rows().
  Result<void> sort(const BenchPlan& plan);

  [[nodiscard]] const std::vector<BenchmarkRow>& rows() const { return rows_; }

 private:
  Result<void> write_all();
  Result<void> flush();

  std::string path_;
  std::ofstream file_;
  std::vector<BenchmarkRow> rows_;
};
/// Reads the CSV file of a RowFile.
[[nodiscard]] Result<std::vector<BenchmarkRow>> read_rows(const std::string& path);
/// Called after each run with all rows so far and the number of rows at the end.
using OnRows = std::function<void(std::span<const BenchmarkRow> rows, std::size_t total)>;
/// Runs the part of the plan that `file` lacks and adds the rows. False if cancelled. Errors: also
/// check_same_settings().
[[nodiscard]] Result<bool> run_bench(BenchPlan& plan, RowFile& file, const OnRows& on_rows);

/// A database of a suite: an existing file, or one that is learned first.
struct SuiteMemory {
  std::string name;
  std::string file = {};          ///< An existing database. Empty: learned.
  std::string robot = {};         ///< Robot of `primitives`: a URDF file or a name.
  std::string primitives = {};    ///< File of a grid of primitives (load_grid()).
  std::optional<int> count = {};  ///< Number of primitives. Default: the grid's.
  /// Problems to solve with uniform samples and learn from.
  std::vector<SuiteProblems> problems = {};
  std::optional<std::string> kind = {};  ///< Kind for `problems`. Default: default_kind_of_paths().
  int paths = 5;                         ///< Paths per problem.
  double path_timeout_s = 10;            ///< Time limit per path, seconds.
  std::uint64_t seed = 1;
  LearnSettings learn = {};
};

/// Named settings. Runs replace `solve.planner`, `solve.sampler` and the seed.
struct SuiteSetting {
  std::string name;
  std::string memory = {};  ///< name of the memory; may be empty
  std::vector<std::string> planners = {};
  std::vector<std::string> samplers = {};
  std::vector<std::string> sets = {};  ///< empty for all
  SolveSettings solve = {};
};

struct Suite {
  std::string name;  ///< name of the file, without its extension
  std::vector<SuiteProblems> problems;
  std::vector<SuiteMemory> memories = {};
  std::vector<SuiteSetting> settings;
  std::uint64_t first_seed = 1;
  int seed_count = 20;
};

/// Reads a suite. Errors name file, line and key: unknown keys and names, values out of range, a
/// setting without the memory that its sampler needs. Planners of OMPL are accepted also in builds
/// without it.
[[nodiscard]] Result<Suite> load_suite(const std::string& path);

/// Reads the rows of a suite's memories; none if the file does not exist.
[[nodiscard]] Result<std::vector<MemoryRow>> read_memories(const std::string& path);

/// True for YAML files with a line for the key `problems`.
[[nodiscard]] bool is_suite_file(const std::string& path);
/// A suite to run, with overrides.
struct SuiteRun {
  std::string suite;          ///< path
  std::string out = {};       ///< directory; empty for out/bench/NAME
  std::string memories = {};  ///< directory; empty for OUT/memories
  std::optional<int> seed_count = {};
  std::optional<double> timeout_s = {};    ///< replaces the time limit of all settings
  std::vector<std::string> settings = {};  ///< names; empty for all
  int jobs = 1;
  bool is_resumed = false;
  bool is_cold = false;  ///< BenchPlan::is_cold
};
/// Callbacks of a suite. Each may be empty.
struct SuiteHooks {
  OnNote on_note = {};
  /// Called before learning, with a description such as "800 primitives". May set
  /// LearnRun::on_progress.
  std::function<void(LearnRun& run, const std::string& what)> watch = {};
  OnRows on_rows = {};
  const std::atomic<bool>* cancel = nullptr;
};
struct SuiteResult {
  std::vector<BenchmarkRow> rows;
  std::string report;        ///< path of the page
  bool is_complete = false;  ///< false if cancelled
};
/// Runs a suite (docs/results/benchmarks.md): learns missing memories, runs what the rows of an
/// earlier run lack, and writes rows, memories, report and OMPL logs. Planners that this build
/// lacks are skipped with a note. Errors: those of load_suite() and of its files; an output that is
/// also an input; a planner that learns by itself without a memory learned from problems; rows of
/// other settings.
[[nodiscard]] Result<SuiteResult> run_suite(const SuiteRun& run, const SuiteHooks& hooks);

}  // namespace mneme
