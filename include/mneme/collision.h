// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Collision checking on SIMD kernels: single states, batches, and motions.
#pragma once

#include "mneme/base.h"
#include "mneme/check.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme {

struct CheckerSettings {
  /// Largest L2 joint distance between two checked states of a motion, radians; left out, the
  /// robot's default: 0.02 for a planar arm, 1/32 otherwise. Halving it doubles the cost of a
  /// motion. At least 1e-4, because a motion that has begun is checked to its end.
  std::optional<double> resolution = std::nullopt;
  /// Metres by which the robot's shapes are inflated against obstacles (not against each other). >=
  /// 0.
  double margin = 0;
  Isa isa = Isa::automatic;
  /// Constraints that valid states and motions keep, in addition to being free.
  std::vector<OrientationConstraint> constraints = {};
};

/// Work done by a checker on behalf of one caller. Not shared between threads.
struct CheckCounters {
  std::uint64_t states = 0;
  std::uint64_t motions = 0;
};

/// How finely a motion is checked, relative to the checker's settings.
struct MotionDetail {
  double refinement = 1;  ///< divides the resolution; 10 for the verification of a final path
  /// Metres added to the margin of links that move; >= 0. In front of points, meshes and octrees
  /// nothing is valid with more than 0.25.
  double margin = 0;
};

/// Margins for all that a motion sweeps.
struct SweepDetail {
  /// Metres to obstacles, beyond the checker's margin, and between links; >= 0, with points, meshes
  /// and octrees as in MotionDetail.
  double margin = 0;
  /// At the ends that are set, this margin is 0; it grows by 1/500 of a link's arc length, so
  /// that what lies close to contact may still leave or reach it.
  bool is_from_start = false, is_to_goal = false;
  /// Links are known to keep apart on this motion: only obstacles are checked.
  bool are_links_apart = false;
};

/// A small step that pulls a limb back along itself while the whole robot is pushed off obstacles.
/// A limb leads from a tip of the robot to the first joint that turns on the way to it: its points
/// are the tip and joints' origins.
struct WalkStep {
  int limb = 0;           ///< less than CollisionChecker::limbs().size()
  int pulled_points = 1;  ///< number of points, from the tip on, that go towards the next one of
                          ///< the limb; 0: nothing is pulled, what is near obstacles is pushed
  float length = 0;       ///< metres that they go; >= 0
  float clearance = 0;    ///< metres that all of the robot is pushed away from obstacles; >= 0
  std::span<const float> drift;   ///< joint_count values: where joints go that nothing pulls,
                                  ///< radians per metre of the step
  std::span<const float> jitter;  ///< 3 values a candidate, added to the unit vectors of
                                  ///< directions, in the axes of most of the scene's boxes
};

struct LimbInfo {
  int points = 0;     ///< that can be pulled; at least 1
  double length = 0;  ///< metres through its points, with slides at 0; positive
};

/// Decides whether configurations and straight motions of a robot are valid: free of contact in a
/// scene and, all along, within the cones of the settings' constraints less kTiltMargin.
/// Left aside are contacts that no motion can change, such as that of the base with the table on
/// which it stands, and those that an obstacle allows (Obstacle::may_touch). Pairs that are checked
/// by exact geometry (Obstacle::exact_links, Scene::exact_pairs) are so in double precision
/// wherever their spheres touch, continuously on motions and with 1e-4 m more of margin there.
/// Joint limits are the caller's business (Robot::describe_violation); a straight motion between
/// configurations within limits stays within them. Where slides go beyond theirs, points, meshes
/// and octrees are known no farther out than the robot reaches within its limits, and 0.25 m more.
/// Copies share their tables; all of it is const and parallel-safe. Kernels compute in float: their
/// answer is that of exact arithmetic except within about 1e-5 m of contact while robot and
/// obstacles stay within 100 m of the origin; the error grows with the size of the largest
/// coordinate (docs/design/numerics.md). A configuration with a value that is not finite, or beyond
/// 1e4 (radians or metres), is not valid.
class CollisionChecker {
 public:
  /// Errors: a link named in the scene that the robot lacks; an obstacle that is empty, not finite,
  /// beyond 10 km (kFarthestShape) or without positive size; parts beyond 10 km (points) or 10000
  /// km (triangles, cubes) in the frame of their own; an instruction set that this machine lacks; a
  /// constraint that does not pass describe_fault().
  [[nodiscard]] static Result<CollisionChecker> make(const Robot& robot, const Scene& scene,
                                                     const CheckerSettings& settings = {});

