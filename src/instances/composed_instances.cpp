// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Files name kComposedVersion: raise it with each change of the samples or their order.
#include "mneme/instances.h"
#include "mneme/memory.h"

#include "base/fail.h"
#include "instances/box_scenes.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace mneme {
namespace {

constexpr int kMostModules = 1000;
constexpr int kMostPassages = 8;
constexpr int kLegs = 2;
/// Length of a leg of a module's motion, radians.
constexpr std::array kLegLength = {1.2, 2.2};
/// Boxes stand around links from this share of the chain on.
constexpr double kDistal = 0.5;
constexpr double kBoxOffset = 0.25;  ///< metres along each axis from the origin of a link
/// Failed boxes in a row after which there is no room for more.
constexpr int kMostBarren = 500;
constexpr int kLegTries = 300;
constexpr int kTurnTries = 50;
constexpr int kJoinTries = 5;
constexpr std::uint64_t kJoinIterations = 3000;
constexpr double kLeastKept = 0.4;    ///< share of a module's boxes
constexpr int kMostCandidates = 200;  ///< per instance
/// Streams of random numbers.
constexpr std::uint64_t kModuleStream = 1, kInstanceStream = 2;

/// Motions that a box has to keep a distance to.
struct KeptMotion {
  Path path;
  double clearance = 0;
};

/// The motions of the world that the turning joint undoes.
Transform turned_world(const SymmetricJoints& joints, double angle) {
  const Vec3 axis(joints.axis_x, joints.axis_y, 0);
  const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), angle);
  return {turn, axis - turn * axis};
}

/// Samples modules and compositions of them.
class Composer {
 public:
  Composer(const CollisionChecker& empty, const Sampler& sampler, const SymmetricJoints& joints,
           const ComposedSettings& settings, std::uint64_t seed)
      : empty_(empty),
        robot_(empty.robot()),
        sampler_(sampler),
        joints_(joints),
        settings_(settings),
        states_(sampler.start(seed)),
        rng_(seed) {}

  /// Nothing without a free motion of two legs.
  Result<std::optional<ComposedModule>> sample_module() {
    ComposedModule module;
    module.motion = sample_motion();
    if (module.motion.empty()) return std::nullopt;
    module.scene = MNEME_TRY(internal::sample_boxes(settings_.boxes, kMostBarren, settings_.cancel,
                                                    [&] { return sample_box(module.motion); }));
    return module;
  }

  /// Nothing if the modules do not go together.
  Result<std::optional<ComposedInstance>> compose(std::span<const ComposedModule> modules,
                                                  std::span<const int> chosen) {
    ComposedInstance instance;
    std::vector<Path> motions;
    if (!place(modules, chosen, instance.parts, motions)) return std::nullopt;
    const auto ways = join(motions);
    if (!ways) return std::nullopt;
    instance.witness = chain(motions, *ways);
    instance.start = instance.witness.front();
    instance.goal = instance.witness.back();
    const bool is_kept = MNEME_TRY(add_boxes(modules, motions, *ways, instance));
    if (!is_kept) return std::nullopt;
    const auto checker = MNEME_TRY(CollisionChecker::make(robot_, instance.scene));
    CheckCounters counters;
    const bool is_free = checker.is_valid(std::span<const double>(instance.start)) &&
                         find_invalid_motion(checker, instance.witness, counters) < 0;
    if (!is_free) return std::nullopt;
    return instance;
  }

  /// `count` of `modules` different indices in random order.
  std::vector<int> choose(int modules, int count) {
    std::vector<int> all(static_cast<std::size_t>(modules));
    std::iota(all.begin(), all.end(), 0);
    shuffle(all);
    all.resize(static_cast<std::size_t>(count));
    return all;
  }

 private:
  void shuffle(std::vector<int>& all) {
    for (std::size_t i = all.size(); i > 1; --i) {
      std::swap(all[i - 1], all[rng_.index(static_cast<std::uint32_t>(i))]);
    }
  }

  Path sample_motion() {
    const std::optional<Configuration> start = internal::sample_free(empty_, *states_);
    if (!start) return {};
    Path motion = {*start};
    for (int leg = 0; leg < kLegs; ++leg) {
      auto next = sample_leg(motion.back());
      if (!next) return {};
      motion.push_back(*std::move(next));
    }
    return motion;
  }

