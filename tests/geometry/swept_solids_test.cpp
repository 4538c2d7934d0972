// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/swept_solids.h"
#include "geometry/box_surface.h"
#include "geometry/random_compounds.h"
#include "geometry/random_shapes.h"
#include "geometry/solids.h"
#include "support/support.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numbers>

namespace mneme::test {
namespace {

using internal::BodyMotion, internal::MovingPose, internal::SweptSolid;

/// A slide by `slide`, then a turn by `angle` about an axis through `center`, both at constant
/// speed.
class Screw final : public BodyMotion {
 public:
  Screw(const Transform& from, const Vec3& center, const Vec3& axis, double angle,
        const Vec3& slide)
      : from_(from), center_(center), axis_(axis), slide_(slide), angle_(angle) {
    const double turn = std::abs(angle), away = (from.translation - center).norm();
    const double length = center.norm() + slide.norm();
    of_b = {turn * away + slide.norm(), turn, turn * turn * away, turn * turn};
    of_a = {turn * length + slide.norm(), turn, turn * turn * length + 2 * turn * slide.norm(),
            turn * turn};
    add_interval(0.5, 0.5);
  }

  [[nodiscard]] Transform pose(double share) const {
    const Transform turned{rotation_about(axis_, share * angle_), center_ + share * slide_};
    return turned * Transform{from_.rotation, from_.translation - center_};
  }
  [[nodiscard]] int poses() const { return poses_; }

 private:
  [[nodiscard]] MovingPose at(double share) const override {
    ++poses_;
    MovingPose result{pose(share), angle_ * axis_, slide_};
    result.speed += result.turn.cross(result.X_AB.translation - center_ - share * slide_);
    return result;
  }

  Transform from_;
  Vec3 center_, axis_, slide_;
  double angle_;
  mutable int poses_ = 0;
};

Screw random_screw(Rng& rng) {
  const Transform from = random_pose(rng, 1.0);
  const Vec3 axis = random_vector(rng, 1).normalized();
  return {from, random_vector(rng, 1), axis, rng.uniform(-2.0, 2.0), random_vector(rng, 0.5)};
}

/// A shape of any kind, near the origin.
Shape any_shape(int i, Rng& rng) {
  if (i % 7 < kShapeKinds) return transformed(random_pose(rng, 0.5), random_shape(i % 7, rng));
  return transformed(random_pose(rng, 0.5),
                     std::array{random_cloud, random_mesh, random_octree}[i % 3](rng));
}

/// Between the solid box and the shape, over states of the motion.
double least_distance(const Mesh& box, const Shape& shape, const Screw& motion, int states) {
  double least = 1e9;
  for (int i = 0; i <= states && least > 0; ++i) {
    const double share = static_cast<double>(i) / states;
    least =
        std::min(least, internal::distance_to_solid(box, transformed(motion.pose(share), shape)));
  }
  return least;
}

/// A disc of `sectors` triangles about the z axis.
Mesh disc_at(double z, double radius, int sectors) {
  std::vector<Triangle> triangles;
  const auto rim = [&](int i) {
    const double angle = 2 * std::numbers::pi * i / sectors;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  for (int i = 0; i < sectors; ++i) triangles.push_back({{0, 0, z}, rim(i), rim(i + 1)});
  return compound_of(std::move(triangles));
}

TEST_SUITE("oracle") {
  TEST_CASE("solids stay apart exactly where they are apart at every state of a motion") {
    constexpr int kStates = 60;
    Rng rng(171);
    int apart = 0, together = 0;
    for (int i = 0; i < 700; ++i) {
      INFO("seed 171, motion " << i);
      const Box box{random_pose(rng, 0.3),
                    random_vector(rng, 0.4).cwiseAbs() + Vec3::Constant(0.02)};
      const Mesh surface = compound_of(surface_of(box));
      const Shape shape = any_shape(i, rng);
      const double margin = i % 4 == 0 ? 0.03 : 0;
      Screw motion = random_screw(rng);
      const bool stays =
          internal::stay_apart(SweptSolid(surface), SweptSolid(shape), motion, margin) &&
          !internal::may_enclose(surface, transformed(motion.pose(0.5), shape));
      const double least = least_distance(surface, shape, motion, kStates);
      const double between = (motion.of_a.speed + 1.2 * motion.of_a.speed_by_reach) / kStates;
      if (stays) REQUIRE(least > margin - 1e-9);
      if (least > margin + between + 1e-4) REQUIRE(stays);
      ++(stays ? apart : together);
    }
    CHECK(apart > 80);
    CHECK(together > 80);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("discs that turn close to each other are proven apart at a few states") {
    const SweptSolid below(disc_at(0, 0.05, 2000)), above(disc_at(0.007, 0.05, 2000));
    Screw motion({}, Vec3::Zero(), Vec3::UnitZ(), 5, Vec3::Zero());
    CHECK(internal::stay_apart(below, above, motion, 1e-4));
    CHECK(motion.poses() < 40);
  }

  TEST_CASE("the margin is kept between states, not just at them") {
    const SweptSolid below(disc_at(0, 0.05, 50)), ball(Shape(Sphere{{0, 0, 0}, 0.01}));
    for (const double height : {0.0109, 0.0111}) {
      // Passes 0.9 and 1.1 mm above the disc, far above it at both ends and in the middle.
      Screw motion({Eigen::Matrix3d::Identity(), {0.2, 0, 0.2 + height}}, {0, 0, 0.2 + height},
                   Vec3::UnitY(), 1.9 * std::numbers::pi, Vec3::Zero());
      CHECK(internal::stay_apart(below, ball, motion, 0.001) == (height > 0.011));
    }
  }

  TEST_CASE("between states as fine as they shall be contact may be missed, at them it is not") {
    const SweptSolid below(disc_at(0, 0.05, 50)), ball(Shape(Sphere{{0, 0, 0}, 0.01}));
    // Falls through the disc, and touches it for a fiftieth of the motion about its share.
    for (const double share : {0.3, 0.375}) {
      Screw motion({Eigen::Matrix3d::Identity(), {0, 0, share}}, {0, 0, 0}, Vec3::UnitZ(), 0.1,
                   {0, 0, -1});
      CHECK_FALSE(internal::stay_apart(below, ball, motion, 0));
      CHECK_FALSE(internal::stay_apart(below, ball, motion, 0, 1.0 / 128));
      CHECK(internal::stay_apart(below, ball, motion, 0, 1.0 / 8) == (share == 0.3));
    }
  }

  TEST_CASE("spheres and capsules count with their radii") {
    const std::array capsules = {Capsule{{0, 0, 0}, {0, 0, 0}, 0.1},
                                 Capsule{{1, 0, 0}, {2, 0, 0}, 0.2}};
    const SweptSolid row(capsules), ball(Shape(Sphere{{0, 0, 0}, 0.1}));
    for (const auto& [at, expected] : {std::pair{Vec3(0, 0.21, 0), true},
                                       {Vec3(0, 0.19, 0), false},
                                       {Vec3(1.5, 0.31, 0), true},
                                       {Vec3(1.5, 0.29, 0), false}}) {
      Screw still({Eigen::Matrix3d::Identity(), at}, at, Vec3::UnitZ(), 1, Vec3::Zero());
      CHECK(internal::stay_apart(row, ball, still, 0) == expected);
    }
  }
}

}  // namespace
}  // namespace mneme::test
