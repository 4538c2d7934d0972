// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Collision checking on SIMD kernels: single states, batches, and motions.
#pragma once

#include "mneme/base.h"
#include "mneme/check.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme {

struct CheckerSettings {
  /// Largest L2 joint distance between two checked states of a motion, radians, at least 1e-4. Half
  /// the value doubles the cost of a motion. Default: 0.02 for a planar arm, 1/32 otherwise.
  std::optional<double> resolution = std::nullopt;
  /// Inflation of the robot's shapes against obstacles, metres, >= 0. Links are not inflated
  /// against each other.
  double margin = 0;
  Isa isa = Isa::automatic;
  /// Orientation constraints that valid states and motions must satisfy.
  std::vector<OrientationConstraint> constraints = {};
};

/// Work that a checker did for one caller. Belongs to one thread.
struct CheckCounters {
  std::uint64_t states = 0;
  std::uint64_t motions = 0;
  /// Estimated cost of checks and escape walks. Unit: to compare the boxes around a body in one
  /// state and around one obstacle. Counted, not timed: equal for equal calls on one instruction
  /// set.
  std::uint64_t work = 0;
};

/// How finely a motion is checked, relative to the checker's settings.
struct MotionDetail {
  double refinement = 1;  ///< divides the resolution; 10 verifies a final path
  /// Added to the margin of moving links, metres, >= 0. Beyond 0.25 every motion near points,
  /// meshes and octrees is invalid.
  double margin = 0;
  /// Upper limit of `margin` for pairs that are checked by exact geometry, metres: some links are
  /// closer to each other wherever they move.
  double most_exact_margin = std::numeric_limits<double>::infinity();

  [[nodiscard]] double exact_margin() const { return std::min(margin, most_exact_margin); }
};

/// Margins of a continuous check.
struct SweepDetail {
  /// Metres, >= 0. Added to the checker's margin to obstacles, and itself the margin between links.
  /// Beyond 0.25 every motion near points, meshes and octrees is invalid.
  double margin = 0;
  /// True if the motion begins at the problem's start, or ends at its goal. At such an end the
  /// margin is 0. It grows with distance from the end, by 1/500 of a link's arc length, so that a
  /// motion may leave or reach a place close to contact.
  bool is_from_start = false, is_to_goal = false;
  /// True if the links are proven to keep apart on this motion: only obstacles are checked.
  bool are_links_apart = false;
};

/// A small step that retracts a limb along itself and pushes the whole robot off obstacles. A limb
/// is the chain from a tip of the robot down to the first revolute joint. A limb's points are the
/// tip and the origins of its joints.
struct WalkStep {
  int limb = 0;  ///< index into CollisionChecker::limbs()
  /// Number of points, counted from the tip, that move towards the limb's next point. 0: only push.
  int pulled_points = 1;
  float length = 0;     ///< distance that pulled points move, metres, >= 0
  float clearance = 0;  ///< distance from obstacles that the push aims at, metres, >= 0
  /// joint_count values: the motion of joints that are not pulled, radians per metre of the step.
  std::span<const float> drift;
  /// 3 values per candidate: a vector added to the unit vector of each pull. Its x, y and z are
  /// along the axes of most boxes of the scene.
  std::span<const float> jitter;
};

/// The cost of a straight motion: its L2 joint distance, or about the seconds that it takes.
struct MotionCost {
  /// Share of the slowest joint's time in the cost; the rest is the L2 norm of all joints' times,
  /// so that joints that are not the slowest matter, too.
  static constexpr float kSlowest = 0.6f;
  /// Seconds per radian or metre of each joint. Empty: the cost is the L2 joint distance.
  std::span<const float> pace = {};
};

/// A path prepared for rating shortcuts. Continuous joints are unwrapped, so that the motion
/// between two rows is a straight line in their values.
struct PathView {
  std::span<const float> rows;         ///< waypoints, joint_count values each; at least two
  std::span<const float> arc_lengths;  ///< of each waypoint from the first; see MotionCost
  std::span<const float> directions;   ///< row by row: displacement per arc length of the motion
                                       ///< that begins at the waypoint
  MotionCost cost = {};                ///< cost of motions: arc lengths are its sums
};

