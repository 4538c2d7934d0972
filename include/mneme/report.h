// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Results of planning for people and programs: JSON, SVG pictures, traces and their page. Also the
/// files that outputs must not replace.
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

/// The smallest distance between a moving link and an obstacle along a path.
struct LeastClearance {
  double distance = 0;  ///< metres between the surfaces
  std::string link;
  std::string obstacle;
};

struct PathMeasures {
  double length = 0;    ///< path_length()
  double straight = 0;  ///< L2 joint distance from start to end: a lower bound of `length`
  std::optional<LeastClearance> clearance = {};  ///< empty without obstacles
};
/// Measures `path` with exact distances at the planners' resolution, and 16 times finer around the
/// smallest one. `scene` is checked_scene() of the solved problem. Cost: about 10 us per state.
[[nodiscard]] PathMeasures measure_path(const Robot& robot, const Scene& scene, const Path& path);

/// Returns the deepest contact of each path in Replay::blocked at its first state in contact. A
/// contact without names means that nothing touches there, but the margin is not kept or
/// verification failed. Cost: about 100 us.
[[nodiscard]] std::vector<Contact> find_what_blocks(const Problem& problem, const Replay& replay);
/// Says in a sentence whether a known task was replayed, and if not, why. Empty if no memory was
/// queried.
[[nodiscard]] std::string describe_replay(const Problem& problem, const Replay& replay);

/// Returns the JSON that `mneme plan --json` prints. `load_time_s`: seconds to open files and the
/// database. `measures`: null leaves out the keys of the clearance, the costliest ones.
/// `motion`: of the trajectory, if there is one.
[[nodiscard]] std::string to_json(const Problem& problem, const SolveResult& result,
                                  double load_time_s, const PathMeasures* measures = nullptr,
                                  const MotionMeasures* motion = nullptr);

/// A planar picture in the style of the paper's figures. Metres, y upwards.
struct PlanarPicture {
  const Problem* problem = nullptr;
  /// Shows primitives as coloured rectangles and components as faint arms. May be null.
  const GlSampler* gl = nullptr;
  Path path = {};  ///< shown as arms from start (blue) to goal (red); may be empty
  std::string title = {};
  int max_arms = 60;  ///< most components shown
};
/// Returns the picture of a plan. Its title names planner, sampler, status and time. Both arguments
/// must outlive the picture.
[[nodiscard]] PlanarPicture make_picture(const Problem& problem, const SolveResult& result);
/// Returns the picture as an SVG document. Errors: unsupported if the robot is not planar; invalid
/// if a configuration, a primitive or the mixture does not fit the robot.
[[nodiscard]] Result<std::string> to_svg(const PlanarPicture& picture);

/// A path in space as an animated SVG picture, for pages without scripts. The robot appears as the
/// hulls of its links, blue at the start and red at the goal. Point clouds, meshes and octrees are
/// not shown.
struct MovingPicture {
  const Problem* problem = nullptr;
  Path path;                ///< two configurations or more
  double azimuth = -0.9;    ///< direction of the viewer about z, radians
  double elevation = 0.45;  ///< angle of the viewer above the horizon, radians
  int frames = 40;          ///< three or more, at equal joint distances
  double seconds = 6;       ///< duration of a cycle
};
/// Returns the picture as an SVG document. Errors: invalid without a path. Cost: some 10 ms for a
/// robot of 2000 spheres.
[[nodiscard]] Result<std::string> to_svg(const MovingPicture& picture);

/// Largest counts in a trace, which bound the size of its page.
struct TraceSettings {
  int waypoints = 200;   ///< equal steps along the path
  int samples = 300;     ///< uniform samples, and as many from memory
  int components = 120;  ///< components of the retrieved mixture
  int edges = 2000;      ///< edges of the trees or the roadmap
  /// As RobotOptions::package_paths, for visual meshes.
  std::vector<std::string> package_paths = {};
};

