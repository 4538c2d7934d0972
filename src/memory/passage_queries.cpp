// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/passage_queries.h"

#include "geometry/solids.h"
#include "primitive/passage.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

constexpr int kAttempts = 60;
constexpr double kStraight = 0.75;       // share of the starts that reach straight through
constexpr double kClearDistance = 0.15;  // metres between the middle and a robot that is out

struct Nearest {
  Vec3 point = Vec3::Zero();
  double distance = std::numeric_limits<double>::infinity();
};

Nearest nearest_obstacle(const Scene& scene, const Vec3& p) {
  Nearest nearest;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      const Vec3 point = nearest_point(p, shape);
      const double distance = (p - point).norm();
      if (distance < nearest.distance) nearest = {point, distance};
    }
  }
  return nearest;
}

template <class List>
std::uint32_t size_of(const List& list) {
  return static_cast<std::uint32_t>(list.size());
}

/// A direction near `direction`; zero stays zero.
Vec3 jittered(const Vec3& direction, Rng& rng) {
  constexpr double kJitter = 0.15;  // radians
  if (direction.isZero()) return direction;
  const Vec3 noise(rng.normal(), rng.normal(), rng.normal());
  return (direction + kJitter * noise).normalized();
}

/// Damped least squares (Nakamura and Hanafusa, DOI 10.1115/1.3143764) with wishes: one ball of the
/// body at the middle of the passage, another one straight behind it, and none in an obstacle.
class Settling {
 public:
  Settling(const CollisionChecker& checker, const std::vector<BodyPoint>& body, const Vec3& middle)
      : robot_(checker.robot()), scene_(checker.scene()), body_(body), middle_(middle) {}

  /// Moves `q` until the ball `target` covers the middle and nothing is in contact; false if that
  /// was not reached. On the way the ball `tip` is drawn to where it is in `direction` of the
  /// middle, unless that is zero.
  bool settle(int target, int tip, const Vec3& direction, Configuration& q) {
    constexpr int kRounds = 60;
    for (int round = 0; round < kRounds; ++round) {
      poses_ = robot_.link_poses(q);
      clear_wishes();
      const BodyPoint& covering = body_[static_cast<std::size_t>(target)];
      const BodyPoint& pointing = body_[static_cast<std::size_t>(tip)];
      const bool is_there = pull(covering, middle_) < 0.5 * covering.radius;
      if (!direction.isZero()) {
        pull(pointing, middle_ + (center(pointing) - center(covering)).norm() * direction);
      }
      const bool is_free = push_all();
      if (is_there && is_free) return true;
      step(q);
    }
    return false;
  }

 private:
  void clear_wishes() {
    constexpr double kDamping = 1e-3;
    const int n = robot_.joint_count();
    normal_ = kDamping * Eigen::MatrixXd::Identity(n, n);
    wished_ = Eigen::VectorXd::Zero(n);
  }

  [[nodiscard]] Vec3 center(const BodyPoint& point) const {
    return poses_[static_cast<std::size_t>(point.link)] * point.center;
  }

  /// Wishes `point` at `place`; returns how far that is.
  double pull(const BodyPoint& point, const Vec3& place) {
    constexpr double kLongestPull = 0.2;
    const Vec3 from = center(point);
    const Vec3 way = place - from;
    const double length = way.norm();
    const Eigen::Matrix3Xd rows = jacobian(robot_, poses_, point, from);
    normal_ += rows.transpose() * rows;
    wished_ += rows.transpose() * (std::min(1.0, kLongestPull / std::max(length, 1e-9)) * way);
    return length;
  }

  bool push_all() {
    constexpr double kMargin = 0.0005;
    bool is_free = true;
    for (const BodyPoint& point : body_) {
      const Vec3 from = center(point);
      const Nearest nearest = nearest_obstacle(scene_, from);
      const double depth = point.radius + kMargin - nearest.distance;
      if (depth <= 0) continue;
      is_free &= depth <= kMargin;
      // A centre inside an obstacle has no nearest way out: towards the passage is as good as any.
      const Vec3 way = nearest.distance > 0 ? from - nearest.point : middle_ - from;
      const double length = way.norm();
      if (length <= 0) continue;
      const Eigen::RowVectorXd row =
          (way / length).transpose() * jacobian(robot_, poses_, point, from);
      normal_ += row.transpose() * row;
      wished_ += depth * row.transpose();
    }
    return is_free;
  }

