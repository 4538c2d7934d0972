// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random scenes and problems: variations of a given scene, to learn for a workcell that changes,
/// and problems with a proof that a path exists.
#pragma once

#include "mneme/base.h"
#include "mneme/cell.h"
#include "mneme/path.h"
#include "mneme/problem.h"
#include "mneme/scene.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme {

/// A distribution of numbers around 0, one per entry: uniform within plus and minus the entry, or
/// normal with the entry as standard deviation. Without entries: no variation.
struct Spread {
  std::vector<double> values;
  bool is_gaussian = false;
};

/// Variation of an obstacle, or of the scene as a whole.
struct Variation {
  std::string name;  ///< Name of the obstacles, with `*` for any characters. Unused for the scene.
  Spread position = {};  ///< Translation along x, y and z, metres.
  Spread rpy = {};    ///< Rotation, radians, about the fixed axes x, y and z through the obstacle's
                      ///< middle, or through `center` for the whole scene.
  Spread scale = {};  ///< One number, added to the scale factor 1, about the same point as `rpy`.
  /// Added to the sizes, metres: full extents of a box; radius and length of a cylinder or capsule;
  /// radius of a sphere. Only for obstacles of one shape.
  Spread size = {};
  Vec3 center = Vec3::Zero();  ///< only for the whole scene
};
struct Variations {
  Variation scene = {};                   ///< applied last
  std::vector<Variation> obstacles = {};  ///< at most one per obstacle
};
/// Reads a file of variations (docs/file_formats.md). Errors name file, line and key.
[[nodiscard]] Result<Variations> load_variations(const std::string& path);
/// A random variation of `scene`. Sizes are sampled again until they are positive. Errors: a name
/// that no obstacle has; an obstacle with two variations; a wrong number of values for the shape; a
/// spread without a positive size.
[[nodiscard]] Result<Scene> vary(const Scene& scene, const Variations& variations, Rng& rng);

/// Largest differences between a task and its repetition in a workcell.
struct RepeatSettings {
  double obstacles = 0.02;  ///< translation of each obstacle, metres
  double goal = 0.03;       ///< translation of the tip at the goal, metres
  /// Translation of the robot's base along x and y, metres. Relative to the base, all obstacles and
  /// the pose of the tip at the goal move together.
  double base = 0;
  double turn = 0;  ///< rotation of the base about its z axis, radians
};
/// Returns a repetition of `problem` with its first goal: the task in a slightly changed workcell.
/// Obstacles and goal move by random vectors, uniform within balls; this is repeated until start
/// and goal are free. The new goal is the solution of inverse kinematics nearest to the old one.
/// Errors: no goal configuration; negative settings; a robot without a tip; no free repetition in
/// 1000 tries; a scene that cannot be checked.
[[nodiscard]] Result<Problem> repeat(const Problem& problem, const RepeatSettings& settings,
                                     Rng& rng);

/// Settings of all generators of instances.
struct GeneratorRun {
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(int made, int dropped)> on_progress = {};  ///< after each candidate
};

/// Settings of make_threaded_instances().
struct ThreadedSettings : GeneratorRun {
  std::array<double, 2> gap = {0.1, 0.3};  ///< Range of distances between the two circles, metres.
  /// Range of the number of links from the first that crosses the gap to the last.
  std::array<int, 2> depth = {3, 5};
  /// Pairs of circles. 1: the arm leaves a gap. 2: it also enters another one. 3: another pair is
  /// in the arm's reach.
  int passages = 1;
  std::uint64_t proof_iterations = 2000000;  ///< Limit of the planner that proves feasibility.
};

/// A problem of a planar arm that starts in the gap of a pair of circles and has to leave it. If
/// ThreadedSettings::passages is 2 or 3, it then has to enter the gap of the second pair.
struct ThreadedInstance {
  std::vector<std::array<double, 3>> circles;  ///< x, y, radius; pair by pair
  double gap = 0;                              ///< between the circles of the first pair, metres
  int depth = 0;                               ///< ThreadedSettings::depth of the start
  Configuration start;
  Configuration goal;  ///< no link crosses the first gap
  Path witness;        ///< a path from start to goal
};

struct ThreadedInstances {
  std::vector<ThreadedInstance> instances;
  int dropped = 0;  ///< candidates without a proof
};

/// Version of make_threaded_instances(): changes whenever the same arguments give other instances.
inline constexpr std::string_view kThreadedVersion = "threaded/1";

/// Random instances, each with a path that RRT-Connect found with uniform samples. Unsolved
/// candidates are dropped and counted. Experience is never used, so that measurements are not
/// biased towards it. Deterministic for equal robot, settings, seed and instruction set.
/// Errors: a robot that is no planar arm; empty ranges; ranges without any instance; passages other
/// than 1 to 3.
[[nodiscard]] Result<ThreadedInstances> make_threaded_instances(const Robot& robot, int count,
                                                                const ThreadedSettings& settings,
                                                                std::uint64_t seed);

/// Settings of make_enclosed_instances().
struct EnclosedSettings : GeneratorRun {
  /// Least distance between the robot and each box along the witness, metres, up to 1. Smaller is
  /// harder.
  double clearance = 0.01;
  int boxes = 600;                           ///< number of boxes; fewer if there is no room
  std::array<double, 2> size = {0.05, 0.5};  ///< range of the full extents, metres, up to 10
  int through = 2;  ///< random configurations that the witness passes through, up to 100
};