/// Trajectory and rate limits of a plan, for a trace that is played in seconds. Both must outlive
/// this struct.
struct TimedPlan {
  const Trajectory* trajectory = nullptr;
  const RateLimits* limits = nullptr;  ///< kept by the trajectory
};

/// Records samples and edges of a planner. A full list drops every second entry, so that the
/// remaining ones are spread evenly over the run. Not thread-safe.
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
    /// Counts an entry. Returns true if the entry must be added.
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
  /// The number of samples of each source.
  [[nodiscard]] const std::map<SampleSource, std::uint64_t>& sample_counts() const {
    return sample_counts_;
  }

 private:
  Thinned<Sample> uniform_, memory_;
  Thinned<Edge> edges_;
  std::map<SampleSource, std::uint64_t> sample_counts_;
};

/// A plan as geometry in the frame of the robot's root link, for viewers without a robot model
/// (docs/file_formats.md). Metres, radians, seconds.
struct PlanTrace {
  /// The robot at one configuration: a pose per entry of `links`.
  using Poses = std::vector<Transform>;
  struct Waypoint {
    Configuration q;
    Poses poses;
    double travelled = 0;  ///< L2 joint distance from the start along the path
    /// Metres from the robot to the nearest obstacle. Negative in contact, infinite without
    /// obstacles.
    double clearance = 0;
    int nearest_link = -1;             ///< index into `links`
    int nearest_obstacle = -1;         ///< index into the scene
    Vec3 tip;                          ///< position of the end effector
    double time_s = 0;                 ///< time in the trajectory; 0 without one
    std::vector<double> velocity;      ///< rad/s or m/s; empty without a trajectory
    std::vector<double> acceleration;  ///< rad/s^2 or m/s^2
  };
  /// A visual shape of a link, in the link's frame. It is shown and never checked.
  struct Look {
    Shape shape;
    std::string color;  ///< "#rrggbb", or empty
  };
  /// A contact at the start or a goal, because of which the plan was refused.
  struct Touch {
    int goal = -1;   ///< index into `goals`, or -1 for the start
    int link = -1;   ///< index into `links`
    int other = -1;  ///< index into `links` if `is_self`, otherwise into the scene
    bool is_self = false;
    double distance = 0;        ///< as Contact::distance
    Vec3 place = Vec3::Zero();  ///< an approximate position
  };
  /// Limits of the planning group's joints; missing ones are infinite.
  struct Limits {
    std::vector<double> lower, upper, velocity, acceleration;
  };
  /// A configuration as points: the origins of the links that its joints carry, then the tip.
  struct Arm {
    SampleSource source = kUniformSource;  ///< or the index of a primitive
    std::vector<Vec3> points;
  };
  struct Primitive {
    LocalPrimitive primitive;
    bool is_learned = false;
    std::vector<double> similarity_errors;  ///< errors of the primitive's matches, nearest first;
                                            ///< m^2
    int components = 0;                     ///< components of all matches of the primitive
    std::uint64_t sample_count = 0;         ///< samples from experience of the primitive
  };
  struct Edge {
    int graph = 0;
    std::vector<Vec3> tips;  ///< end-effector positions along the motion
  };

  std::string problem, robot;
  bool is_planar = false;
  SolveResult result;  ///< without the rows and the mixture from memory
  double load_time_s = 0;
  double path_length = 0;
  std::vector<Link> links;  ///< links with collision or visual shapes
  /// Visual shapes per link: the visual elements of the URDF, or the shapes of the attached object.
  /// Empty: the collision shapes are shown.
  std::vector<std::vector<Look>> looks;
  std::vector<std::string> carriers;  ///< per attached object the carrying link, or ""
  Limits limits;
  double duration_s = 0;  ///< duration of the trajectory; 0 without one
  std::vector<Touch> touches;
  std::vector<std::string> joints;  ///< joint names in the order of a configuration
  Scene scene;
  Poses start;
  std::vector<Poses> goals;
  std::vector<Waypoint> waypoints;  ///< states along the path, from start to goal
  std::vector<int> vertices;        ///< indices of the path's own configurations
  std::vector<Primitive> primitives;
  std::vector<Arm> components;  ///< means of the retrieved mixture
  int component_count = 0;      ///< size of the whole mixture
  std::vector<Arm> samples;
  std::uint64_t uniform_count = 0;  ///< all uniform samples
  std::vector<Edge> edges;
  std::uint64_t edge_count = 0;  ///< size of the whole trees or roadmap
};

