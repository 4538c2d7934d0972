// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/box_surface.h"
#include "geometry/fcl_shapes.h"
#include "geometry/random_compounds.h"
#include "geometry/solids.h"
#include "support/support.h"

#include <array>

namespace mneme::test {
namespace {

using internal::distance_to_solid;

Box random_box(Rng& rng) {
  return {random_pose(rng, 0.8), random_vector(rng, 0.8).cwiseAbs() + Vec3::Constant(0.02)};
}

Mesh joined(const Box& a, const Box& b) {
  std::vector<Triangle> triangles = surface_of(a);
  for (const Triangle& t : surface_of(b)) triangles.push_back(t);
  return compound_of(std::move(triangles));
}

/// From a solid box, part by part.
struct FromBox {
  const Box& box;
  template <class Solid>
  double operator()(const Solid& solid) const {
    return fcl_distance(box, solid);
  }
  double operator()(const Sphere& s) const {
    return std::max(0.0, distance(s.center, box) - s.radius);
  }
  double operator()(const Capsule& s) const {
    return std::max(0.0, distance_to_segment(s.a, s.b, box) - s.radius);
  }
  double operator()(const PointCloud& s) const {
    double least = 1e9;
    for (const auto& [x, y, z] : s.parts->list()) {
      least = std::min(least, distance(s.pose * Vec3(x, y, z), box));
    }
    return std::max(0.0, least - s.radius);
  }
  double operator()(const Octree& s) const {
    double least = 1e9;
    for (const Cube& cube : s.parts->list()) {
      const Box part{s.pose * Transform{Eigen::Matrix3d::Identity(), cube.center},
                     Vec3::Constant(cube.half_extent)};
      least = std::min(least, fcl_distance(box, part));
    }
    return least;
  }
  double operator()(const Mesh& s) const {
    double least = 1e9;
    for (const Triangle& t : s.parts->list()) {
      const Mesh part{s.pose, std::make_shared<Parts<Triangle>>(std::vector{t}), 0};
      least = std::min(least, fcl_distance(box, part));
    }
    return std::max(0.0, least - s.radius);
  }
};

TEST_SUITE("oracle") {
  TEST_CASE("the surface of a box is as far from any shape as the box") {
    Rng rng(71);
    int apart = 0, together = 0;
    for (int i = 0; i < 400; ++i) {
      const Box box = random_box(rng);
      const Mesh surface = compound_of(surface_of(box));
      const Shape shape =
          i % 8 < 4 ? random_shape(i % 8, rng)
                    : transformed(random_pose(rng, 1.5),
                                  std::array{random_cloud, random_mesh, random_octree}[i % 3](rng));
      const double expected = std::visit(FromBox{box}, shape);
      INFO("seed 71, pair " << i << ", " << shape_name(shape));
      CHECK(distance_to_solid(surface, shape) == doctest::Approx(expected).epsilon(1e-5));
      (expected > 0 ? apart : together) += 1;
    }
    CHECK(apart > 100);
    CHECK(together > 60);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the surfaces of two boxes are as far apart as the boxes") {
    Rng rng(73);
    int apart = 0, beyond = 0;
    for (int i = 0; i < 400; ++i) {
      const Box a = random_box(rng), b = random_box(rng);
      const Mesh first = compound_of(surface_of(a));
      const Transform X = random_pose(rng, 1.0);
      // One is given in its own frame.
      const Mesh second{
          X, compound_of(surface_of(std::get<Box>(transformed(X.inverse(), b)))).parts, 0};
      const double expected = fcl_distance(a, b);
      INFO("seed 73, pair " << i);
      CHECK(internal::distance_between_solids(first, second, 1e9) ==
            doctest::Approx(expected).epsilon(1e-5));
      constexpr double kEnough = 0.1;
      const double least = internal::distance_between_solids(first, second, kEnough);
      if (expected < kEnough) CHECK(least == doctest::Approx(expected).epsilon(1e-5));
      if (expected > kEnough) CHECK(least >= kEnough);
      apart += expected > 0 ? 1 : 0;
      beyond += expected > kEnough ? 1 : 0;
    }
    CHECK(apart > 80);
    CHECK(beyond > 40);
  }
}

TEST_SUITE("law") {
  TEST_CASE("poses of the surface and of the world do not matter") {
    Rng rng(72);
    for (int i = 0; i < 60; ++i) {
      const Mesh surface = compound_of(surface_of(random_box(rng)));
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Transform X = random_pose(rng, 2.0);
      CHECK(distance_to_solid(std::get<Mesh>(transformed(X, surface)), transformed(X, shape)) ==
            doctest::Approx(distance_to_solid(surface, shape)).epsilon(1e-6));
    }
  }
}

TEST_SUITE("unit") {
  const Box kBox{{}, {0.5, 0.5, 0.5}};

  TEST_CASE("what lies wholly inside touches") {
    const Mesh surface = compound_of(surface_of(kBox));
    const Vec3 middle(0.1, 0.05, -0.1);
    const std::vector<CloudPoint> points = {{2, 0, 0}, {0.1F, 0.1F, 0.1F}};
    const std::vector<Shape> inside = {Sphere{middle, 0.1},
                                       Capsule{middle, -middle, 0.05},
                                       Box{{Eigen::Matrix3d::Identity(), middle}, {0.1, 0.1, 0.1}},
                                       Cylinder{{}, 0.1, 0.1},
                                       compound_of(points, 0.01),
                                       compound_of(surface_of(Box{{}, {0.1, 0.1, 0.1}})),
                                       compound_of(std::vector<Cube>{{middle, 0.1}})};
    for (const Shape& shape : inside) {
      INFO(shape_name(shape));
      CHECK(distance_to_solid(surface, shape) == 0);
    }
  }

  TEST_CASE("what holds all of the surface touches it, but for a mesh") {
    const Mesh surface = compound_of(surface_of(kBox));
    CHECK(distance_to_solid(surface, Sphere{Vec3::Zero(), 3}) == 0);
    CHECK(distance_to_solid(surface, Box{{}, {2, 2, 2}}) == 0);
    CHECK(distance_to_solid(surface, Cylinder{{}, 2, 4}) == 0);
    CHECK(distance_to_solid(surface, compound_of(std::vector<Cube>{{Vec3::Zero(), 2}})) == 0);
    CHECK(distance_to_solid(surface, compound_of(surface_of(Box{{}, {2, 2, 2}}))) ==
          doctest::Approx(1.5));
  }

  TEST_CASE("faces that lie above one another are as far apart as their planes") {
    Rng rng(11);
    const Mesh surface = compound_of(surface_of(kBox));
    for (int i = 0; i < rounds(50); ++i) {
      const double height = rng.uniform(1e-4, 0.2);
      const Transform above{rotation_about(Vec3::UnitZ(), rng.uniform(-3, 3)),
                            {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), 1 + height}};
      const Transform pose = random_pose(rng, 0.8);
      const Mesh moved{pose, surface.parts, 0};
      const Box plate{pose * above, {0.7, 0.6, 0.5}};
      CHECK(distance_to_solid(moved, plate) == doctest::Approx(height).epsilon(1e-9));
      CHECK(distance_to_solid(moved, Cylinder{pose * above, 0.4, 1}) ==
            doctest::Approx(height).epsilon(1e-6));
    }
  }

