// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/goal.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "goal/ik_kernel.h"
#include "robot/joint_space.h"
#include "tables/make_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace mneme {

/// The joints between the root and a link, with new numbers.
struct InverseKinematics::Chain {
  Robot robot;
  internal::JointSpace space;
  internal::RobotTables tables;     ///< frames only
  std::vector<int> joints;          ///< per joint of the tables its index in the group
  std::vector<float> lower, upper;  ///< per joint of the tables; infinite for those that wrap
  int frame = 0;                    ///< carries the link
  Transform X_frame_link;
  internal::IkKernel kernel = nullptr;
};

namespace internal {
namespace {

/// Seeds that are solved together: the lanes of the widest vector.
constexpr int kIkBatch = 16;
/// Largest number of steps from a seed: seeds that take more mostly never arrive.
constexpr int kIkRounds = 24;
/// Batches without a new solution after which the search ends: most arms have only a few solutions.
constexpr int kIkPatience = 3;
/// Number of blocked solutions that are kept.
constexpr std::size_t kMostBlocked = 8;
/// Error of single precision, metres; ten times this as a chord.
constexpr double kIkRounding = 3e-6;

/// Copies the frames from the root to `frame` into `chain`, with new numbers of joints and parents.
/// Returns the joints' former numbers.
std::vector<int> take_chain(const RobotTables& all, int frame, RobotTables& chain) {
  std::vector<int> frames, joints;
  for (; frame > 0; frame = all.frames[as_index(frame - 1)].parent) frames.push_back(frame);
  std::ranges::reverse(frames);
  for (const int i : frames) {
    FrameRow row = all.frames[as_index(i - 1)];
    auto joint = std::ranges::find(joints, row.joint);
    if (joint == joints.end()) joint = joints.insert(joints.end(), row.joint);
    row.joint = static_cast<int>(joint - joints.begin());
    row.parent = static_cast<int>(chain.frames.size());
    chain.frames.push_back(row);
  }
  chain.joint_count = static_cast<int>(joints.size());
  return joints;
}

Transform to_transform(const LinkPlace& place) {
  using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  return {Eigen::Map<const RowMajor>(place.rotation).cast<double>(),
          Eigen::Map<const Eigen::Vector3f>(place.translation).cast<double>()};
}

/// A rotation that takes the z axis to `axis`, by permuting axes.
Eigen::Matrix3d rotation_to(Axis axis) {
  Eigen::Matrix3d cyclic = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) cyclic((static_cast<int>(axis) + 1 + k) % 3, k) = 1;
  return cyclic;
}

/// 2 sin(angle / 2), in which the kernel measures rotations.
double chord(double angle) { return 2 * std::sin(0.5 * std::min(angle, std::numbers::pi)); }

/// The chord of `angle` less the allowed error, so that a solution with this error is within the
/// region. 2: any angle.
double shrunk_chord(double angle, double tolerance) {
  return angle >= std::numbers::pi ? 2 : std::max(0.0, chord(angle) - chord(tolerance));
}

/// Makes the kernel's target of a goal or of a part of its region.
class TargetMaker {
 public:
  TargetMaker(const PoseGoal& goal, int frame, const Transform& X_frame_link,
              const IkSettings& settings) {
    const Transform X_link_tip{rotation_to(goal.axis), Vec3::Zero()};
    X_GR_ = (goal.pose * X_link_tip).inverse();
    const Transform X_frame_tip = X_frame_link * X_link_tip;
    const Vec3 tolerance = X_link_tip.rotation.transpose() * goal.position_tolerance;
    // Shrunk, so that a solution with the allowed error is within the region.
    box_ = (tolerance.array() - settings.position_tolerance).max(0);
    lean_ = shrunk_chord(goal.cone, settings.rotation_tolerance);
    target_.frame = frame;
    store(X_GR_.rotation, target_.rotation.data());
    store(X_frame_tip.rotation, target_.tip_rotation.data());
    store(X_frame_tip.translation, target_.tip_translation.data());
    target_.turn = static_cast<float>(shrunk_chord(goal.turn, settings.rotation_tolerance));
    target_.near_m = static_cast<float>(settings.position_tolerance - kIkRounding);
    target_.near_chord = static_cast<float>(chord(settings.rotation_tolerance) - 10 * kIkRounding);
  }