/// Number of candidates that one call rates, the same for all instruction sets.
inline constexpr int kShortcuts = 16;

/// A stretch of a path in which a subset of joints goes straight from one end to the other.
struct Shortcut {
  float begin = 0, end = 0;   ///< arc lengths; begin <= end
  std::uint64_t joints = 0;   ///< subset of joints that go straight: a bit per joint
  float probe = 0.5f;         ///< fraction of the stretch at which its state is checked
  float gain = 0;             ///< reduction of the path's cost (MotionCost)
  bool is_promising = false;  ///< the gain suffices, and the state at `probe` is free of contact
};

/// A point of a path: the share `fraction` of motion number `motion`.
struct PathPoint {
  int motion = 0;
  float fraction = 0;
};

/// Candidates for an inner waypoint: each of four subsets of joints goes 1, 1/2, 1/4 or 1/8 of the
/// way to the straight motion between the waypoint's neighbours.
struct Relaxation {
  static constexpr int kSteps = 4, kSubsets = kShortcuts / kSteps;
  int waypoint = 1;
  std::array<std::uint64_t, kSubsets> subsets = {};  ///< a bit per joint

  [[nodiscard]] std::uint64_t subset(int candidate) const {
    return subsets[static_cast<std::size_t>(candidate / kSteps)];
  }
  [[nodiscard]] float step(int candidate) const {
    return 1.0f / static_cast<float>(1 << candidate % kSteps);
  }
};

/// Largest number of parameters of a family of motions.
inline constexpr int kMostParameters = 4;

/// Changes of a goal configuration with parameters u in [-1, 1]^d:
///   Q(u) = constant + slopes u + u' curvatures u / 2 + r,  |r| <= rest for each joint.
/// A row has joint_count values.
struct GoalShift {
  int parameters = 0;             ///< d, at most kMostParameters
  std::vector<float> constant;    ///< one row
  std::vector<float> slopes;      ///< d rows
  std::vector<float> curvatures;  ///< d rows of d rows: symmetric
  std::vector<float> rest;        ///< one row, >= 0
};

/// A straight motion that bends with its goal. For t in [0, 1]:
///   q(t, u) = from + t (to - from) + (first_share + t (last_share - first_share)) Q(u).
/// Values of continuous joints are not wrapped: such a joint turns as far as they say.
struct FamilyMotion {
  const GoalShift* shift = nullptr;
  std::span<const float> from, to;
  float first_share = 0, last_share = 0;  ///< each >= 0
};

/// A box of times and parameters: `time` +- `half_time`, and `at` +- `half` in units of u.
struct FamilyBox {
  float time = 0, half_time = 0;
  std::array<float, kMostParameters> at = {}, half = {};
};

/// The answer for a box.
struct FamilyVerdict {
  bool is_free = false;
  /// The state in the middle is known to be closer to an obstacle than the margin. May be false if
  /// it is so for an obstacle of many parts, or for two links.
  bool is_in_contact = false;
  /// Not free: how far the first body, or pair of bodies, that may touch can move within the box,
  /// metres: along time, along each parameter, and by curvature and rest.
  std::array<float, 1 + kMostParameters> displacements = {};
  float bent = 0;
  /// The part of `displacements` towards the obstacle; all of it where that is not known.
  std::array<float, 1 + kMostParameters> towards = {};

  [[nodiscard]] float displacement() const {
    float sum = bent;
    for (const float each : displacements) sum += each;
    return sum;
  }
};

struct LimbInfo {
  int points = 0;     ///< number of points that can be pulled, at least 1
  double length = 0;  ///< metres through the points, with prismatic joints at 0; positive
};