  void step(Configuration& q) const {
    constexpr double kLongestStep = 0.5;
    Eigen::VectorXd move = normal_.ldlt().solve(wished_);
    const double length = move.norm();
    if (length > kLongestStep) move *= kLongestStep / length;
    for (int j = 0; j < robot_.joint_count(); ++j) q[static_cast<std::size_t>(j)] += move[j];
    q = robot_.normalized(q);
  }

  const Robot& robot_;
  const Scene& scene_;
  const std::vector<BodyPoint>& body_;
  Vec3 middle_;
  std::vector<Transform> poses_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd wished_;
};

}  // namespace

std::optional<PassageQueries> PassageQueries::make(const CollisionChecker& checker) {
  const std::vector<Obstacle>& obstacles = checker.scene().obstacles;
  if (obstacles.size() < 2) return std::nullopt;
  const auto passage =
      find_passage(obstacles[0], obstacles[1], std::numeric_limits<double>::infinity());
  if (!passage) return std::nullopt;
  PassageQueries queries(checker, *passage);
  if (queries.body_.empty()) return std::nullopt;
  return queries;
}

PassageQueries::PassageQueries(const CollisionChecker& checker, const Passage& passage)
    : checker_(&checker), middle_(passage.middle()), body_(body_points(checker.robot())) {
  const SymmetricJoints joints = find_symmetric_joints(checker.robot());
  const Vec3 outwards(middle_.x() - joints.axis_x, middle_.y() - joints.axis_y, 0);
  const Vec3 across = (passage.b - passage.a).normalized();
  const Vec3 inwards = outwards - outwards.dot(across) * across;
  if (inwards.norm() > 0.1 * outwards.norm()) inwards_ = inwards.normalized();
  // A part belongs to the joint that carries it; the last joint carries what is least deep.
  std::vector<std::vector<int>> by_joint(static_cast<std::size_t>(checker.robot().joint_count()));
  std::vector<int> order;
  for (std::size_t i = 0; i < body_.size(); ++i) {
    const int joint = body_[i].joints.back();
    if (by_joint[static_cast<std::size_t>(joint)].empty()) order.push_back(joint);
    by_joint[static_cast<std::size_t>(joint)].push_back(static_cast<int>(i));
  }
  const auto depth = [&](int joint) {
    return body_[static_cast<std::size_t>(by_joint[static_cast<std::size_t>(joint)].front())]
        .joints.size();
  };
  std::ranges::stable_sort(order, [&](int a, int b) { return depth(a) > depth(b); });
  for (const int joint : order) strata_.push_back(by_joint[static_cast<std::size_t>(joint)]);
}

std::optional<Configuration> PassageQueries::draw_start(int depth,
                                                        std::span<const Configuration> earlier,
                                                        Rng& rng) const {
  const std::vector<int>& stratum = strata_[static_cast<std::size_t>(depth)];
  const std::vector<int>& tips = strata_.front();
  Settling settling(*checker_, body_, middle_);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // An arm that is in the passage already needs only be pushed further.
    const bool is_pushed = !earlier.empty() && rng.uniform() < 0.5;
    Configuration q = is_pushed ? shaken(earlier[rng.index(size_of(earlier))], rng) : random(rng);
    const int target = stratum[rng.index(size_of(stratum))];
    const int tip = tips[rng.index(size_of(tips))];
    const bool is_straight = rng.uniform() < kStraight;
    const Vec3 direction = is_straight ? jittered(inwards_, rng) : Vec3(Vec3::Zero());
    if (settling.settle(target, tip, direction, q) &&
        checker_->is_valid(std::span<const double>(q))) {
      return q;
    }
  }
  return std::nullopt;
}

Configuration PassageQueries::random(Rng& rng) const {
  Configuration q;
  for (int j = 0; j < checker_->robot().joint_count(); ++j) {
    const Joint& joint = checker_->robot().group_joint(j);
    q.push_back(rng.uniform(joint.lower, joint.upper));
  }
  return q;
}

Configuration PassageQueries::shaken(Configuration q, Rng& rng) const {
  constexpr double kShake = 0.1;
  for (double& value : q) value += kShake * rng.normal();
  return checker_->robot().normalized(q);
}

bool PassageQueries::is_clear(std::span<const double> q) const {
  const std::vector<Transform> poses = checker_->robot().link_poses(q);
  return std::ranges::none_of(body_, [&](const BodyPoint& point) {
    const Vec3 center = poses[static_cast<std::size_t>(point.link)] * point.center;
    return (center - middle_).norm() < point.radius + kClearDistance;
  });
}

}  // namespace mneme::internal