  /// Returns the whole region, or a random part of it: solutions lie on the border of their target.
  const IkTarget& make(bool is_whole, Rng& rng) {
    const double share = is_whole ? 1 : rng.uniform();
    Vec3 middle = Vec3::Zero();
    for (int i = 0; i < 3; ++i) middle[i] = (1 - share) * box_[i] * (2 * rng.uniform() - 1);
    const Vec3 box = share * box_;
    store(Vec3(X_GR_.translation - middle), target_.translation.data());
    store(box, target_.box.data());
    target_.lean = static_cast<float>(lean_ == 2 ? lean_ : share * lean_);
    return target_;
  }

  [[nodiscard]] bool is_reached(const IkError& error) const {
    return error.position <= target_.near_m && error.rotation <= target_.near_chord;
  }

 private:
  Transform X_GR_;
  Vec3 box_;
  double lean_ = 0;
  IkTarget target_;
};

}  // namespace
}  // namespace internal

namespace {

using internal::as_index;

/// One call of InverseKinematics::solve().
template <class Chain>
class IkSearch {
 public:
  IkSearch(const Chain& chain, const PoseGoal& goal, std::span<const double> near,
           const IkSettings& settings, const CollisionChecker* checker, double clearance)
      : chain_(chain),
        given_near_(near.begin(), near.end()),
        near_(chain.robot.normalized(near)),
        goal_(goal),
        settings_(settings),
        checker_(checker),
        clearance_(clearance),
        target_(goal, chain.frame, chain.X_frame_link, settings),
        rng_(settings.seed),
        seeds_(internal::kIkBatch * chain.joints.size()),
        rows_(seeds_.size()) {}

  IkResult search() {
    int futile = 0;
    while (result_.seeds < settings_.seeds && count() < settings_.solutions && !is_over()) {
      const int before = count();
      try_batch();
      futile = count() > before ? 0 : futile + 1;
      if (before > 0 && futile == internal::kIkPatience) break;
    }
    std::ranges::stable_sort(result_.solutions, {}, [&](const Configuration& q) {
      return chain_.robot.distance(near_, q);
    });
    if (!closest_.empty()) result_.closest = pose_error(chain_.robot, goal_, complete(closest_));
    // A batch may find more than wanted.
    if (count() > settings_.solutions) result_.solutions.resize(as_index(settings_.solutions));
    for (auto* found : {&result_.solutions, &result_.blocked}) {
      for (Configuration& q : *found) q = chain_.robot.turned_near(q, given_near_);
    }
    return std::move(result_);
  }

 private:
  /// Number of seeds of the first batch around `near`, with growing distance.
  static constexpr int kAround = 6;
  static constexpr float kSpread = 0.15f;

  [[nodiscard]] int count() const { return static_cast<int>(result_.solutions.size()); }
  [[nodiscard]] bool is_over() const { return settings_.is_over && settings_.is_over(); }

  void try_batch() {
    const bool is_first = result_.seeds == 0;
    const internal::IkTarget& target = target_.make(is_first, rng_);
    sample_seeds(is_first);
    const int batch = std::min(internal::kIkBatch, settings_.seeds - result_.seeds);
    const int wanted = settings_.solutions - count();
    std::array<internal::IkError, internal::kIkBatch> errors;
    chain_.kernel(chain_.tables,
                  {&target, chain_.lower.data(), chain_.upper.data(), seeds_.data(), batch,
                   internal::kIkRounds, wanted},
                  rows_.data(), errors.data());
    for (int i = 0; i < batch; ++i) take(errors[as_index(i)], row(i));
    result_.seeds += batch;
  }

  [[nodiscard]] std::span<const float> row(int i) const {
    const std::size_t joints = chain_.joints.size();
    return std::span(rows_).subspan(as_index(i) * joints, joints);
  }

  void sample_seeds(bool is_first) {
    auto seed = seeds_.begin();
    for (int i = 0; i < internal::kIkBatch; ++i) {
      for (const int joint : chain_.joints) {
        const auto near = static_cast<float>(near_[as_index(joint)]);
        const float lower = chain_.space.lower(joint), upper = chain_.space.upper(joint);
        *seed++ = is_first && i < kAround
                      ? chain_.space.into_limits(
                            joint, near + kSpread * static_cast<float>(i) * rng_.bell())
                      : lower + (upper - lower) * static_cast<float>(rng_.uniform());
      }
    }
  }