  /// The end of a free straight motion in a random direction.
  std::optional<Configuration> sample_leg(const Configuration& from) {
    for (int i = 0; i < kLegTries; ++i) {
      Configuration direction(from.size());
      double squared = 0;
      for (double& value : direction) {
        value = rng_.normal();
        squared += value * value;
      }
      const double scale = rng_.uniform(kLegLength[0], kLegLength[1]) / std::sqrt(squared);
      Configuration to = from;
      for (std::size_t j = 0; j < to.size(); ++j) to[j] += scale * direction[j];
      if (!robot_.is_configuration(to)) continue;
      if (empty_.is_valid(std::span<const double>(to)) &&
          empty_.is_motion_valid(std::span<const double>(from), std::span<const double>(to))) {
        return to;
      }
    }
    return std::nullopt;
  }

  /// A box near a distal link at a waypoint, shrunk until it keeps the clearance.
  Result<std::optional<Box>> sample_box(const Path& motion) {
    const std::vector<Transform> poses =
        robot_.link_poses(motion[rng_.index(static_cast<std::uint32_t>(motion.size()))]);
    const auto first = static_cast<std::size_t>(kDistal * static_cast<double>(poses.size()));
    const auto link = first + rng_.index(static_cast<std::uint32_t>(poses.size() - first));
    Vec3 offset, half;
    for (const int axis : {0, 1, 2}) offset[axis] = rng_.uniform(-kBoxOffset, kBoxOffset);
    const double yaw = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    for (const int axis : {0, 1, 2}) {
      half[axis] = rng_.uniform(settings_.size[0], settings_.size[1]) / 2;
    }
    const Transform pose{rotation_about(Vec3::UnitZ(), yaw), poses[link].translation + offset};
    return internal::shrink_to_fit({pose, half}, settings_.size[0], [&](const Box& box) {
      return internal::is_clear_of(box, robot_, motion, settings_.clearance);
    });
  }

  /// True if the box keeps its distance to all motions, and to links that no joint moves.
  [[nodiscard]] Result<bool> is_clear_of(const Box& box, std::span<const KeptMotion> kept) const {
    for (const KeptMotion& motion : kept) {
      const bool is_clear =
          MNEME_TRY(internal::is_clear_of(box, robot_, motion.path, motion.clearance));
      if (!is_clear) return false;
    }
    return true;
  }

  /// The direction of the tip, seen from the robot's axis, on the middle of the motion.
  [[nodiscard]] double azimuth_of(const Path& motion) const {
    const Vec3 tip = robot_.link_poses(motion[motion.size() / 2]).back().translation;
    return std::atan2(tip.y() - joints_.axis_y, tip.x() - joints_.axis_x);
  }

  /// Turns each module to a sector of its own; false if the limits leave no place.
  bool place(std::span<const ComposedModule> modules, std::span<const int> chosen,
             std::vector<ComposedPart>& parts, std::vector<Path>& motions) {
    std::vector<int> sectors(std::max<std::size_t>(chosen.size(), 3));
    std::iota(sectors.begin(), sectors.end(), 0);
    shuffle(sectors);
    const double first = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    const double width = 2 * std::numbers::pi / static_cast<double>(sectors.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Path& motion = modules[static_cast<std::size_t>(chosen[i])].motion;
      const double turn = first + width * sectors[i] - azimuth_of(motion);
      if (!place_one(chosen[i], turn, motion, parts, motions)) return false;
    }
    return true;
  }

  bool place_one(int module, double turn, const Path& motion, std::vector<ComposedPart>& parts,
                 std::vector<Path>& motions) {
    const bool is_reversed = rng_.uniform() < 0.5;
    for (int i = 0; i < kTurnTries; ++i) {
      const double spread = 0.02 * i;
      const double angle =
          std::remainder(turn + rng_.uniform(-spread, spread), 2 * std::numbers::pi);
      Path turned = motion;
      for (Configuration& q : turned) q[static_cast<std::size_t>(joints_.turn)] += angle;
      const bool is_within = std::ranges::none_of(
          turned, [&](const Configuration& q) { return !robot_.is_configuration(q); });
      if (!is_within) continue;
      if (is_reversed) std::ranges::reverse(turned);
      parts.push_back({module, angle, is_reversed});
      motions.push_back(std::move(turned));
      return true;
    }
    return false;
  }

