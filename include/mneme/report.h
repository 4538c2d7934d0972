// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What came out, for people and programs: JSON, SVG pictures, tables, CSV and HTML.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mneme/base.h"
#include "mneme/check.h"
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
  int total = 0;          ///< runs
  int valid = 0;          ///< runs on problems whose start and goals are valid
  int invalid_paths = 0;  ///< paths that did not survive the independent check; not solved
  TimeSummary times;      ///< of planning, seconds; `runs` is `valid`
  std::uint64_t iterations_p50 = 0;  ///< of runs on valid problems
  double simplification_p50_s = 0;   ///< of solved runs
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

struct ReportPicture {
  std::string caption;
  std::string svg;
};
/// One self-contained page: pictures, the table and a log-scale chart of times per problem and
/// sampler.
[[nodiscard]] std::string to_html(const std::string& title, const std::string& introduction,
                                  std::span<const BenchmarkRow> rows,
                                  std::span<const ReportPicture> pictures);

/// How much of a plan a trace holds: what bounds the size of its page.
struct TraceSettings {
  int waypoints = 200;   ///< along the path at equal steps, besides the path's own configurations
  int samples = 300;     ///< uniform ones, and as many from memory
  int components = 120;  ///< of the retrieved mixture
  int edges = 2000;      ///< of the trees or the roadmap
};

/// Keeps a thinned record of what a planner draws and keeps: once a list is full every second entry
/// goes, so that what remains is spread evenly over the run. Not thread-safe.
class PlanRecorder : public PlanObserver {
 public:
  struct Sample {
    Origin origin = kUniformOrigin;
    std::vector<float> q;
  };
  struct Edge {
    int graph = 0;
    std::vector<float> from, to;
  };
  /// An evenly thinned list of at most `limit` >= 2 entries.
  template <class T>
  class Thinned {
   public:
    explicit Thinned(int limit) : limit_(static_cast<std::size_t>(limit < 2 ? 2 : limit / 2 * 2)) {}
    /// True if the entry that comes next is to be kept; then add() it.
    [[nodiscard]] bool counts_next() { return seen_++ % stride_ == 0; }
    void add(T entry) {
      if (entries_.size() == limit_) thin();
      entries_.push_back(std::move(entry));
    }
    [[nodiscard]] const std::vector<T>& entries() const { return entries_; }
    [[nodiscard]] std::uint64_t seen() const { return seen_; }

   private:
    void thin() {
      for (std::size_t i = 2; i < entries_.size(); i += 2) entries_[i / 2] = std::move(entries_[i]);
      entries_.resize((entries_.size() + 1) / 2);
      stride_ *= 2;
    }
    std::size_t limit_;
    std::uint64_t seen_ = 0, stride_ = 1;
    std::vector<T> entries_;
  };

  explicit PlanRecorder(const TraceSettings& settings = {});
  void on_sample(std::span<const float> q, Origin origin) override;
  void on_edge(std::span<const float> from, std::span<const float> to, int graph) override;

  [[nodiscard]] const Thinned<Sample>& uniform_samples() const { return uniform_; }
  [[nodiscard]] const Thinned<Sample>& memory_samples() const { return memory_; }
  [[nodiscard]] const Thinned<Edge>& edges() const { return edges_; }
  /// How many samples each source gave.
  [[nodiscard]] const std::map<Origin, std::uint64_t>& draws() const { return draws_; }

 private:
  Thinned<Sample> uniform_, memory_;
  Thinned<Edge> edges_;
  std::map<Origin, std::uint64_t> draws_;
};

/// A plan as geometry in the frame of the robot's root link, for viewers that know nothing of
/// robots (docs/file_formats.md). Metres, radians, seconds.
struct PlanTrace {
  /// The robot's shapes at one configuration: a pose per entry of `links`.
  using Poses = std::vector<Transform>;
  struct Waypoint {
    Configuration q;
    Poses poses;
    double travelled = 0;  ///< L2 joint distance from the start
    /// Metres from the robot to the nearest obstacle (not to itself), negative in contact; infinite
    /// without obstacles.
    double clearance = 0;
    int nearest_link = -1;      ///< index into `links`
    int nearest_obstacle = -1;  ///< index into the scene
    Vec3 tip;                   ///< of the end effector
  };
  /// A configuration as points: the origins of the links that its joints carry, then the tip.
  struct Arm {
    Origin origin = kUniformOrigin;  ///< or index of the primitive whose experience it is from
    std::vector<Vec3> points;
  };
  struct Primitive {
    LocalPrimitive primitive;
    bool is_learned = false;
    std::vector<double> similarity_errors;  ///< of its matches, nearest first; m^2
    int components = 0;                     ///< of all its matches
    std::uint64_t draws = 0;                ///< samples that came from it
  };
  struct Edge {
    int graph = 0;
    std::vector<Vec3> tips;  ///< along the motion
  };

  std::string problem, robot;
  bool is_planar = false;
  SolveResult result;  ///< without the memory's rows and mixture
  double load_time_s = 0;
  double path_length = 0;
  std::vector<Link> links;          ///< those with shapes
  std::vector<std::string> joints;  ///< names, in the order of a configuration
  Scene scene;
  Poses start;
  std::vector<Poses> goals;
  std::vector<Waypoint> waypoints;  ///< of the path, from start to goal
  std::vector<int> vertices;        ///< indices of the waypoints that are the path's own
  std::vector<Primitive> primitives;
  std::vector<Arm> components;  ///< means of the retrieved mixture
  int component_count = 0;      ///< of the whole mixture
  std::vector<Arm> samples;
  std::uint64_t uniform_draws = 0;
  std::vector<Edge> edges;
  std::uint64_t edge_count = 0;  ///< of the whole trees or roadmap
};

/// `recorder` was the observer of the run, or is null: then there are no samples and edges. Costs
/// exact distances at every waypoint, a few 10 ms. Errors: start, a goal, the path or the memory
/// does not fit the robot.
[[nodiscard]] Result<PlanTrace> make_trace(const Problem& problem, const SolveResult& result,
                                           const PlanRecorder* recorder, double load_time_s,
                                           const TraceSettings& settings = {});
/// The trace as a file: docs/schema/trace.schema.json.
[[nodiscard]] std::string to_json(const PlanTrace& trace);

/// Longest text of a trace that a page is made of.
inline constexpr std::size_t kMaxTraceBytes = std::size_t{256} << 20;

/// One page that shows a trace, without any other file and without a network. `json` is the text of
/// a trace and `source` names it in messages. Errors: text that is no trace, too long, or of
/// another version.
[[nodiscard]] Result<std::string> to_page(std::string_view json, const std::string& source);

}  // namespace mneme