/// Decides whether configurations and straight motions of a robot are valid: free of contact in a
/// scene, and within the cones of the settings' constraints less kTiltMargin.
///
/// Ignored contacts: those that no motion can change, such as the base on its table, and those that
/// an obstacle allows (Obstacle::may_touch). Pairs that are checked by exact geometry
/// (Obstacle::exact_links, Scene::exact_pairs) are checked in double precision: by is_sweep_valid()
/// continuously, with 5e-5 m more margin.
///
/// Joint limits are not checked (Robot::describe_violation does that). A straight motion between
/// configurations within limits stays within them. If a prismatic joint is beyond its limits,
/// points, meshes and octrees are ignored where they are farther away than the robot's reach within
/// its limits plus 0.25 m.
///
/// Precision: kernels compute in float. Their answers are exact except within about 1e-5 m of
/// contact, for robots and obstacles within 100 m of the origin (docs/design/numerics.md). A
/// configuration with a value that is not finite, or beyond 1e4 (radians or metres), is not valid.
///
/// Copies share their tables. All functions are const and parallel-safe.
class CollisionChecker {
 public:
  /// Errors: the scene names a link that the robot lacks; this machine lacks the instruction set;
  /// describe_fault() finds a fault in a constraint. An obstacle is an error if it is empty, not
  /// finite, without positive size or beyond 10 km (kFarthestShape). In a compound shape's own
  /// frame, points may be up to 10 km away, triangles and cubes up to 10000 km.
  [[nodiscard]] static Result<CollisionChecker> make(const Robot& robot, const Scene& scene,
                                                     const CheckerSettings& settings = {});