  /// The ways from each motion to the next, or from the only one into the open.
  std::optional<std::vector<Path>> join(const std::vector<Path>& motions) {
    std::vector<Path> ways;
    const std::size_t count = std::max<std::size_t>(motions.size() - 1, 1);
    for (std::size_t i = 0; i < count; ++i) {
      const auto to =
          i + 1 < motions.size() ? motions[i + 1].front() : internal::sample_free(empty_, *states_);
      if (!to) return std::nullopt;
      Path way = find_way(motions[i].back(), *to);
      if (way.empty()) return std::nullopt;
      ways.push_back(std::move(way));
    }
    return ways;
  }

  Path find_way(const Configuration& from, const Configuration& to) {
    Path way;
    for (int i = 0; i < kJoinTries && way.empty(); ++i) {
      way = internal::find_path(empty_, sampler_, {from, {to}}, kJoinIterations, rng_.next(),
                                settings_.cancel);
    }
    return way;
  }

  static Path chain(const std::vector<Path>& motions, const std::vector<Path>& ways) {
    Path all = {motions.front().front()};
    const auto append = [&](const Path& part) {
      std::copy(part.begin() + 1, part.end(), std::back_inserter(all));
    };
    for (std::size_t i = 0; i < motions.size(); ++i) {
      append(motions[i]);
      if (i < ways.size()) append(ways[i]);
    }
    return all;
  }

  /// Adds the boxes that leave the rest of the witness open. False if too few are left of a module.
  Result<bool> add_boxes(std::span<const ComposedModule> modules, const std::vector<Path>& motions,
                         const std::vector<Path>& ways, ComposedInstance& instance) {
    for (std::size_t i = 0; i < instance.parts.size(); ++i) {
      const ComposedPart& part = instance.parts[i];
      const ComposedModule& module = modules[static_cast<std::size_t>(part.module)];
      const Transform turned = turned_world(joints_, part.turn);
      const std::vector<KeptMotion> kept = kept_by(i, motions, ways);
      std::size_t boxes = 0;
      for (const Obstacle& obstacle : module.scene.obstacles) {
        Box box = std::get<Box>(obstacle.shapes.front());
        box.pose = turned * box.pose;
        const bool fits = MNEME_TRY(is_clear_of(box, kept));
        if (!fits) continue;
        instance.scene.obstacles.push_back({fmt::format("m{}_{}", i, boxes++), {box}});
      }
      const auto all = static_cast<double>(module.scene.obstacles.size());
      if (static_cast<double>(boxes) < kLeastKept * all) return false;
    }
    return true;
  }

  /// The motions that boxes of part `i` keep a distance to. A way that begins or ends in the part
  /// is as near to its boxes as the motion there.
  [[nodiscard]] std::vector<KeptMotion> kept_by(std::size_t i, const std::vector<Path>& motions,
                                                const std::vector<Path>& ways) const {
    std::vector<KeptMotion> kept;
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const bool is_own = k == i || k + 1 == i;
      kept.push_back({ways[k], is_own ? settings_.clearance : settings_.open});
    }
    for (std::size_t k = 0; k < motions.size(); ++k) {
      if (k != i) kept.push_back({motions[k], settings_.open});
    }
    return kept;
  }

  const CollisionChecker& empty_;
  const Robot& robot_;
  const Sampler& sampler_;
  const SymmetricJoints& joints_;
  const ComposedSettings& settings_;
  std::unique_ptr<SampleStream> states_;
  Rng rng_;
};

