// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Files name kBlockedVersion: raise it with each change of the samples or their order.
#include "mneme/instances.h"
#include "mneme/memory.h"

#include "instances/box_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace mneme {
namespace {

constexpr double kHalfPost = 0.01;  ///< metres
/// Least rotation between a post and a limit, an end or another post, radians.
constexpr double kApart = 0.4;
/// The post's place on the radius of a sphere: outwards, but safely inside.
constexpr double kDepth = 0.7;
constexpr int kPoses = 8;  ///< that show which joints move a sphere
constexpr int kEndTries = 2000, kPostTries = 100;
constexpr double kSamePlace = 1e-6;  ///< metres

/// A sphere that the turning joint moves, and no other joint except along the axis.
struct Turned {
  std::string link;
  Vec3 outer;  ///< inside the sphere, where the turning joint is 0
  double radius = 0;
};

/// The middles and radii of a link's shapes, in its frame.
std::vector<Sphere> middles(const Link& link) {
  std::vector<Sphere> all(link.spheres.begin(), link.spheres.end());
  for (const Capsule& capsule : link.capsules) {
    all.push_back({(capsule.a + capsule.b) / 2, capsule.radius});
  }
  return all;
}

class Blocker {
 public:
  Blocker(const Robot& robot, const SymmetricJoints& joints)
      : robot_(robot), joints_(joints), turn_(static_cast<std::size_t>(joints.turn)) {}

  /// The sphere that reaches farthest from the axis.
  std::optional<Turned> find_turned(SampleStream& states) const {
    const std::vector<Configuration> poses = sample_poses(states);
    std::optional<Turned> best;
    for (std::size_t l = 0; l < robot_.links().size(); ++l) {
      for (const Sphere& sphere : middles(robot_.links()[l])) {
        const auto middle = place_of(l, sphere.center, poses);
        if (!middle) continue;
        const Vec3 out(middle->x() - joints_.axis_x, middle->y() - joints_.axis_y, 0);
        if (out.norm() < kSamePlace) continue;
        const Vec3 outer = *middle + kDepth * sphere.radius * out.normalized();
        if (!best || reach(outer) > reach(best->outer)) {
          best = {robot_.links()[l].name, outer, sphere.radius};
        }
      }
    }
    return best;
  }

  /// A post that the sphere meets where the turning joint is at `angle`, for all lifts.
  [[nodiscard]] Obstacle post(const Turned& turned, double angle, const std::string& name) const {
    const Vec3 axis(joints_.axis_x, joints_.axis_y, 0);
    Vec3 at = axis + rotation_about(Vec3::UnitZ(), angle) * (turned.outer - axis);
    if (robot_.is_planar()) return {name, {Sphere{at, kHalfPost}}};
    double rise = 0;
    if (joints_.lift >= 0) {
      const Joint& lift = robot_.group_joint(joints_.lift);
      rise = lift.upper - lift.lower;
    }
    at.z() += rise / 2;
    return {name,
            {Box{{Eigen::Matrix3d::Identity(), at}, {kHalfPost, kHalfPost, kHalfPost + rise / 2}}}};
  }

 private:
  /// Random configurations with the turning joint at 0 and the lift at its lower limit.
  [[nodiscard]] std::vector<Configuration> sample_poses(SampleStream& states) const {
    std::vector<Configuration> poses;
    std::vector<float> q(static_cast<std::size_t>(robot_.joint_count()));
    for (int i = 0; i < kPoses; ++i) {
      states.next(q);
      Configuration& pose = poses.emplace_back(q.begin(), q.end());
      pose[turn_] = 0;
      if (joints_.lift >= 0) {
        pose[static_cast<std::size_t>(joints_.lift)] = robot_.group_joint(joints_.lift).lower;
      }
    }
    return poses;
  }

  /// The place of a link's point in all poses; nothing if it differs, or if no joint moves it.
  [[nodiscard]] std::optional<Vec3> place_of(std::size_t link, const Vec3& point,
                                             const std::vector<Configuration>& poses) const {
    const auto place = [&](const Configuration& q) { return robot_.link_poses(q)[link] * point; };
    const Vec3 first = place(poses.front());
    for (const Configuration& q : poses) {
      if ((place(q) - first).norm() > kSamePlace) return std::nullopt;
    }
    Configuration turned = poses.front();
    turned[turn_] += kApart;
    if ((place(turned) - first).norm() < kSamePlace) return std::nullopt;
    return first;
  }

  [[nodiscard]] double reach(const Vec3& point) const {
    return std::hypot(point.x() - joints_.axis_x, point.y() - joints_.axis_y);
  }