/// A problem with boxes around a path from start to goal, as near as `clearance` allows.
struct EnclosedInstance {
  Scene scene;
  Configuration start;
  Configuration goal;
  Path witness;  ///< the path that the boxes surround
};

struct EnclosedInstances {
  std::vector<EnclosedInstance> instances;
  int dropped = 0;  ///< candidates without a path even in the empty scene
};

/// Version of make_enclosed_instances(): changes whenever the same arguments give other instances.
inline constexpr std::string_view kEnclosedVersion = "enclosed/1";

/// Random instances of chosen difficulty with a known path, for any robot. The path is planned
/// first, through random free configurations in the empty scene. Then random boxes are added that
/// keep the clearance. Neither experience nor planning times are used. Deterministic for equal
/// robot, settings, seed and instruction set. Errors: settings out of range; no path between random
/// configurations of the robot.
[[nodiscard]] Result<EnclosedInstances> make_enclosed_instances(const Robot& robot, int count,
                                                                const EnclosedSettings& settings,
                                                                std::uint64_t seed);

/// Settings of make_composed_instances().
struct ComposedSettings : GeneratorRun {
  /// Least distance between the robot and a module's boxes along the module's motion, metres, up to
  /// 1. Smaller is harder.
  double clearance = 0.004;
  double open = 0.05;  ///< distance that boxes keep from the rest of the witness, metres, up to 1
  int boxes = 600;     ///< number of boxes of a module; fewer if there is no room
  std::array<double, 2> size = {0.03, 0.25};  ///< range of the full extents, metres, up to 10
  int modules = 12;                           ///< number of modules to compose, up to 1000
  int foreign = 0;  ///< number of further modules, which no instance contains, up to 1000
  std::array<int, 2> passages = {1, 3};  ///< range of modules in an instance, up to 8
};

/// A passage: boxes around a short motion.
struct ComposedModule {
  Scene scene;
  Path motion;  ///< three waypoints
};

/// A module in an instance.
struct ComposedPart {
  int module = 0;            ///< index into ComposedInstances::modules
  double turn = 0;           ///< rotation about the robot's axis, radians
  bool is_reversed = false;  ///< True: the witness follows the motion backwards
};

/// A problem with modules in series, each turned about the robot's axis.
struct ComposedInstance {
  Scene scene;
  Configuration start;
  Configuration goal;
  Path witness;  ///< through all modules
  std::vector<ComposedPart> parts;
};

struct ComposedInstances {
  std::vector<ComposedModule> modules;  ///< those of instances first, then foreign ones
  std::vector<ComposedInstance> instances;
  int dropped = 0;  ///< candidates whose modules could not be combined
};

/// Version of make_composed_instances(): changes whenever the same arguments give other instances.
inline constexpr std::string_view kComposedVersion = "composed/1";

/// Random modules, and problems composed of them: what was learned in each module alone is met
/// again at another place, in another order and direction. An instance with one module starts in
/// that module and ends in the open. An instance with several ends in the last one. Boxes in the
/// way of the rest of the witness are dropped, at most 60 % of a module. Neither experience nor
/// planning times are used. Deterministic for equal robot, settings, seed and instruction set.
/// Errors: settings out of range; a robot without a turning joint (SymmetricJoints); too few
/// modules that can be combined.
[[nodiscard]] Result<ComposedInstances> make_composed_instances(const Robot& robot, int count,
                                                                const ComposedSettings& settings,
                                                                std::uint64_t seed);

/// A problem without a path. Its proof: a shape of `link` that `joint` moves, and no other joint
/// except along the axis, contains a point of a post where `joint` is at one of `angles`. Each path
/// from start to goal passes one of them.
struct BlockedInstance {
  Scene scene;  ///< the posts
  Configuration start;
  Configuration goal;
  std::string joint, link;
  std::vector<double> angles;  ///< per post; two for a continuous joint
};

struct BlockedInstances {
  std::vector<BlockedInstance> instances;
  int dropped = 0;  ///< candidates without free ends on both sides
};

/// Version of make_blocked_instances(): changes whenever the same arguments give other instances.
inline constexpr std::string_view kBlockedVersion = "blocked/1";

/// Random infeasible instances, each with a proof. Start and goal are free. Deterministic for equal
/// robot, seed and instruction set. Errors: a robot without a turning joint (SymmetricJoints), or
/// whose turning joint alone moves no shape off its axis; no free ends.
[[nodiscard]] Result<BlockedInstances> make_blocked_instances(const Robot& robot, int count,
                                                              const GeneratorRun& run,
                                                              std::uint64_t seed);

/// A region around the goal of a problem.
struct RegionSettings {
  std::string link;  ///< link whose poses are the tasks
  CellTask half_extents = {0.15, 0.1, 0.025, 0.785};
  Vec3 pivot = Vec3::Zero();  ///< CellRegion::pivot
  int tries = 40;             ///< middles to try; 1: the goal itself
  std::uint64_t seed = 1;
};

/// Makes a region from a problem of one configuration or pose as goal. Its x axis is along the
/// largest box of the scene. Obstacles smaller than 0.3 m and within 0.1 m of the pivot are
/// dropped, as if they were grasped. Tries `tries` middles within 0.25 m of the goal, and takes the
/// one with most tasks that can be reached 0.02 m clear. Errors: invalid, for another link or goal;
/// those of CollisionChecker::make().
[[nodiscard]] Result<CellRegion> make_region(const Problem& problem,
                                             const RegionSettings& settings);

}  // namespace mneme