Result<void> check(const Robot& robot, const SymmetricJoints& joints,
                   const ComposedSettings& settings) {
  if (joints.turn < 0) {
    return fail(ErrorCode::unsupported,
                "robot '{}' has no joint that turns all others about a vertical axis; expected "
                "one, to turn modules with it",
                robot.name());
  }
  const auto is_distance = [](double value) { return value > 0 && value <= 1; };
  if (!is_distance(settings.clearance) || !is_distance(settings.open)) {
    return fail(ErrorCode::invalid, "clearance and open must be more than 0 and at most 1 m");
  }
  if (!(settings.size[0] > 0 && settings.size[0] <= settings.size[1] && settings.size[1] <= 10)) {
    return fail(ErrorCode::invalid,
                "the range of sizes must be positive and ascending, up to 10 m");
  }
  const auto& [least, most] = settings.passages;
  if (least < 1 || most < least || most > kMostPassages) {
    return fail(ErrorCode::invalid, "the range of passages must be ascending, from 1 to {}",
                kMostPassages);
  }
  const bool is_count = settings.boxes >= 1 && settings.modules >= most && settings.foreign >= 0 &&
                        settings.modules <= kMostModules && settings.foreign <= kMostModules;
  if (!is_count) {
    return fail(ErrorCode::invalid,
                "expected at least one box, as many modules as passages, and at most {} modules",
                kMostModules);
  }
  return {};
}

/// Makes all modules, then instances of the first `settings.modules` of them.
class Composition {
 public:
  Composition(const CollisionChecker& empty, const Sampler& sampler, const SymmetricJoints& joints,
              const ComposedSettings& settings, std::uint64_t seed)
      : empty_(empty), sampler_(sampler), joints_(joints), settings_(settings), seed_(seed) {}

  Result<ComposedInstances> make(int count) {
    MNEME_TRY(add_modules());
    for (std::uint64_t i = 0; std::ssize(made_.instances) < count && !is_cancelled(); ++i) {
      MNEME_TRY(add_instance(i));
    }
    return std::move(made_);
  }

 private:
  [[nodiscard]] bool is_cancelled() const { return internal::is_set(settings_.cancel); }
  [[nodiscard]] Composer composer(std::uint64_t stream, std::uint64_t number) const {
    return {empty_, sampler_, joints_, settings_, derive_seed(derive_seed(seed_, stream), number)};
  }

  Result<void> add_modules() {
    const int wanted = settings_.modules + settings_.foreign;
    for (std::uint64_t i = 0; std::ssize(made_.modules) < wanted && !is_cancelled(); ++i) {
      auto module = MNEME_TRY(composer(kModuleStream, i).sample_module());
      if (module) made_.modules.push_back(*std::move(module));
      if (i < static_cast<std::uint64_t>(wanted + kMostCandidates)) continue;
      return fail(ErrorCode::invalid,
                  "robot '{}' has no free motions of 2 radians in an empty scene",
                  empty_.robot().name());
    }
    return {};
  }

  Result<void> add_instance(std::uint64_t number) {
    const int range = settings_.passages[1] - settings_.passages[0] + 1;
    const int passages = settings_.passages[0] + static_cast<int>(number) % range;
    Composer composer = this->composer(kInstanceStream, number);
    for (int i = 0; i < kMostCandidates && !is_cancelled(); ++i) {
      const auto chosen = composer.choose(settings_.modules, passages);
      auto instance = MNEME_TRY(composer.compose(made_.modules, chosen));
      const bool is_made = instance.has_value();
      if (is_made) made_.instances.push_back(*std::move(instance));
      made_.dropped += is_made ? 0 : 1;
      internal::report_progress(settings_, made_);
      if (is_made) return {};
    }
    if (is_cancelled()) return {};
    return fail(ErrorCode::invalid,
                "no {} modules go together in {} tries: expected a smaller 'open', fewer boxes or "
                "fewer passages",
                passages, kMostCandidates);
  }

  const CollisionChecker& empty_;
  const Sampler& sampler_;
  const SymmetricJoints& joints_;
  const ComposedSettings& settings_;
  std::uint64_t seed_;
  ComposedInstances made_;
};

}  // namespace

Result<ComposedInstances> make_composed_instances(const Robot& robot, int count,
                                                  const ComposedSettings& settings,
                                                  std::uint64_t seed) {
  const SymmetricJoints joints = find_symmetric_joints(robot);
  MNEME_TRY(check(robot, joints, settings));
  const auto empty = MNEME_TRY(CollisionChecker::make(robot, {}));
  const auto sampler = make_uniform_sampler(robot);
  return Composition(empty, *sampler, joints, settings, seed).make(count);
}

}  // namespace mneme
