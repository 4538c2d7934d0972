// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/fcl_oracle.h"

#include "geometry/fcl_shapes.h"

#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::soak {
namespace {

using Object = fcl::CollisionObjectd;

Eigen::Isometry3d to_isometry(const Transform& X) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = X.rotation;
  result.translation() = X.translation;
  return result;
}

/// Values of all joints of the model, those that follow others included.
std::vector<double> joint_values(const Robot& robot, std::span<const double> q) {
  std::vector<double> values;
  for (const Joint& joint : robot.joints()) values.push_back(joint.fixed_value);
  for (std::size_t i = 0; i < q.size(); ++i) {
    values[static_cast<std::size_t>(robot.group()[i])] = q[i];
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (const auto& mimic = robot.joints()[i].mimic) {
      values[i] =
          mimic->multiplier * values[static_cast<std::size_t>(mimic->joint)] + mimic->offset;
    }
  }
  return values;
}

std::vector<Eigen::Isometry3d> place_links(const Robot& robot, std::span<const double> q) {
  std::vector<Eigen::Isometry3d> poses(robot.links().size(), Eigen::Isometry3d::Identity());
  const std::vector<double> values = joint_values(robot, q);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Joint& joint = robot.joints()[i];
    Eigen::Isometry3d pose =
        poses[static_cast<std::size_t>(joint.parent_link)] * to_isometry(joint.origin);
    if (joint.type == JointType::prismatic) {
      pose.translate(values[i] * joint.axis);
    } else if (joint.type != JointType::fixed) {
      pose.rotate(Eigen::AngleAxisd(values[i], joint.axis));
    }
    poses[static_cast<std::size_t>(joint.child_link)] = pose;
  }
  return poses;
}

bool is_capsule(const Object& object) { return object.getNodeType() == fcl::GEOM_CAPSULE; }

/// How deep two objects overlap; 0 if they do not. FCL has a formula for the distance of capsules,
/// but finds their overlap by iteration, which is not reliable for capsules a millimetre thick.
double depth_of(const Object& a, const Object& b) {
  if (is_capsule(a) && is_capsule(b)) {
    fcl::DistanceResultd result;
    const double distance = fcl::distance(&a, &b, fcl::DistanceRequestd{}, result);
    return distance > 0 ? 0 : std::max(-distance, std::numeric_limits<double>::min());
  }
  const fcl::CollisionRequestd request(1, true);
  fcl::CollisionResultd result;
  if (fcl::collide(&a, &b, request, result) == 0) return 0;
  return std::max(result.getContact(0).penetration_depth, std::numeric_limits<double>::min());
}

struct TreeQuery {
  double depth = 0;
  const Object* obstacle = nullptr;
};

bool note_overlap(Object* a, Object* b, void* data) {
  auto& query = *static_cast<TreeQuery*>(data);
  const double depth = depth_of(*a, *b);
  if (depth > query.depth) {
    query = {depth, a->getUserData() != nullptr ? a : b};
  }
  return false;
}

double wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

}  // namespace

FclOracle::FclOracle(const Robot& robot, const Scene& scene, double margin) : robot_(robot) {
  const auto add = [&](std::vector<Part>& parts, auto shape) {
    const Object placed = test::ToFcl{}(shape);
    shape.radius += margin;
    parts.push_back({std::make_unique<Object>(placed),
                     std::make_unique<Object>(test::ToFcl{}(shape)), placed.getTransform()});
  };
  for (const Link& link : robot.links()) {
    auto& parts = links_.emplace_back();
    for (const Sphere& sphere : link.spheres) add(parts, sphere);
    for (const Capsule& capsule : link.capsules) add(parts, capsule);
  }
  link_bounds_.resize(links_.size());
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      obstacles_.push_back(std::make_unique<Object>(std::visit(test::ToFcl{}, shape)));
      obstacles_.back()->computeAABB();
      obstacles_.back()->setUserData(const_cast<Obstacle*>(&obstacle));
      tree_.registerObject(obstacles_.back().get());
    }
  }
  tree_.setup();
}

