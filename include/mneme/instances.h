// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random scenes and problems: scenes like a given one, to learn for a workcell that is never quite
/// the same, and problems that are proven to have a path.
#pragma once

#include "mneme/base.h"
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

/// Random numbers, one per entry: uniform within plus and minus the entry, or normal with the entry
/// as standard deviation. Without entries nothing varies.
struct Spread {
  std::vector<double> values;
  bool is_gaussian = false;
};

/// What varies about an obstacle, or about the scene as a whole.
struct Variation {
  /// The name of the obstacles meant, `*` standing for any characters; not of the whole scene.
  std::string name;
  Spread position;  ///< x, y, z, metres
  Spread rpy;       ///< radians, about fixed axes through the obstacle's middle or `center`
  Spread scale;     ///< one number, added to the factor 1 of all lengths, about the same point
  /// Metres, of an obstacle of one shape: full extents of a box; radius and length of a cylinder or
  /// capsule; radius of a sphere. Not of the whole scene.
  Spread size;
  Vec3 center = Vec3::Zero();  ///< of the whole scene only
};
struct Variations {
  Variation scene;                   ///< applied last
  std::vector<Variation> obstacles;  ///< each obstacle may be meant once
};
/// Reads a file of variations (docs/file_formats.md); strict, errors name file, line and key.
[[nodiscard]] Result<Variations> load_variations(const std::string& path);
/// A random scene like `scene`. Sizes are drawn again until they are positive. Errors: a name that
/// no obstacle has, or one that is meant twice; numbers that the obstacle's shape has no use for; a
/// spread that leaves no positive size.
[[nodiscard]] Result<Scene> vary(const Scene& scene, const Variations& variations, Rng& rng);

/// How little a task differs when a cell repeats it.
struct RepeatSettings {
  double obstacles = 0.02;  ///< metres that each obstacle is moved at most, whole and any way
  double goal = 0.03;       ///< metres that the tip of the arm is moved at most, its rotation kept
  /// Metres that the robot's base stands elsewhere at most, along x and y: seen from it, all
  /// obstacles and the pose of the tip at the goal are moved together.
  double base = 0;
  double turn = 0;  ///< radians that the base is turned at most, about its own z
};
/// A task like that of `problem`, whose first goal counts: obstacles and goal are moved uniformly
/// within balls, again until start and goal are free, and the new goal is the solution of inverse
/// kinematics nearest to the old one. Errors: no goal configuration; lengths or a turn below 0; a
/// robot without a tip; no free repeat in 1000 tries; a scene that cannot be checked.
[[nodiscard]] Result<Problem> repeat(const Problem& problem, const RepeatSettings& settings,
                                     Rng& rng);

/// What `make_threaded_instances` draws from.
struct ThreadedSettings {
  std::array<double, 2> gap = {0.1, 0.3};  ///< metres between the two circles
  std::array<int, 2> depth = {3, 5};  ///< links from the first one that crosses the gap to the last
  /// Pairs of circles. 1: the arm leaves a gap; 2: it has to get into another one, too; 3: a third
  /// pair is in the arm's reach.
  int passages = 1;
  std::uint64_t proof_iterations =
      2000000;  ///< of the uniform planner that proves an instance feasible
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(int made, int dropped)> on_progress;  ///< after each candidate
};

/// A planar arm threaded through the gap of a pair of circles, to be brought out of it, and into
/// the gap of the second pair if there is one.
struct ThreadedInstance {
  std::vector<std::array<double, 3>> circles;  ///< x, y, radius; pair by pair
  double gap = 0;                              ///< the first pair's
  int depth = 0;                               ///< the start's
  Configuration start;
  Configuration goal;  ///< no link crosses the first gap
  Path witness;        ///< a path that proves that there is one
};

struct ThreadedInstances {
  std::vector<ThreadedInstance> instances;
  int dropped = 0;  ///< candidates that the proof did not solve
};

/// Changes whenever the same arguments give other instances.
inline constexpr std::string_view kThreadedVersion = "threaded/1";

/// Random instances whose feasibility is proven by RRT-Connect with uniform samples and an
/// iteration limit; those that it cannot solve are dropped and counted. Nothing of it looks at
/// experience, so that what is measured on the instances is not biased towards it. Depends on
/// robot, settings, seed and instruction set alone. Errors: a robot that is no planar arm; ranges
/// that are empty or that no instance fits; passages other than 1 to 3.
[[nodiscard]] Result<ThreadedInstances> make_threaded_instances(const Robot& robot, int count,
                                                                const ThreadedSettings& settings,
                                                                std::uint64_t seed);

/// What `make_enclosed_instances` draws from.
struct EnclosedSettings {
  /// Metres that every box leaves to the robot all along the witness, at least; up to 1. The less,
  /// the harder.
  double clearance = 0.01;
  int boxes = 600;                           ///< fewer where there is no room for more
  std::array<double, 2> size = {0.05, 0.5};  ///< metres, full extents of a box; up to 10
  int through = 2;  ///< random configurations that the witness passes on its way; up to 100
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(int made, int dropped)> on_progress;  ///< after each instance
};

/// A robot whose way from start to goal is enclosed by boxes as near as `clearance` allows.
struct EnclosedInstance {
  Scene scene;
  Configuration start;
  Configuration goal;
  Path witness;  ///< the way that the boxes were put around
};

struct EnclosedInstances {
  std::vector<EnclosedInstance> instances;
  int dropped = 0;  ///< without a way even without boxes
};

/// Changes whenever the same arguments give other instances.
inline constexpr std::string_view kEnclosedVersion = "enclosed/1";

/// Random instances, for any robot, that are as hard as wanted and have a path: the path is made
/// first, through free configurations at random, and boxes at random are kept where they leave it
/// its clearance. Nothing of it looks at experience, nor at how long any planner takes. Depends on
/// robot, settings, seed and instruction set alone. Errors: settings out of their ranges; a robot
/// that finds no way between its configurations.
[[nodiscard]] Result<EnclosedInstances> make_enclosed_instances(const Robot& robot, int count,
                                                                const EnclosedSettings& settings,
                                                                std::uint64_t seed);

}  // namespace mneme
