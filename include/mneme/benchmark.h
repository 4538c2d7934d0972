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
/// leaves rows, memories, report and logs for OMPL in a directory (docs/results/benchmarks.md).
/// Planners that this build lacks are left out with a note. Errors: those of load_suite() and of
/// what it reads; a result that would replace an input; a planner with experience of its own and a
/// memory that is not learned from problems; rows there of other settings.
[[nodiscard]] Result<SuiteResult> run_suite(const SuiteRun& run, const SuiteHooks& hooks);

}  // namespace mneme