  void take(const internal::IkError& error, std::span<const float> values) {
    const float badness = error.position + error.rotation / 4;
    if (badness < least_badness_) {
      least_badness_ = badness;
      closest_.assign(values.begin(), values.end());
    }
    if (!target_.is_reached(error)) return;
    const Configuration q = complete(values);
    const auto is_same = [&](const Configuration& other) {
      return chain_.robot.distance(q, other) < settings_.apart;
    };
    if (std::ranges::any_of(result_.solutions, is_same)) return;
    const std::span<const double> state(q);
    if (checker_ == nullptr || checker_->is_motion_valid(state, state, {1, clearance_})) {
      result_.solutions.push_back(q);
    } else if (result_.blocked.size() < internal::kMostBlocked) {
      result_.blocked.push_back(q);
    }
  }

  /// Returns the configuration of the whole group, with each joint's turn nearest to `near`.
  [[nodiscard]] Configuration complete(std::span<const float> values) const {
    Configuration q = near_;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const int joint = chain_.joints[k];
      const double value = chain_.space.into_limits(joint, values[k]);
      q[as_index(joint)] =
          nearest_turn(chain_.robot.group_joint(joint), value, near_[as_index(joint)]);
    }
    return q;
  }

  static double nearest_turn(const Joint& joint, double value, double near) {
    constexpr double kTurn = 2 * std::numbers::pi;
    if (joint.type != JointType::revolute) return value;
    const double least = std::ceil((joint.lower - value) / kTurn);
    const double most = std::floor((joint.upper - value) / kTurn);
    if (least > most) return value;
    return value + kTurn * std::clamp(std::round((near - value) / kTurn), least, most);
  }

  const Chain& chain_;
  Configuration given_near_, near_;
  const PoseGoal& goal_;
  const IkSettings& settings_;
  const CollisionChecker* checker_;
  double clearance_;
  internal::TargetMaker target_;
  Rng rng_;
  std::vector<float> seeds_, rows_;
  std::vector<float> closest_;  ///< result of a seed that is closest to the goal
  float least_badness_ = std::numeric_limits<float>::infinity();
  IkResult result_;
};

}  // namespace

Result<InverseKinematics> InverseKinematics::make(const Robot& robot, const std::string& link,
                                                  Isa isa) {
  const auto found = robot.find_link(link);
  if (!found) {
    return fail(ErrorCode::invalid, "expected a link of robot {}, got \"{}\"", robot.name(), link);
  }
  if (!is_available(isa)) {
    return fail(ErrorCode::unsupported, "this machine does not have the instruction set {}",
                to_string(isa));
  }
  const auto checked = MNEME_TRY(internal::share_checked_robot(robot));
  const internal::RobotTables& all = checked->tables;
  const internal::LinkPlace& place = all.links[as_index(*found)];
  auto chain = std::make_shared<Chain>(
      Chain{robot, internal::JointSpace(robot), {}, {}, {}, {}, 0, {}, nullptr});
  chain->joints = internal::take_chain(all, place.frame, chain->tables);
  if (chain->joints.empty() || chain->tables.joint_count > internal::kMostWalkingJoints) {
    return fail(chain->joints.empty() ? ErrorCode::invalid : ErrorCode::unsupported,
                "{} joints of the group of robot {} move link \"{}\"; inverse kinematics handles "
                "1 to {}",
                chain->tables.joint_count, robot.name(), link, internal::kMostWalkingJoints);
  }
  constexpr float kUnlimited = std::numeric_limits<float>::infinity();
  for (const int joint : chain->joints) {
    const bool wraps = chain->space.periods()[as_index(joint)] > 0;
    chain->lower.push_back(wraps ? -kUnlimited : chain->space.lower(joint));
    chain->upper.push_back(wraps ? kUnlimited : chain->space.upper(joint));
  }
  chain->frame = static_cast<int>(chain->tables.frames.size());
  chain->X_frame_link = internal::to_transform(place);
  chain->kernel = internal::ik_kernel(isa);
  return InverseKinematics(std::move(chain));
}

IkResult InverseKinematics::solve(const PoseGoal& goal, std::span<const double> near,
                                  const IkSettings& settings, const CollisionChecker* checker,
                                  double clearance) const {
  return IkSearch(*chain_, goal, near, settings, checker, clearance).search();
}

}  // namespace mneme