  TEST_CASE("where two solids overlap is inside") {
    const Mesh both = joined(kBox, {{Eigen::Matrix3d::Identity(), {0.4, 0, 0}}, {0.5, 0.5, 0.5}});
    CHECK(distance_to_solid(both, Sphere{{0.2, 0, 0}, 0.05}) == 0);
    CHECK(distance_to_solid(both, Sphere{{-0.3, 0, 0}, 0.05}) == 0);
    CHECK(distance_to_solid(both, Sphere{{1.5, 0, 0}, 0.05}) == doctest::Approx(0.55));
  }

  TEST_CASE("of two solids either may hold the other, or a piece of it") {
    const Mesh outer = compound_of(surface_of(kBox));
    const Box small{{}, {0.1, 0.1, 0.1}}, away{{Eigen::Matrix3d::Identity(), {3, 0, 0}}, {1, 1, 1}};
    for (const Mesh& inner : {compound_of(surface_of(small)), joined(away, small)}) {
      CHECK(internal::distance_between_solids(outer, inner, 1e9) == 0);
      CHECK(internal::distance_between_solids(inner, outer, 1e-3) == 0);
    }
    CHECK(internal::distance_between_solids(outer, compound_of(surface_of(away)), 9) ==
          doctest::Approx(1.5));
  }