void FclOracle::move_to(std::span<const double> q) {
  const std::vector<Eigen::Isometry3d> poses = place_links(robot_, q);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    link_bounds_[i] = fcl::AABBd();
    for (Part& part : links_[i]) {
      for (Object* object : {part.object.get(), part.inflated.get()}) {
        object->setTransform(poses[i] * part.in_link);
        object->computeAABB();
      }
      link_bounds_[i] += part.object->getAABB();
    }
  }
}

bool FclOracle::overlaps_obstacle(Overlap& worst) const {
  if (obstacles_.empty()) return false;
  bool is_worse = false;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    for (const Part& part : links_[i]) {
      TreeQuery query{worst.depth};
      tree_.collide(part.inflated.get(), &query, note_overlap);
      if (query.obstacle == nullptr) continue;
      const auto& obstacle = *static_cast<const Obstacle*>(query.obstacle->getUserData());
      worst = {query.depth, robot_.links()[i].name + " and " + obstacle.name};
      is_worse = true;
    }
  }
  return is_worse;
}

bool FclOracle::overlaps_itself(Overlap& worst) const {
  bool is_worse = false;
  for (const auto& [first, second] : robot_.self_pairs()) {
    const auto i = static_cast<std::size_t>(first);
    const auto j = static_cast<std::size_t>(second);
    if (!link_bounds_[i].overlap(link_bounds_[j])) continue;
    for (const Part& a : links_[i]) {
      if (!a.object->getAABB().overlap(link_bounds_[j])) continue;
      for (const Part& b : links_[j]) {
        if (!a.object->getAABB().overlap(b.object->getAABB())) continue;
        const double depth = depth_of(*a.object, *b.object);
        if (depth <= worst.depth) continue;
        worst = {depth, robot_.links()[i].name + " and " + robot_.links()[j].name};
        is_worse = true;
      }
    }
  }
  return is_worse;
}

std::optional<Overlap> FclOracle::overlap(std::span<const double> q, double tolerance) {
  move_to(q);
  Overlap worst{tolerance, {}};
  const bool is_in_scene = overlaps_obstacle(worst);
  const bool is_in_itself = overlaps_itself(worst);
  return is_in_scene || is_in_itself ? std::optional(worst) : std::nullopt;
}

std::optional<Overlap> FclOracle::deepest(const Path& path, double resolution) {
  std::optional<Overlap> worst;
  for (std::size_t i = 1; i < path.size(); ++i) {
    Configuration delta(path[i].size());
    double squares = 0;
    for (std::size_t j = 0; j < delta.size(); ++j) {
      delta[j] = path[i][j] - path[i - 1][j];
      const bool is_continuous =
          robot_.group_joint(static_cast<int>(j)).type == JointType::continuous;
      if (is_continuous) delta[j] = wrapped(delta[j]);
      squares += delta[j] * delta[j];
    }
    const int count = 1 + static_cast<int>(std::sqrt(squares) / resolution);
    for (int step = i == 1 ? 0 : 1; step <= count; ++step) {
      Configuration q = path[i - 1];
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * step / count;
      if (auto found = overlap(q, worst ? worst->depth : 0)) {
        worst = std::move(found);
        worst->what += " on motion " + std::to_string(i - 1);
      }
    }
  }
  return worst;
}

double FclOracle::clearance(std::span<const double> q) {
  move_to(q);
  double least = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const Object& a, const Object& b) {
    fcl::DistanceResultd result;
    least = std::min(least, fcl::distance(&a, &b, fcl::DistanceRequestd{}, result));
  };
  for (const auto& parts : links_) {
    for (const Part& part : parts) {
      for (const auto& obstacle : obstacles_) look_at(*part.inflated, *obstacle);
    }
  }
  for (const auto& [first, second] : robot_.self_pairs()) {
    for (const Part& a : links_[static_cast<std::size_t>(first)]) {
      for (const Part& b : links_[static_cast<std::size_t>(second)]) look_at(*a.object, *b.object);
    }
  }
  return std::max(0.0, least);
}

}  // namespace mneme::soak
