// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Files name kThreadedVersion: raise it with each change of the samples or their order.
#include "mneme/instances.h"
#include "mneme/learning.h"

#include "base/fail.h"
#include "instances/box_scenes.h"
#include "memory/planar_chain.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace mneme {
namespace {

using Circles = std::vector<std::array<double, 3>>;

constexpr int kThreadedAttempts = 200;
constexpr int kGoalAttempts = 1000;
/// Candidates in a row without a threaded start after which the ranges count as infeasible.
constexpr int kHopeless = 2000;

class InstanceMaker {
 public:
  InstanceMaker(const Robot& robot, const internal::PlanarChain& chain,
                const ThreadedSettings& settings, std::uint64_t seed)
      : robot_(robot),
        chain_(chain),
        settings_(settings),
        rng_(seed),
        sampler_(make_uniform_sampler(robot)) {}

  Result<ThreadedInstances> make(int count) {
    ThreadedInstances made;
    for (int barren = 0; static_cast<int>(made.instances.size()) < count;) {
      if (internal::is_set(settings_.cancel)) break;
      auto candidate = MNEME_TRY(sample());
      if (!candidate) {
        if (++barren < kHopeless) continue;
        return fail(ErrorCode::invalid,
                    "no configuration of robot '{}' was found that is threaded through a gap in "
                    "the ranges of gap and depth",
                    robot_.name());
      }
      barren = 0;
      if (candidate->witness.empty()) {
        ++made.dropped;
      } else {
        made.instances.push_back(*std::move(candidate));
      }
      internal::report_progress(settings_, made);
    }
    return made;
  }

 private:
  /// Nothing if no arm fits. The witness is empty if the proof reached its limit.
  Result<std::optional<ThreadedInstance>> sample() {
    const PrimitiveKey key = sample_circles();
    const int depth = sample_depth();
    ThreadedInstance instance;
    instance.circles = circles_of(key);
    std::optional<PrimitiveKey> second;
    for (int pair = 1; pair < settings_.passages; ++pair) {
      const PrimitiveKey further = sample_circles();
      std::ranges::copy(circles_of(further), std::back_inserter(instance.circles));
      if (!second) second = further;
    }
    const auto checker =
        MNEME_TRY(CollisionChecker::make(robot_, make_circle_scene("", instance.circles)));
    if (!std::ranges::all_of(instance.circles, is_base_outside)) return std::nullopt;
    const auto start = sample_threaded(checker, key, depth);
    const auto goal =
        second ? sample_second_goal(checker, key, *second) : sample_goal(checker, key);
    if (!start || !goal) return std::nullopt;
    instance.gap = make_primitive(key).gap;
    instance.depth = depth;
    instance.start = *start;
    instance.goal = *goal;
    instance.witness = prove(checker, instance);
    return instance;
  }

  static Circles circles_of(const PrimitiveKey& key) {
    return {{key[0], key[1], key[2]}, {key[3], key[4], key[5]}};
  }

  static bool is_base_outside(const std::array<double, 3>& circle) {
    return std::hypot(circle[0], circle[1]) > circle[2];
  }

  int sample_depth() {
    const int count = settings_.depth[1] - settings_.depth[0] + 1;
    return settings_.depth[0] + static_cast<int>(rng_.index(static_cast<std::uint32_t>(count)));
  }

  std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                               const PrimitiveKey& key, int depth) {
    return internal::sample_threaded(checker, chain_, key, chain_.link_count() - depth,
                                     kThreadedAttempts, rng_);
  }

  /// A configuration in the second gap and outside of the first.
  std::optional<Configuration> sample_second_goal(const CollisionChecker& checker,
                                                  const PrimitiveKey& first,
                                                  const PrimitiveKey& second) {
    auto goal = sample_threaded(checker, second, sample_depth());
    if (!goal || internal::first_crossing_link(chain_, first, *goal) >= 0) return std::nullopt;
    return goal;
  }

  PrimitiveKey sample_circles() {
    const double gap = rng_.uniform(settings_.gap[0], settings_.gap[1]);
    const double radius_a = rng_.uniform(1, 2), radius_b = rng_.uniform(1, 2);
    const double distance = rng_.uniform(0, chain_.reach());
    const double azimuth = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    const double tilt = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    const internal::Vec2 middle = distance * internal::Vec2(std::cos(azimuth), std::sin(azimuth));
    const internal::Vec2 along(std::cos(tilt), std::sin(tilt));
    const internal::Vec2 a = middle + (gap / 2 + radius_a) * along;
    const internal::Vec2 b = middle - (gap / 2 + radius_b) * along;
    return {a.x(), a.y(), radius_a, b.x(), b.y(), radius_b};
  }

  std::optional<Configuration> sample_goal(const CollisionChecker& checker,
                                           const PrimitiveKey& key) {
    for (int i = 0; i < kGoalAttempts; ++i) {
      const Configuration q = internal::random_configuration(robot_, rng_);
      const bool is_out = internal::first_crossing_link(chain_, key, q) < 0;
      if (is_out && checker.is_valid(std::span<const double>(q))) return q;
    }
    return std::nullopt;
  }

  Path prove(const CollisionChecker& checker, const ThreadedInstance& instance) {
    return internal::find_path(checker, *sampler_, {instance.start, {instance.goal}},
                               settings_.proof_iterations, rng_.next(), settings_.cancel);
  }

  const Robot& robot_;
  const internal::PlanarChain& chain_;
  const ThreadedSettings& settings_;
  Rng rng_;
  std::unique_ptr<Sampler> sampler_;
};

}  // namespace

Result<ThreadedInstances> make_threaded_instances(const Robot& robot, int count,
                                                  const ThreadedSettings& settings,
                                                  std::uint64_t seed) {
  const auto chain = MNEME_TRY(internal::PlanarChain::make(robot));
  if (!(settings.gap[0] > 0 && settings.gap[0] <= settings.gap[1])) {
    return fail(ErrorCode::invalid, "the range of gaps must be positive and ascending");
  }
  if (settings.depth[0] < 1 || settings.depth[0] > settings.depth[1] ||
      settings.depth[1] > chain.link_count()) {
    return fail(ErrorCode::invalid, "the range of depths must be ascending and between 1 and {}",
                chain.link_count());
  }
  if (settings.passages < 1 || settings.passages > 3) {
    return fail(ErrorCode::invalid, "expected 1 to 3 passages, found {}", settings.passages);
  }
  return InstanceMaker(robot, chain, settings, seed).make(count);
}

}  // namespace mneme