  /// Four walls and a bottom, which overlap.
  std::vector<Triangle> cup_of(double width, double depth) {
    constexpr double kWall = 0.1;
    const double away = (width + kWall) / 2, side = width + 2 * kWall, middle = depth / 2;
    const auto at = [](double x, double y, double z) {
      return Transform{Eigen::Matrix3d::Identity(), {x, y, z}};
    };
    const Vec3 along_x(side / 2, kWall / 2, middle), along_y(kWall / 2, side / 2, middle);
    const std::array<Box, 5> boxes = {
        Box{at(away, 0, middle), along_y}, Box{at(-away, 0, middle), along_y},
        Box{at(0, away, middle), along_x}, Box{at(0, -away, middle), along_x},
        Box{at(0, 0, 0), {side / 2, side / 2, kWall / 2}}};
    std::vector<Triangle> triangles;
    for (const Box& box : boxes) {
      for (const Triangle& t : surface_of(box)) triangles.push_back(t);
    }
    return triangles;
  }

  TEST_CASE("what stands deep in a cup does not touch it") {
    const Mesh inner = compound_of(surface_of(Box{{}, {0.02, 0.02, 0.02}}));
    const Mesh low{{Eigen::Matrix3d::Identity(), {0, 0, 0.1}}, inner.parts, 0};
    const Mesh in_wall{{Eigen::Matrix3d::Identity(), {0.15, 0, 0.5}}, inner.parts, 0};
    const Mesh in_two_walls{{Eigen::Matrix3d::Identity(), {0.15, 0.15, 0.5}}, inner.parts, 0};
    const auto gap = [](const Mesh& a, const Mesh& b) {
      return internal::distance_between_solids(a, b, 1e9);
    };
    const Mesh deep = compound_of(cup_of(0.2, 2));
    CHECK(gap(deep, low) == doctest::Approx(0.03));
    CHECK(gap(deep, in_wall) == 0);
    CHECK(gap(deep, in_two_walls) == 0);
    std::vector<Triangle> with_rim = cup_of(0.2, 0.3);
    with_rim.pop_back();
    const Mesh torn = compound_of(std::move(with_rim));
    CHECK(gap(torn, low) == doctest::Approx(0.03));
    CHECK(gap(torn, {{Eigen::Matrix3d::Identity(), {0.15, 0, 0.2}}, inner.parts, 0}) == 0);
  }

  TEST_CASE("a sheet with two sides does not hide what it surrounds") {
    std::vector<Triangle> both = surface_of(kBox);
    for (const Triangle& t : surface_of(kBox)) both.push_back({t.a, t.c, t.b});
    CHECK(distance_to_solid(compound_of(both), Sphere{Vec3::Zero(), 0.05}) == 0);
    CHECK(distance_to_solid(compound_of(both), Sphere{{0, 0, 2}, 0.05}) == doctest::Approx(1.45));
  }

  TEST_CASE("an opening does not let the outside in") {
    std::vector<Triangle> open = surface_of(kBox);
    open.resize(10);
    CHECK(distance_to_solid(compound_of(open), Sphere{Vec3::Zero(), 0.05}) == 0);
    CHECK(distance_to_solid(compound_of(open), Sphere{{0, 0, 2}, 0.05}) == doctest::Approx(1.45));
  }
}

}  // namespace
}  // namespace mneme::test