  const Robot& robot_;
  const SymmetricJoints& joints_;
  std::size_t turn_;
};

/// Samples one instance.
class BlockedSampler {
 public:
  BlockedSampler(const Robot& robot, const SymmetricJoints& joints, const Sampler& sampler,
                 std::uint64_t seed)
      : robot_(robot),
        joints_(joints),
        blocker_(robot, joints),
        states_(sampler.start(seed)),
        rng_(seed) {}

  /// Nothing if no free ends are found on the two sides.
  Result<std::optional<BlockedInstance>> sample() {
    const auto turned = blocker_.find_turned(*states_);
    if (!turned) {
      return fail(ErrorCode::unsupported,
                  "robot '" + robot_.name() +
                      "' has no shape off its axis that only the turning joint moves; expected "
                      "one, to block it with a post");
    }
    for (int i = 0; i < kPostTries; ++i) {
      BlockedInstance instance;
      instance.joint = robot_.group_joint(joints_.turn).name;
      instance.link = turned->link;
      instance.angles = sample_angles();
      for (const double angle : instance.angles) {
        const std::string name = "post_" + std::to_string(instance.scene.obstacles.size());
        instance.scene.obstacles.push_back(blocker_.post(*turned, angle, name));
      }
      const auto checker = MNEME_TRY(CollisionChecker::make(robot_, instance.scene));
      if (!checker.fixed_contacts().empty()) continue;
      instance.start = sample_end(checker, instance.angles, true);
      instance.goal = sample_end(checker, instance.angles, false);
      if (!instance.start.empty() && !instance.goal.empty()) return std::optional(instance);
    }
    return std::optional<BlockedInstance>();
  }

 private:
  /// A continuous joint needs two posts: it would turn the other way.
  std::vector<double> sample_angles() {
    const Joint& joint = robot_.group_joint(joints_.turn);
    if (joint.type != JointType::continuous) {
      return {rng_.uniform(joint.lower + kApart, joint.upper - kApart)};
    }
    constexpr double kTurn = 2 * std::numbers::pi;
    const double first = rng_.uniform(-std::numbers::pi, std::numbers::pi - 3 * kApart);
    return {first, rng_.uniform(first + 2 * kApart, std::min(first + kTurn - 2 * kApart,
                                                             std::numbers::pi - kApart / 2))};
  }

  /// True if the turning joint is between the posts; for one post, before it.
  [[nodiscard]] static bool is_between(const std::vector<double>& angles, double angle) {
    return angles.size() == 1 ? angle < angles[0] : angle > angles[0] && angle < angles[1];
  }

  Configuration sample_end(const CollisionChecker& checker, const std::vector<double>& angles,
                           bool between) {
    std::vector<float> q(static_cast<std::size_t>(robot_.joint_count()));
    for (int i = 0; i < kEndTries; ++i) {
      states_->next(q);
      const double angle = q[static_cast<std::size_t>(joints_.turn)];
      const bool is_near = std::ranges::any_of(
          angles, [&](double post) { return std::abs(angle - post) < kApart / 2; });
      if (is_near || is_between(angles, angle) != between || !checker.is_valid(q)) continue;
      return {q.begin(), q.end()};
    }
    return {};
  }

  const Robot& robot_;
  const SymmetricJoints& joints_;
  Blocker blocker_;
  std::unique_ptr<SampleStream> states_;
  Rng rng_;
};

}  // namespace

Result<BlockedInstances> make_blocked_instances(const Robot& robot, int count,
                                                const GeneratorRun& run, std::uint64_t seed) {
  const SymmetricJoints joints = find_symmetric_joints(robot);
  if (joints.turn < 0) {
    return fail(ErrorCode::unsupported,
                "robot '" + robot.name() +
                    "' has no joint that turns all others about a vertical axis; expected one, to "
                    "block it");
  }
  const auto sampler = make_uniform_sampler(robot);
  BlockedInstances made;
  for (std::uint64_t i = 0; std::ssize(made.instances) < count; ++i) {
    auto instance =
        MNEME_TRY(BlockedSampler(robot, joints, *sampler, derive_seed(seed, i)).sample());
    if (internal::is_set(run.cancel)) break;
    if (instance) {
      made.instances.push_back(*std::move(instance));
    } else if (++made.dropped > count + 10) {
      return fail(ErrorCode::invalid, "robot '" + robot.name() +
                                          "' has no free configurations on both sides of a post");
    }
    internal::report_progress(run, made);
  }
  return made;
}

}  // namespace mneme
