// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "base/as_index.h"
#include "check/cones.h"
#include "check/link_distances.h"
#include "collision/collision_kernels.h"
#include "collision/family_kernel.h"
#include "collision/shortcut_kernel.h"
#include "tables/make_tables.h"
#include "robot/joint_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace mneme::internal {

/// The tables that the kernels read.
struct KernelWorld {
  std::shared_ptr<const RobotTables> robot;
  SceneTables scene;
};

}  // namespace mneme::internal

namespace mneme {
namespace {

using World = internal::KernelWorld;
using FloatConfiguration = std::array<float, internal::kMaxFrames>;

FloatConfiguration to_float(std::span<const double> q) {
  FloatConfiguration result;
  assert(q.size() <= result.size());
  std::transform(q.begin(), q.end(), result.begin(),
                 [](double x) { return static_cast<float>(x); });
  return result;
}

/// Largest joint value, radians or metres. Beyond it single precision cannot place a link, and the
/// kernels' comparisons would find no contact, as with a NaN.
constexpr float kFarthest = 1e4f;

/// Runs for every motion, so it compares bits: those of positive floats have the order of their
/// values, infinity and NaN above all.
bool is_within_reach(std::span<const float> q) {
  constexpr std::uint32_t kMagnitude = 0x7fffffff;
  std::uint32_t farthest = 0;
  for (const float value : q) {
    farthest = std::max(farthest, std::bit_cast<std::uint32_t>(value) & kMagnitude);
  }
  return farthest <= std::bit_cast<std::uint32_t>(kFarthest);
}

constexpr double kPlanarResolution = 0.02;
constexpr double kSpatialResolution = 1.0 / 32;
constexpr double kLeastResolution = 1e-4;
/// Relative. A step of exactly n states must not cost another vector because its length is a
/// rounding error larger.
constexpr double kLengthTolerance = 1e-5;
constexpr double kMostStates = 1e9;

/// Half of a first interval moves no link by more than this share of what one radian could.
constexpr float kFirstSweep = 0.035f, kFirstPlanarSweep = 0.04f;
/// Displacement around the last states that are checked, metres, where there is no margin.
constexpr float kFinestSweep = 5e-6f;
constexpr float kMostIntervals = 1e6f;
constexpr float kLeastShare = 1e-6f;

/// Returns the tables without the pairs that are checked by exact geometry.
World make_world(const std::shared_ptr<const internal::CheckedRobot>& checked, const Robot& robot,
                 const Scene& scene, internal::SceneTables tables) {
  tables.may_touch = internal::find_allowed_contacts(robot, checked->tables, scene);
  tables.clearances = internal::find_clearances(checked->tables, tables);
  World world{{checked, &checked->tables}, std::move(tables)};
  // The robot's own exact pairs are not in its tables.
  if (scene.exact_pairs.empty()) return world;
  std::set<std::pair<int, int>> exact;
  for (const internal::LinkPair& pair : internal::link_pairs(robot, scene)) {
    if (pair.is_exact) exact.insert(std::minmax(pair.first, pair.second));
  }
  world.robot = std::make_shared<const internal::RobotTables>(
      internal::without_pairs(checked->tables, exact));
  return world;
}

}  // namespace

struct CollisionChecker::Tables {
  Robot robot;
  Scene scene;
  double resolution = 0;
  bool has_default_resolution = true;
  float margin = 0;
  Isa isa = Isa::scalar;
  internal::JointSpace space;
  std::shared_ptr<const internal::CheckedRobot> checked_robot;
  World world;
  const internal::CollisionKernels* kernels = nullptr;
  const internal::ShortcutKernels* shortcut_kernels = nullptr;
  internal::WalkKernel walk_kernel = nullptr;
  internal::FamilyKernel family_kernel = nullptr;
  internal::Cones cones;
  internal::ExactPairs exact_pairs;
  internal::SceneTables no_obstacles;

  [[nodiscard]] std::size_t joints() const { return internal::as_index(space.joint_count()); }

