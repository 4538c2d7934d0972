// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Files name kEnclosedVersion: raise it with each change of the samples or their order.
#include "mneme/instances.h"

#include "base/fail.h"
#include "instances/box_scenes.h"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

namespace mneme {
namespace {

constexpr int kMostThrough = 100;
/// Failed boxes in a row after which there is no room for more.
constexpr int kNoRoom = 2000;
constexpr int kMostEnds = 20;  ///< attempts for a connected configuration
constexpr std::uint64_t kWitnessIterations = 3000;

/// Samples one instance.
class Enclosure {
 public:
  Enclosure(const CollisionChecker& empty, const Sampler& sampler, const EnclosedSettings& settings,
            std::uint64_t seed)
      : empty_(empty),
        robot_(empty.robot()),
        sampler_(sampler),
        states_(sampler.start(seed)),
        settings_(settings),
        rng_(seed) {}

  /// Nothing if no path is found even without boxes.
  Result<std::optional<EnclosedInstance>> sample() {
    EnclosedInstance instance;
    instance.witness = sample_witness();
    if (instance.witness.empty()) return std::nullopt;
    instance.start = instance.witness.front();
    instance.goal = instance.witness.back();
    instance.scene = MNEME_TRY(internal::sample_boxes(
        settings_.boxes, kNoRoom, settings_.cancel, [&] { return sample_box(instance.witness); }));
    return instance;
  }

 private:
  /// A path through random free configurations; empty if there are none, or none are connected.
  Path sample_witness() {
    const std::optional<Configuration> start = internal::sample_free(empty_, *states_);
    if (!start) return {};
    Path witness = {*start};
    for (int i = 0; i <= settings_.through; ++i) {
      const Path part = sample_part(witness.back());
      if (part.empty()) return {};
      std::copy(part.begin() + 1, part.end(), std::back_inserter(witness));
    }
    return witness;
  }

  /// A path from `from` to a random free configuration. The free space of some robots is not
  /// connected.
  Path sample_part(const Configuration& from) {
    Path part;
    for (int i = 0; i < kMostEnds && part.empty(); ++i) {
      const std::optional<Configuration> to = internal::sample_free(empty_, *states_);
      if (!to) break;
      part = internal::find_path(empty_, sampler_, {from, {*to}}, kWitnessIterations, rng_.next(),
                                 settings_.cancel);
    }
    return part;
  }

  /// A box near a link at a waypoint of the witness, shrunk until it keeps the clearance.
  Result<std::optional<Box>> sample_box(const Path& witness) {
    const auto at = static_cast<std::uint32_t>(witness.size());
    const std::vector<Transform> poses = robot_.link_poses(witness[rng_.index(at)]);
    const Vec3 near = poses[rng_.index(static_cast<std::uint32_t>(poses.size()))].translation;
    const double most = settings_.size[1];
    Vec3 off, half;
    for (const int axis : {2, 1, 0}) off[axis] = rng_.uniform(-most, most);
    const double yaw = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    for (const int axis : {2, 1, 0}) half[axis] = rng_.uniform(settings_.size[0], most) / 2;
    // It keeps its clearance to links that no joint moves, too.
    return internal::shrink_to_fit({{rotation_about(Vec3::UnitZ(), yaw), near + off}, half},
                                   settings_.size[0], [&](const Box& box) {
                                     return internal::is_clear_of(box, robot_, witness,
                                                                  settings_.clearance);
                                   });
  }

  const CollisionChecker& empty_;
  const Robot& robot_;
  const Sampler& sampler_;
  std::unique_ptr<SampleStream> states_;
  const EnclosedSettings& settings_;
  Rng rng_;
};

Result<void> check(const EnclosedSettings& settings) {
  if (!(settings.clearance > 0 && settings.clearance <= 1)) {
    return fail(ErrorCode::invalid, "the clearance must be more than 0 and at most 1 m");
  }
  if (!(settings.size[0] > 0 && settings.size[0] <= settings.size[1] && settings.size[1] <= 10)) {
    return fail(ErrorCode::invalid,
                "the range of sizes must be positive and ascending, up to 10 m");
  }
  if (settings.boxes < 1 || settings.through < 0 || settings.through > kMostThrough) {
    return fail(
        ErrorCode::invalid,
        "expected at least one box, and 0 to {} configurations that the witness passes through",
        kMostThrough);
  }
  return {};
}

}  // namespace

Result<EnclosedInstances> make_enclosed_instances(const Robot& robot, int count,
                                                  const EnclosedSettings& settings,
                                                  std::uint64_t seed) {
  MNEME_TRY(check(settings));
  const auto empty = MNEME_TRY(CollisionChecker::make(robot, {}));
  const auto sampler = make_uniform_sampler(robot);
  EnclosedInstances made;
  for (std::uint64_t i = 0; std::ssize(made.instances) < count; ++i) {
    auto instance = MNEME_TRY(Enclosure(empty, *sampler, settings, derive_seed(seed, i)).sample());
    if (internal::is_set(settings.cancel)) break;
    if (!instance) {
      if (++made.dropped < count + 10) continue;
      return fail(ErrorCode::invalid,
                  "robot '{}' finds no path between random configurations even without obstacles",
                  robot.name());
    }
    made.instances.push_back(*std::move(instance));
    internal::report_progress(settings, made);
  }
  return made;
}

}  // namespace mneme