  [[nodiscard]] const Robot& robot() const;
  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] double resolution() const;
  /// True if the settings gave no resolution.
  [[nodiscard]] bool has_default_resolution() const;
  /// Metres, rounded to single precision.
  [[nodiscard]] double margin() const;
  [[nodiscard]] Isa isa() const;
  [[nodiscard]] std::span<const OrientationConstraint> constraints() const;

  /// Returns true if `q`, of joint_count() values, is valid.
  [[nodiscard]] bool is_valid(std::span<const float> q) const;
  [[nodiscard]] bool is_valid(std::span<const double> q) const;

  /// Checks one configuration per row of the row-major `configurations`. Writes 0 or 1 per row to
  /// `is_valid`. `extra_margin`, metres, up to 0.25, is added to the margin; negative, it deflates
  /// the robot's shapes, by no more than their radii, for filters. Pairs that are checked by exact
  /// geometry ignore it.
  void check_states(std::span<const float> configurations, std::span<std::uint8_t> is_valid,
                    CheckCounters& counters, double extra_margin = 0) const;
  void check_states(std::span<const float> configurations, std::span<std::uint8_t> is_valid,
                    double extra_margin = 0) const {
    CheckCounters counters;
    check_states(configurations, is_valid, counters, extra_margin);
  }

  /// True if the states of the straight motion after `from`, up to and including `to`, are valid at
  /// the resolution. `from` itself is assumed valid. Continuous joints turn the shorter way.
  [[nodiscard]] bool is_motion_valid(std::span<const float> from, std::span<const float> to,
                                     CheckCounters& counters,
                                     const MotionDetail& detail = {}) const;
  [[nodiscard]] bool is_motion_valid(std::span<const double> from, std::span<const double> to,
                                     const MotionDetail& detail = {}) const;

  /// True if the motions between consecutive rows of `configurations` pass is_motion_valid(). The
  /// first row is assumed valid. Faster than one call per motion where motions are short, because
  /// short motions share SIMD vectors. If a state touches an obstacle or the robot itself, writes
  /// where to `contact`, unless that is null.
  [[nodiscard]] bool is_chain_valid(std::span<const float> configurations, CheckCounters& counters,
                                    const MotionDetail& detail = {},
                                    std::optional<PathPoint>* contact = nullptr) const;

  /// Writes `gain` and `is_promising` of each shortcut. A shortcut is promising if it reduces the
  /// path's cost by at least `least_gain` and its state at `probe` is free of contact. This is a
  /// quick filter: no other state, no exact geometry and no constraint is checked.
  void rate_shortcuts(const PathView& path, float least_gain,
                      std::span<Shortcut, kShortcuts> shortcuts) const;
  /// Writes by how much each candidate reduces the path's cost; 0 if the candidate is in contact or
  /// gains nothing, and perhaps if it gains less than another that is free. A quick filter, as
  /// rate_shortcuts().
  void rate_relaxations(const PathView& path, const Relaxation& relaxation,
                        std::span<float, kShortcuts> gains) const;

  /// True if nothing touches anywhere on the motion. Halves intervals of the motion until bounds on
  /// the displacement of links exclude contact in each interval. Returns false if contact is not
  /// excluded when the bounds are below half the margin, or below 5e-6 m where the margin is 0.
  /// Links that do not move are assumed free. Conservative advancement: Schwarzer, Saha and
  /// Latombe, DOI 10.1109/TRO.2004.838012.
  [[nodiscard]] bool is_sweep_valid(std::span<const float> from, std::span<const float> to,
                                    CheckCounters& counters, const SweepDetail& detail = {}) const;
  /// True if the motions between consecutive rows of `configurations` pass is_sweep_valid(); the
  /// ends of `detail` are those of the first and the last motion. Where the margin is 0 at an end,
  /// it grows by the arc length of the longest motion. Faster than one call per motion where
  /// motions are short, because they share SIMD vectors.
  [[nodiscard]] bool are_sweeps_valid(std::span<const float> configurations,
                                      CheckCounters& counters,
                                      const SweepDetail& detail = {}) const;
  /// True if every point of the straight motion satisfies the constraints, even if each joint
  /// deviates from the motion by up to its value in `bow` (empty: no deviation).
  [[nodiscard]] bool keeps_constraints(std::span<const float> from, std::span<const float> to,
                                       std::span<const float> bow = {}) const;
  /// Moves `q`, by damped least squares, to a nearby configuration that satisfies the constraints
  /// with some margin. If `q` satisfies them already, it is not changed. Returns false and leaves
  /// `q` unchanged if no such configuration is found.
  bool project(std::span<float> q) const;
  /// Returns an upper bound, metres, of the distance that any point of the robot moves relative to
  /// the root or to another link while the joints move by `delta` between the configurations `from`
  /// and `to`.
  [[nodiscard]] double displacement_bound(std::span<const float> from, std::span<const float> to,
                                          std::span<const float> delta) const;

  /// Decides for each box of a family whether all of its states are free, with `margin` metres
  /// more than the checker's. Checks the state in the middle, with each body inflated by its
  /// displacement within the box, which is exact to first order and bounded beyond. Conservative: a
  /// box that is not free may be free of contact; cut it in two. `margin` is at least 2e-5 m, more
  /// than the rounding of single precision. Valid for states within the limits. Boxes with values
  /// that are not finite are not free; neither are boxes where constraints or exact geometry count.
  /// Without `has_links` links do not count against each other.
  void check_family(const FamilyMotion& motion, std::span<const FamilyBox> boxes, float margin,
                    std::span<FamilyVerdict> verdicts, CheckCounters& counters,
                    bool has_links = true) const;

  /// Takes a step from `from`: one configuration, or one per vector of `step.jitter`, row by row.
  /// Writes one candidate within the limits per vector. Candidates may be in contact, and far from
  /// `from` near singularities. Adds to `counters.work`.
  void walk(std::span<const float> from, const WalkStep& step, std::span<float> candidates,
            CheckCounters& counters) const;
  /// The limbs that walk() can pull. Empty for a robot of more than 32 joints.
  [[nodiscard]] std::vector<LimbInfo> limbs() const;

  /// Returns all contacts at `q`, in double precision, without the kernels. Throws Interrupted.
  [[nodiscard]] std::vector<Contact> contacts(std::span<const double> q) const;
  /// Returns the contacts of obstacles with links that no joint of the group moves: all checks
  /// ignore them.
  [[nodiscard]] std::vector<Contact> fixed_contacts() const;

 private:
  struct Tables;
  explicit CollisionChecker(std::shared_ptr<const Tables> tables) : tables_(std::move(tables)) {}
  std::shared_ptr<const Tables> tables_;
};

}  // namespace mneme