  /// Number of states of a motion, at most kMostStates: no joint space with finite limits needs
  /// more.
  [[nodiscard]] int count_states(float length, double refinement) const {
    const double wanted = length * refinement / resolution;
    return static_cast<int>(std::min(std::ceil(wanted * (1 - kLengthTolerance)), kMostStates));
  }

  /// The tables lack parts of compound shapes beyond the robot's reach plus kSpareReach.
  [[nodiscard]] bool can_keep(double extra_margin) const {
    return world.scene.compounds.empty() || extra_margin <= internal::kSpareReach;
  }

  /// ExactPairs::KnownStates: the states at which the spheres of two links are apart.
  [[nodiscard]] bool find_apart(std::pair<int, int> links, std::span<const float> states,
                                std::span<std::uint8_t> apart, CheckCounters& counters) const {
    const auto& pairs = *checked_robot->exact_pairs;
    const auto pair = std::ranges::find(pairs, links, &internal::PairTables::links);
    if (pair == pairs.end()) return false;
    kernels->check_states(pair->tables, no_obstacles, states.data(), static_cast<int>(apart.size()),
                          0, apart.data(), counters);
    return true;
  }

  /// Exact geometry decides at states of the motion where the spheres of a pair touch.
  [[nodiscard]] bool are_exact_pairs_apart(std::span<const float> from,
                                           std::span<const float> delta, int count, double extra,
                                           CheckCounters& counters) const {
    if (exact_pairs.empty()) return true;
    // Spheres keep no margin between links.
    if (count <= 0) return exact_pairs.stay_apart(from, {}, extra);
    constexpr int kMostKept = 10000;  // others would fill the memory
    if (count > kMostKept) return exact_pairs.are_apart_at_states(from, delta, extra, count, {});
    std::vector<float> states;  // made when the first pair needs them
    const auto known = [&](std::pair<int, int> links, std::span<std::uint8_t> apart) {
      const int missing = states.empty() ? count : 0;
      for (int k = 1; k <= missing; ++k) {
        const float share = static_cast<float>(k) / static_cast<float>(count);
        for (std::size_t j = 0; j < from.size(); ++j) states.push_back(from[j] + share * delta[j]);
      }
      return find_apart(links, states, apart, counters);
    };
    return exact_pairs.are_apart_at_states(from, delta, extra, count, known);
  }

  /// Bounds of every motion from a row of `points` by the same row of `deltas`.
  [[nodiscard]] internal::Displacements find_displacements(std::span<const float> points,
                                                           std::span<const float> deltas) const {
    internal::Displacements most;
    FloatConfiguration end;
    for (std::size_t i = 0; i < points.size(); i += joints()) {
      const auto from = points.subspan(i, joints()), delta = deltas.subspan(i, joints());
      std::ranges::transform(from, delta, end.begin(), std::plus());
      most.include(internal::find_displacements(*world.robot, from, {end.data(), joints()}, delta));
    }
    return most;
  }