/// Returns the trace of a plan. `recorder`: the observer of the run; null leaves out samples and
/// edges. With `timed`, waypoints are at equal times instead of equal steps. Errors: start, a goal,
/// the path or the memory does not fit the robot. Cost: exact distances at every waypoint, a few 10
/// ms, and reading the visual meshes.
[[nodiscard]] Result<PlanTrace> make_trace(const Problem& problem, const SolveResult& result,
                                           const PlanRecorder* recorder, double load_time_s,
                                           const TraceSettings& settings = {},
                                           const TimedPlan& timed = {});
/// Returns the trace as JSON (docs/schema/trace.schema.json).
[[nodiscard]] std::string to_json(const PlanTrace& trace);
/// Plans and returns the trace as JSON. Nothing is inserted into memory, and nothing is replayed.
/// Errors: as solve() and make_trace().
[[nodiscard]] Result<std::string> plan_and_trace(const Problem& problem, Database* database,
                                                 SolveSettings settings,
                                                 const TraceSettings& shown = {});

/// Largest trace that to_page() takes.
inline constexpr std::size_t kMaxTraceBytes = std::size_t{256} << 20;

/// Returns an HTML page that shows a trace and needs no other file and no network. `json`: a trace,
/// which messages call `source`. `beside`: a second trace of the same robot, shown beside the
/// first. Errors: not a trace, too large, or of another version.
[[nodiscard]] Result<std::string> to_page(std::string_view json, const std::string& source,
                                          std::string_view beside = {});

/// An input file.
struct ReadFile {
  std::string what;  ///< the file's role in messages, such as "the memory"
  std::string path;
};
/// Returns the files of a robot: its URDF, `srdf` and the SRDF beside the URDF.
[[nodiscard]] std::vector<ReadFile> robot_files(const std::string& urdf, const std::string& srdf);
/// Adds the files of a problem or a scene.
void add_files(std::string_view what, std::span<const std::string> files,
               std::vector<ReadFile>& all);
/// Adds the files of a problem, as `what`, and the files of its robot.
void add_problem_files(std::string_view what, const Problem& problem, const std::string& srdf,
                       std::vector<ReadFile>& all);

/// Checks the output files of a command. Error: invalid if an output is also an input under any
/// name, is named twice, is a database of experience, or has the extension of a mesh, point cloud
/// or octree. Empty outputs are ignored.
[[nodiscard]] Result<void> check_outputs(std::span<const std::string> outputs,
                                         std::span<const ReadFile> inputs);
/// Refuses to write over a database. Error: invalid if `path` is a database of experience, even a
/// damaged one.
[[nodiscard]] Result<void> refuse_memory(const std::string& path);
/// As check_outputs(), for use before long work. Also an error: an output is a directory, or its
/// directory does not exist or cannot be written.
[[nodiscard]] Result<void> check_files_to_write(std::span<const std::string> outputs,
                                                std::span<const ReadFile> inputs);

/// Returns the bytes of the file `path`. Errors: io; unsupported above `most_bytes`.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::size_t most_bytes);
/// Writes a file that readers see whole or not at all: it is renamed when complete. Pipes and
/// devices are written directly. Errors: io; invalid if `path` is a database of experience, which
/// no output replaces.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view text);
/// Makes a directory and its parents if they are missing. Errors: io.
[[nodiscard]] Result<void> make_directory(const std::string& path);

}  // namespace mneme