  [[nodiscard]] const Robot& robot() const;
  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] double resolution() const;
  /// True if the settings left the resolution out.
  [[nodiscard]] bool has_default_resolution() const;
  /// Metres, rounded to single precision.
  [[nodiscard]] double margin() const;
  [[nodiscard]] Isa isa() const;
  [[nodiscard]] std::span<const OrientationConstraint> constraints() const;

  /// `q` has joint_count() values.
  [[nodiscard]] bool is_valid(std::span<const float> q) const;
  [[nodiscard]] bool is_valid(std::span<const double> q) const;

  /// Many states at once: `configurations` is row-major, one configuration a row; `is_valid`
  /// receives one 0 or 1 per row.
  void check_states(std::span<const float> configurations, std::span<std::uint8_t> is_valid) const;

  /// True if all states of the straight motion after `from`, up to and including `to`, are valid at
  /// the resolution; `from` itself is taken to be valid. Continuous joints take the shorter way
  /// round. States are checked a vector at a time, spread along the motion, coarse to fine.
  [[nodiscard]] bool is_motion_valid(std::span<const float> from, std::span<const float> to,
                                     CheckCounters& counters,
                                     const MotionDetail& detail = {}) const;
  [[nodiscard]] bool is_motion_valid(std::span<const double> from, std::span<const double> to,
                                     const MotionDetail& detail = {}) const;

  /// True if every motion from row to row of `configurations` is valid at the resolution, as for
  /// is_motion_valid; the first row is taken to be valid. Saves time where motions are short: they
  /// share vectors.
  [[nodiscard]] bool is_chain_valid(std::span<const float> configurations, CheckCounters& counters,
                                    const MotionDetail& detail = {}) const;

  /// True if nothing touches on the whole motion, also between any two states: bounds on how far
  /// links move around a state decide, closer and closer, down to half the margin, or to 5e-6 m
  /// where there is none or an end is exempt from it. What the motion does not move is taken to be
  /// free. After conservative advancement: Schwarzer, Saha and Latombe,
  /// DOI 10.1109/TRO.2004.838012.
  [[nodiscard]] bool is_sweep_valid(std::span<const float> from, std::span<const float> to,
                                    CheckCounters& counters, const SweepDetail& detail = {}) const;
  /// True if the straight motion keeps the constraints, also between any two states, and so does
  /// whatever is no farther from it than `bow` says of each joint; empty: only the motion.
  [[nodiscard]] bool keeps_constraints(std::span<const float> from, std::span<const float> to,
                                       std::span<const float> bow = {}) const;
  /// Leads `q`, by damped least squares, to a configuration nearby that keeps the constraints with
  /// something to spare. False, and `q` as it was, if there is none that way. Without constraints,
  /// or where they are kept, `q` stays.
  bool project(std::span<float> q) const;
  /// Metres that a point of the robot, or one seen from another link, moves at most where joints
  /// move by `delta` from anywhere between the configurations `from` and `to`.
  [[nodiscard]] double displacement_bound(std::span<const float> from, std::span<const float> to,
                                          std::span<const float> delta) const;

  /// Takes a step from the configuration `from`, or from as many as there are jitters, row by row:
  /// writes a candidate per jitter, a row each, within the limits. Candidates may be in contact all
  /// the same, and where much of a joint's turn moves a link little, far from where they began.
  void walk(std::span<const float> from, const WalkStep& step, std::span<float> candidates) const;
  /// Empty for a robot of more joints than steps are computed for (32).
  [[nodiscard]] std::vector<LimbInfo> limbs() const;

  /// Everything that touches at `q`, in double precision by code that shares nothing with the
  /// kernels.
  [[nodiscard]] std::vector<Contact> contacts(std::span<const double> q) const;
  /// Contacts of obstacles with links that no joint of the group moves, which are left aside.
  [[nodiscard]] std::vector<Contact> fixed_contacts() const;

 private:
  struct Tables;
  explicit CollisionChecker(std::shared_ptr<const Tables> tables) : tables_(std::move(tables)) {}
  std::shared_ptr<const Tables> tables_;
};

}  // namespace mneme