  /// Checks the motions from the rows of `points` by the rows of `deltas`.
  [[nodiscard]] bool are_sweeps_free(std::span<const float> points, std::span<const float> deltas,
                                     const SweepDetail& detail, CheckCounters& counters) const {
    internal::Displacements moved = find_displacements(points, deltas);
    if (!(moved.longest > 0)) return true;
    // The kernel skips pairs that do not approach.
    if (detail.are_links_apart) std::ranges::fill(moved.pairs, 0.0f);
    const auto extra = static_cast<float>(detail.margin);
    const float share = robot.is_planar() ? kFirstPlanarSweep : kFirstSweep;
    const float first = share * moved.farthest_reach;
    const auto count = static_cast<int>(points.size() / joints());
    const float most = std::max(kMostIntervals / static_cast<float>(count), 1.0f);
    const float intervals = std::clamp(0.5f * moved.longest / first, 1.0f, most);
    // The margin is 0 at the start and the goal of the problem.
    const bool keeps_margin = !detail.is_from_start && !detail.is_to_goal;
    const float finest = keeps_margin ? std::max(0.5f * extra, kFinestSweep) : kFinestSweep;
    const internal::SweptChain chain{points.data(),
                                     deltas.data(),
                                     count,
                                     moved.bodies.data(),
                                     moved.pairs.data(),
                                     margin,
                                     extra,
                                     detail.is_from_start,
                                     detail.is_to_goal,
                                     static_cast<int>(intervals),
                                     std::max(finest / moved.longest, kLeastShare / intervals)};
    return kernels->is_sweep_free(*world.robot, world.scene, chain, counters);
  }
};

Result<CollisionChecker> CollisionChecker::make(const Robot& robot, const Scene& scene,
                                                const CheckerSettings& settings) {
  const double preset = robot.is_planar() ? kPlanarResolution : kSpatialResolution;
  const double resolution = settings.resolution.value_or(preset);
  if (!(resolution >= kLeastResolution) || !std::isfinite(resolution)) {
    return fail(ErrorCode::invalid, fmt::format("the resolution is {}; expected {} radians or more",
                                                resolution, kLeastResolution));
  }
  if (!(settings.margin >= 0) || !std::isfinite(settings.margin)) {
    return fail(ErrorCode::invalid,
                fmt::format("the margin is {}; expected 0 metres or more", settings.margin));
  }
  if (!is_available(settings.isa)) {
    return fail(ErrorCode::unsupported, "this machine does not have the instruction set " +
                                            std::string(to_string(settings.isa)));
  }
  auto checked = MNEME_TRY(internal::share_checked_robot(robot));
  MNEME_TRY(internal::check_named_links(robot, scene));
  auto scene_tables =
      MNEME_TRY(internal::make_scene_tables(scene, checked->reach + settings.margin));
  internal::ExactPairs exact_pairs(robot, checked->links, scene, settings.margin);
  World world = make_world(checked, robot, scene, std::move(scene_tables));
  for (const OrientationConstraint& constraint : settings.constraints) {
    if (const auto fault = describe_fault(robot, constraint)) {
      return fail(ErrorCode::invalid, *fault);
    }
  }

  const Isa isa = resolve_isa(settings.isa);
  auto tables = std::make_shared<Tables>(
      Tables{robot, scene, resolution, !settings.resolution, static_cast<float>(settings.margin),
             isa, internal::JointSpace(robot), std::move(checked), std::move(world),
             &internal::collision_kernels(isa), &internal::shortcut_kernels(isa),
             internal::walk_kernel(isa), internal::family_kernel(isa),
             internal::Cones(robot, settings.constraints), std::move(exact_pairs),
             MNEME_TRY(internal::make_scene_tables({}))});
  return CollisionChecker(std::move(tables));
}

const Robot& CollisionChecker::robot() const { return tables_->robot; }
const Scene& CollisionChecker::scene() const { return tables_->scene; }
double CollisionChecker::resolution() const { return tables_->resolution; }
bool CollisionChecker::has_default_resolution() const { return tables_->has_default_resolution; }
double CollisionChecker::margin() const { return tables_->margin; }
Isa CollisionChecker::isa() const { return tables_->isa; }
std::span<const OrientationConstraint> CollisionChecker::constraints() const {
  return tables_->cones.constraints();
}

bool CollisionChecker::is_valid(std::span<const float> q) const {
  std::uint8_t is_free = 0;
  check_states(q, {&is_free, 1});
  return is_free != 0;
}

bool CollisionChecker::is_valid(std::span<const double> q) const {
  const FloatConfiguration values = to_float(q);
  return is_valid(std::span<const float>(values.data(), q.size()));
}

void CollisionChecker::check_states(std::span<const float> configurations,
                                    std::span<std::uint8_t> is_valid, CheckCounters& counters,
                                    double extra_margin) const {
  const Tables& t = *tables_;
  assert(configurations.size() == is_valid.size() * t.joints());
  assert(t.can_keep(extra_margin));
  counters.states += is_valid.size();
  const float margin = t.margin + static_cast<float>(extra_margin);
  t.kernels->check_states(*t.world.robot, t.world.scene, configurations.data(),
                          static_cast<int>(is_valid.size()), margin, is_valid.data(), counters);
  const std::size_t joints = t.joints();
  for (std::size_t i = 0; i < is_valid.size(); ++i) {
    const auto q = configurations.subspan(i * joints, joints);
    const bool is_free = is_valid[i] != 0 && is_within_reach(q) && t.cones.contain(q);
    is_valid[i] = is_free ? 1 : 0;
  }
  if (t.exact_pairs.empty()) return;
  t.exact_pairs.check_states(configurations, is_valid,
                             [&](std::pair<int, int> links, std::span<std::uint8_t> apart) {
                               return t.find_apart(links, configurations, apart, counters);
                             });
}

bool CollisionChecker::is_motion_valid(std::span<const float> from, std::span<const float> to,
                                       CheckCounters& counters, const MotionDetail& detail) const {
  const Tables& t = *tables_;
  ++counters.motions;
  const float margin = t.margin + static_cast<float>(detail.margin);
  if (!t.can_keep(detail.margin) || !is_within_reach(from) || !is_within_reach(to)) return false;
  if (!keeps_constraints(from, to)) return false;
  FloatConfiguration delta;
  const float length = t.space.difference(from.data(), to.data(), delta.data());
  const int states = t.count_states(length, detail.refinement);
  return t.kernels->is_motion_free(*t.world.robot, t.world.scene, from.data(), delta.data(), states,
                                   margin, counters) &&
         t.are_exact_pairs_apart(from, {delta.data(), from.size()}, states, detail.exact_margin(),
                                 counters);
}

bool CollisionChecker::is_chain_valid(std::span<const float> configurations,
                                      CheckCounters& counters, const MotionDetail& detail,
                                      std::optional<PathPoint>* contact) const {
  const Tables& t = *tables_;
  const std::size_t joints = t.joints();
  assert(configurations.size() % joints == 0);
  if (configurations.size() < 2 * joints) return true;
  if (!t.can_keep(detail.margin) || !is_within_reach(configurations)) return false;
  const float margin = t.margin + static_cast<float>(detail.margin);
  const std::size_t count = configurations.size() / joints - 1;
  counters.motions += count;
  for (std::size_t i = 0; i < count && !t.cones.constraints().empty(); ++i) {
    const auto from = configurations.subspan(i * joints, joints);
    if (!keeps_constraints(from, configurations.subspan((i + 1) * joints, joints))) return false;
  }
  // As many motions at once as fit the stack.
  constexpr std::size_t kMost = 16;
  std::array<float, kMost * internal::kMaxFrames> deltas;
  std::array<int, kMost> states;
  for (std::size_t begin = 0; begin < count; begin += kMost) {
    const std::size_t some = std::min(kMost, count - begin);
    const float* points = configurations.data() + begin * joints;
    for (std::size_t i = 0; i < some; ++i) {
      const float* from = points + i * joints;
      const float length = t.space.difference(from, from + joints, deltas.data() + i * joints);
      states[i] = std::max(1, t.count_states(length, detail.refinement));
    }
    const internal::MotionChain chain{points, deltas.data(), states.data(), static_cast<int>(some)};
    PathPoint blocked;
    if (!t.kernels->is_chain_free(*t.world.robot, t.world.scene, chain, margin, counters,
                                  blocked)) {
      blocked.motion += static_cast<int>(begin);
      if (contact != nullptr) *contact = blocked;
      return false;
    }
    for (std::size_t i = 0; i < some && !t.exact_pairs.empty(); ++i) {
      const std::span<const float> from(points + i * joints, joints),
          delta(deltas.data() + i * joints, joints);
      if (!t.are_exact_pairs_apart(from, delta, states[i], detail.exact_margin(), counters))
        return false;
    }
  }
  return true;
}

void CollisionChecker::rate_shortcuts(const PathView& path, float least_gain,
                                      std::span<Shortcut, kShortcuts> shortcuts) const {
  const Tables& t = *tables_;
  t.shortcut_kernels->rate_shortcuts(*t.world.robot, t.world.scene, path, least_gain, t.margin,
                                     shortcuts);
}

void CollisionChecker::rate_relaxations(const PathView& path, const Relaxation& relaxation,
                                        std::span<float, kShortcuts> gains) const {
  const Tables& t = *tables_;
  t.shortcut_kernels->rate_relaxations(*t.world.robot, t.world.scene, path, relaxation, t.margin,
                                       gains);
}

bool CollisionChecker::is_sweep_valid(std::span<const float> from, std::span<const float> to,
                                      CheckCounters& counters, const SweepDetail& detail) const {
  const Tables& t = *tables_;
  ++counters.motions;
  if (!t.can_keep(detail.margin) || !is_within_reach(from) || !is_within_reach(to)) return false;
  if (!keeps_constraints(from, to)) return false;
  FloatConfiguration delta;
  t.space.difference(from.data(), to.data(), delta.data());
  const std::span<const float> moved(delta.data(), from.size());
  return t.are_sweeps_free(from, moved, detail, counters) &&
         t.exact_pairs.stay_apart(from, moved, detail.margin);
}

bool CollisionChecker::are_sweeps_valid(std::span<const float> configurations,
                                        CheckCounters& counters, const SweepDetail& detail) const {
  const Tables& t = *tables_;
  const std::size_t joints = t.joints();
  assert(configurations.size() % joints == 0);
  if (configurations.size() < 2 * joints) return true;
  if (!t.can_keep(detail.margin) || !is_within_reach(configurations)) return false;
  const auto points = configurations.first(configurations.size() - joints);
  counters.motions += points.size() / joints;
  std::vector<float> deltas(points.size());
  for (std::size_t i = 0; i < points.size(); i += joints) {
    const auto from = points.subspan(i, joints), to = configurations.subspan(i + joints, joints);
    if (!keeps_constraints(from, to)) return false;
    t.space.difference(from.data(), to.data(), deltas.data() + i);
  }
  if (!t.are_sweeps_free(points, deltas, detail, counters)) return false;
  for (std::size_t i = 0; i < points.size() && !t.exact_pairs.empty(); i += joints) {
    const std::span<const float> delta(deltas.data() + i, joints);
    if (!t.exact_pairs.stay_apart(points.subspan(i, joints), delta, detail.margin)) return false;
  }
  return true;
}

bool CollisionChecker::keeps_constraints(std::span<const float> from, std::span<const float> to,
                                         std::span<const float> bow) const {
  assert(from.size() == tables_->joints() && to.size() == from.size());
  assert(bow.empty() || bow.size() == from.size());
  return tables_->cones.contain_motion(from, to, bow);
}

bool CollisionChecker::project(std::span<float> q) const {
  assert(q.size() == tables_->joints());
  return tables_->cones.project(q);
}

double CollisionChecker::displacement_bound(std::span<const float> from, std::span<const float> to,
                                            std::span<const float> delta) const {
  const internal::Displacements moved =
      internal::find_displacements(tables_->checked_robot->tables, from, to, delta);
  if (tables_->robot.exact_pairs().empty()) return moved.longest;
  // The tables lack the robot's exact pairs, whose links each move by a body's bound at most.
  return std::max(moved.longest, 2 * moved.longest_of_bodies);
}

bool CollisionChecker::is_motion_valid(std::span<const double> from, std::span<const double> to,
                                       const MotionDetail& detail) const {
  const FloatConfiguration a = to_float(from), b = to_float(to);
  CheckCounters counters;
  return is_motion_valid({a.data(), from.size()}, {b.data(), to.size()}, counters, detail);
}

void CollisionChecker::check_family(const FamilyMotion& motion, std::span<const FamilyBox> boxes,
                                    float margin, std::span<FamilyVerdict> verdicts,
                                    CheckCounters& counters, bool has_links) const {
  const Tables& t = *tables_;
  const GoalShift& shift = *motion.shift;
  [[maybe_unused]] const auto parameters = internal::as_index(shift.parameters);
  assert(shift.parameters <= kMostParameters && verdicts.size() == boxes.size());
  assert(motion.from.size() == t.joints() && motion.to.size() == t.joints());
  assert(shift.slopes.size() == parameters * t.joints());
  assert(shift.curvatures.size() == parameters * parameters * t.joints());
  counters.states += boxes.size();
  // A value that is not finite would compare as free.
  const auto is_near = [](std::span<const float> values) { return is_within_reach(values); };
  const auto is_box_near = [&](const FamilyBox& box) {
    return is_near(std::array{box.time, box.half_time}) && is_near(box.at) && is_near(box.half);
  };
  const bool is_sound = is_near(motion.from) && is_near(motion.to) && is_near(shift.constant) &&
                        is_near(shift.slopes) && is_near(shift.curvatures) && is_near(shift.rest) &&
                        std::ranges::all_of(boxes, is_box_near) && margin > 0 &&
                        t.cones.constraints().empty() && t.exact_pairs.empty();
  if (!is_sound) {
    std::ranges::fill(verdicts, FamilyVerdict{});
    return;
  }
  // The tables lack parts of compound shapes beyond the robot's reach plus kSpareReach.
  const float most =
      t.world.scene.compounds.empty() ? kFarthest : static_cast<float>(internal::kSpareReach);
  t.family_kernel(*t.world.robot, t.world.scene, motion, boxes,
                  {t.margin + margin, margin, most, has_links}, verdicts);
}

void CollisionChecker::walk(std::span<const float> from, const WalkStep& step,
                            std::span<float> candidates, CheckCounters& counters) const {
  const Tables& t = *tables_;
  const internal::RobotTables& robot = *t.world.robot;
  const std::size_t joints = t.joints(), count = step.jitter.size() / 3;
  assert(step.limb >= 0 && internal::as_index(step.limb) < robot.limbs.size());
  assert(from.size() == joints || from.size() == count * joints);
  assert(step.drift.size() == joints && candidates.size() == count * joints);
  FloatConfiguration lower, upper;
  for (std::size_t j = 0; j < joints; ++j) {
    const bool wraps = t.space.periods()[j] > 0;
    lower[j] = wraps ? -kFarthest : t.space.lower(static_cast<int>(j));
    upper[j] = wraps ? kFarthest : t.space.upper(static_cast<int>(j));
  }
  internal::WalkRequest request;
  request.limb = &robot.limbs[internal::as_index(step.limb)];
  request.pulled_points = step.pulled_points;
  request.length = step.length;
  request.clearance = step.clearance + t.margin;
  request.from = from.data();
  request.from_stride = from.size() > joints ? robot.joint_count : 0;
  request.drift = step.drift.data();
  request.lower = lower.data();
  request.upper = upper.data();
  request.jitter = step.jitter.data();
  request.count = static_cast<int>(count);
  t.walk_kernel(robot, t.world.scene, request, candidates.data(), counters);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i] = t.space.into_limits(static_cast<int>(i % joints), candidates[i]);
  }
}

std::vector<LimbInfo> CollisionChecker::limbs() const {
  std::vector<LimbInfo> result;
  for (const internal::Limb& limb : tables_->checked_robot->tables.limbs) {
    result.push_back({static_cast<int>(limb.points.size()) - 1, limb.length});
  }
  return result;
}

std::vector<Contact> CollisionChecker::contacts(std::span<const double> q) const {
  const Tables& t = *tables_;
  return internal::find_contacts(t.robot, t.checked_robot->links, t.scene, q, t.margin);
}

std::vector<Contact> CollisionChecker::fixed_contacts() const {
  const Tables& t = *tables_;
  return internal::find_fixed_contacts(t.robot, t.checked_robot->links, t.scene);
}

}  // namespace mneme
