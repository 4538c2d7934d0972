// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The same shapes in FCL, and its distance between them: 0 where they overlap.
#pragma once

#include "mneme/geometry.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

namespace mneme::test {

/// A rotation that takes z to the direction of `v`.
inline Eigen::Matrix3d rotation_to(const Vec3& v) {
  return v.norm() < 1e-12 ? Eigen::Matrix3d::Identity().eval()
                          : Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), v).toRotationMatrix();
}

struct ToFcl {
  using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
  static fcl::CollisionObjectd place(Geometry geometry, const Transform& pose) {
    return {std::move(geometry), pose.rotation, pose.translation};
  }
  fcl::CollisionObjectd operator()(const Sphere& s) const {
    return place(std::make_shared<fcl::Sphered>(s.radius), {Eigen::Matrix3d::Identity(), s.center});
  }
  fcl::CollisionObjectd operator()(const Box& s) const {
    return place(std::make_shared<fcl::Boxd>(2.0 * s.half_extents), s.pose);
  }
  fcl::CollisionObjectd operator()(const Cylinder& s) const {
    return place(std::make_shared<fcl::Cylinderd>(s.radius, s.length), s.pose);
  }
  fcl::CollisionObjectd operator()(const Capsule& s) const {
    return place(std::make_shared<fcl::Capsuled>(s.radius, (s.b - s.a).norm()),
                 {rotation_to(s.b - s.a), 0.5 * (s.a + s.b)});
  }
  /// Without its radius.
  fcl::CollisionObjectd operator()(const Mesh& s) const {
    auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    model->beginModel();
    for (const Triangle& t : s.parts->list()) model->addTriangle(t.a, t.b, t.c);
    model->endModel();
    return place(std::move(model), s.pose);
  }
  /// FCL has nothing of the kind.
  template <class Part>
  fcl::CollisionObjectd operator()(const CompoundShape<Part>&) const {
    throw std::logic_error("no shape of FCL");
  }
};

inline double fcl_distance(const Shape& first, const Shape& second) {
  const fcl::CollisionObjectd a = std::visit(ToFcl{}, first);
  const fcl::CollisionObjectd b = std::visit(ToFcl{}, second);
  fcl::DistanceRequestd request;
  request.distance_tolerance = 1e-8;
  fcl::DistanceResultd result;
  return std::max(0.0, fcl::distance(&a, &b, request, result));
}

}  // namespace mneme::test
