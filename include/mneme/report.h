// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What came out of a plan, for people and programs: JSON, SVG pictures, traces and their page; and
/// which files none of it may replace.
#pragma once

#include "mneme/base.h"
#include "mneme/check.h"
#include "mneme/pipeline.h"
#include "mneme/trajectory.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme {

/// The nearest that a moving link comes to an obstacle.
struct LeastClearance {
  double distance = 0;  ///< metres between the surfaces
  std::string link;
  std::string obstacle;
};

struct PathMeasures {
  double length = 0;    ///< path_length()
  double straight = 0;  ///< L2 joint distance of its ends: no path between them is shorter
  std::optional<LeastClearance> clearance;  ///< nothing without obstacles
};
/// Looks at exact distances along `path` at the planners' resolution, and sixteen times finer where
/// they are least. Some 10 us a state. `scene` is checked_scene() of what was solved.
[[nodiscard]] PathMeasures measure_path(const Robot& robot, const Scene& scene, const Path& path);

/// Per blocked path of a replay what touches deepest where it is blocked first; without names if
/// nothing does, but the planner's margin or its verification was not kept. Some 100 us.
[[nodiscard]] std::vector<Contact> find_what_blocks(const Problem& problem, const Replay& replay);
/// In a sentence whether a known task was replayed, and if not, why; empty if no memory was asked.
[[nodiscard]] std::string describe_replay(const Problem& problem, const Replay& replay);

/// The keys that `mneme plan --json` prints. `load_time_s` is what opening files and the database
/// took. Without `measures` the keys of its clearance are missing, which cost more than all others;
/// `duration_s` is that of the motion, if there is a trajectory.
[[nodiscard]] std::string to_json(const Problem& problem, const SolveResult& result,
                                  double load_time_s, const PathMeasures* measures = nullptr,
                                  std::optional<double> duration_s = {});

/// A planar picture in the manner of the paper's figures; metres, y upwards.
struct PlanarPicture {
  const Problem* problem = nullptr;
  const GlSampler* gl =
      nullptr;  ///< primitives in coloured rectangles and faint arms of components; may be null
  Path path;    ///< drawn as a fan of arms from start (blue) to goal (red); may be empty
  std::string title;
  int max_arms = 60;  ///< component arms drawn at most
};
/// The picture of a plan, whose title says how it came about. It refers to both.
[[nodiscard]] PlanarPicture make_picture(const Problem& problem, const SolveResult& result);
/// Errors: unsupported if the robot is not planar; invalid if a configuration, a primitive or the
/// mixture does not fit it.
[[nodiscard]] Result<std::string> to_svg(const PlanarPicture& picture);

/// How much of a plan a trace holds: what bounds the size of its page.
struct TraceSettings {
  int waypoints = 200;   ///< along the path at equal steps, besides the path's own configurations
  int samples = 300;     ///< uniform ones, and as many from memory
  int components = 120;  ///< of the retrieved mixture
  int edges = 2000;      ///< of the trees or the roadmap
  /// Where meshes of the robot's looks are searched, as RobotOptions::package_paths.
  std::vector<std::string> package_paths = {};
};

/// A plan in time, for a trace that is played in seconds. It refers to both.
struct TimedPlan {
  const Trajectory* trajectory = nullptr;
  const RateLimits* limits = nullptr;  ///< that it keeps
};

/// Keeps a thinned record of what a planner draws and keeps: once a list is full every second entry
/// goes, so that what remains is spread evenly over the run. Not thread-safe.
class PlanRecorder : public PlanObserver {
 public:
  struct Sample {
    SampleSource source = kUniformSource;
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
  void on_sample(std::span<const float> q, SampleSource source) override;
  void on_edge(std::span<const float> from, std::span<const float> to, int graph) override;

  [[nodiscard]] const Thinned<Sample>& uniform_samples() const { return uniform_; }
  [[nodiscard]] const Thinned<Sample>& memory_samples() const { return memory_; }
  [[nodiscard]] const Thinned<Edge>& edges() const { return edges_; }
  /// How many samples each source gave.
  [[nodiscard]] const std::map<SampleSource, std::uint64_t>& draws() const { return draws_; }

 private:
  Thinned<Sample> uniform_, memory_;
  Thinned<Edge> edges_;
  std::map<SampleSource, std::uint64_t> draws_;
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
    int nearest_link = -1;             ///< index into `links`
    int nearest_obstacle = -1;         ///< index into the scene
    Vec3 tip;                          ///< of the end effector
    double time_s = 0;                 ///< of the trajectory, if there is one
    std::vector<double> velocity;      ///< rad/s or m/s; empty without a trajectory
    std::vector<double> acceleration;  ///< rad/s^2 or m/s^2
  };
  /// What a link looks like, in its frame; nothing is checked against it.
  struct Look {
    Shape shape;
    std::string color;  ///< "#rrggbb", or empty
  };
  /// What touches at the start or at a goal of a plan that was refused for it.
  struct Touch {
    int goal = -1;   ///< index into `goals`, or -1 for the start
    int link = -1;   ///< index into `links`
    int other = -1;  ///< index into `links` if `is_self`, otherwise into the scene
    bool is_self = false;
    double distance = 0;        ///< as Contact
    Vec3 place = Vec3::Zero();  ///< about where
  };
  /// Of the planning group's joints; what a joint does not have is infinite.
  struct Limits {
    std::vector<double> lower, upper, velocity, acceleration;
  };
  /// A configuration as points: the origins of the links that its joints carry, then the tip.
  struct Arm {
    SampleSource source =
        kUniformSource;  ///< or index of the primitive whose experience it is from
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
  std::vector<Link> links;  ///< those with shapes, and those that look like something
  /// Per link: of its URDF's visual elements, or of the attached object that it is; empty if
  /// nothing is known but its shapes.
  std::vector<std::vector<Look>> looks;
  std::vector<std::string> carriers;  ///< per link: the link that carries it if it is an object
  Limits limits;
  double duration_s = 0;  ///< of the trajectory; 0 without one
  std::vector<Touch> touches;
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
/// exact distances at every waypoint, a few 10 ms, and reads the robot's visual meshes, if there
/// are any. With a `timed` plan waypoints are at equal times instead of equal steps. Errors: start,
/// a goal, the path or the memory does not fit the robot.
[[nodiscard]] Result<PlanTrace> make_trace(const Problem& problem, const SolveResult& result,
                                           const PlanRecorder* recorder, double load_time_s,
                                           const TraceSettings& settings = {},
                                           const TimedPlan& timed = {});
/// The trace as a file: docs/schema/trace.schema.json.
[[nodiscard]] std::string to_json(const PlanTrace& trace);
/// Plans and returns the trace of that as a file. Memory learns nothing of it and replays nothing.
/// Errors: those of solve() and make_trace().
[[nodiscard]] Result<std::string> plan_and_trace(const Problem& problem, Database* database,
                                                 SolveSettings settings,
                                                 const TraceSettings& shown = {});

/// Longest text of a trace that a page is made of.
inline constexpr std::size_t kMaxTraceBytes = std::size_t{256} << 20;

/// One page that shows a trace, without any other file and without a network. `json` is the text of
/// a trace and `source` names it in messages; with `beside` it shows that trace, of the same robot
/// and scene, beside it. Errors: text that is no trace, too long, or of another version.
[[nodiscard]] Result<std::string> to_page(std::string_view json, const std::string& source,
                                          std::string_view beside = {});

/// The page at `/` of a service, which asks the service for plans.
struct LivePage {
  std::string html;
  /// Obstacles of points, triangles and cubes: the page's requests name them as the scene
  /// kLivePageScene instead of holding them.
  Scene kept = {};
};
inline constexpr const char* kLivePageScene = "page";
/// The robot in an empty scene at a state of its SRDF, in the middle of its limits or at anything
/// else that is free, in this order.
[[nodiscard]] Problem resting_problem(const Robot& robot, const std::string& robot_path);
/// A live page that begins with `problem`. Errors: those of make_trace().
[[nodiscard]] Result<LivePage> make_live_page(Problem problem, bool has_memory,
                                              const TraceSettings& settings = {});

/// A file that is read.
struct ReadFile {
  std::string what;  ///< "the memory"
  std::string path;
};
/// What a robot is read from: its URDF, and `srdf` or the SRDF beside it.
[[nodiscard]] std::vector<ReadFile> robot_files(const std::string& urdf, const std::string& srdf);
/// Adds those of a problem or a scene.
void add_files(std::string_view what, std::span<const std::string> files,
               std::vector<ReadFile>& all);
/// Adds those of a problem, as `what`, and those of its robot.
void add_problem_files(std::string_view what, const Problem& problem, const std::string& srdf,
                       std::vector<ReadFile>& all);

/// Error: invalid, if one of `outputs` (empty ones do not count) is one of `inputs` under whatever
/// name, another output too, a memory, or called as meshes, clouds and octrees are.
[[nodiscard]] Result<void> check_outputs(std::span<const std::string> outputs,
                                         std::span<const ReadFile> inputs);
/// Error: invalid, if `path` is a memory, sound or not.
[[nodiscard]] Result<void> refuse_memory(const std::string& path);
/// check_outputs(), before hours of work rather than after: also an error if an output is a
/// directory, or is in one that does not exist or may not be written.
[[nodiscard]] Result<void> check_files_to_write(std::span<const std::string> outputs,
                                                std::span<const ReadFile> inputs);

/// The bytes of the file `path`, which may have at most `most_bytes`. Errors name `path`.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::size_t most_bytes);
/// Writes `text` to a temporary file beside `path` and renames it, so that a reader sees the old
/// file or the whole new one. Errors name `path`; a memory is never written over.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view text);
/// Makes a directory and those above it, if they are missing. Errors name `path`.
[[nodiscard]] Result<void> make_directory(const std::string& path);

}  // namespace mneme
