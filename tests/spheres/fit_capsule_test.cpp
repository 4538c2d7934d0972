// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/fit_capsule.h"
#include "geometry/part_distance.h"
#include "spheres/solids.h"

#include <algorithm>
#include <limits>

namespace mneme::test {
namespace {

using internal::approximate_solid;
using internal::fit_capsule;
using internal::SolidModel;
using internal::TriangleMesh;

/// The surface of a capsule along z as rings of triangles, in a random pose.
TriangleMesh make_capsule(double radius, double length, Rng& rng) {
  constexpr int kSides = 32, kRings = 16;
  const Transform pose{rotation_from_rpy(random_point(rng, 3)), random_point(rng, 0.2)};
  const auto at = [&](int ring, int side) {
    const double lean = kPi * ring / kRings, angle = 2 * kPi * (side % kSides) / kSides;
    const double z = radius * std::cos(lean) + (ring <= kRings / 2 ? 0.5 : -0.5) * length;
    const double away = radius * std::sin(lean);
    return pose * Vec3(away * std::cos(angle), away * std::sin(angle), z);
  };
  TriangleMesh mesh;
  const auto add_ring = [&](const auto& upper, const auto& lower) {
    for (int side = 0; side < kSides; ++side) {
      mesh.push_back({upper(side), lower(side), lower(side + 1)});
      mesh.push_back({upper(side), lower(side + 1), upper(side + 1)});
    }
  };
  for (int ring = 0; ring < kRings; ++ring) {
    add_ring([&](int side) { return at(ring, side); },
             [&](int side) { return at(ring + 1, side); });
  }
  std::erase_if(mesh, [](const Triangle& t) { return !(t.area() > 1e-12); });
  return mesh;
}

double distance_to_axis(const Capsule& capsule, const Vec3& p) {
  const Vec3 along = capsule.b - capsule.a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - capsule.a).dot(along) / length2, 0.0, 1.0) : 0;
  return (p - capsule.a - t * along).norm();
}

TEST_SUITE("unit") {
  TEST_CASE("a cylinder between two balls of its radius is a capsule") {
    Rng rng(3);
    const Transform pose{rotation_from_rpy(random_point(rng, 3)), random_point(rng, 0.2)};
    const Vec3 top = pose * Vec3(0, 0, 0.25), bottom = pose * Vec3(0, 0, -0.25);
    Link link;
    link.solids = {Box{{}, Vec3(1, 1, 1)}, Cylinder{pose, 0.1, 0.5}};
    link.spheres = {{top, 0.1}, {Vec3(9, 9, 9), 0.1}, {bottom, 0.1}};
    Link without_ball = link, other_radius = link, other_place = link;
    internal::join_capsules(link);
    REQUIRE(link.capsules.size() == 1);
    CHECK(link.capsules[0].a == top);
    CHECK(link.capsules[0].b == bottom);
    CHECK(link.capsules[0].radius == 0.1);
    CHECK(link.solids.size() == 1);
    REQUIRE(link.spheres.size() == 1);
    CHECK(link.spheres[0].center == Vec3(9, 9, 9));
    without_ball.spheres.pop_back();
    other_radius.spheres[0].radius = 0.11;
    other_place.spheres[2].center += Vec3(0, 0.001, 0);
    for (Link* other : {&without_ball, &other_radius, &other_place}) {
      const std::size_t spheres = other->spheres.size();
      internal::join_capsules(*other);
      CHECK(other->capsules.empty());
      CHECK(other->solids.size() == 2);
      CHECK(other->spheres.size() == spheres);
    }
  }

  TEST_CASE("cylinders that share a ball are capsules both") {
    Link link;
    const Transform to_side{rotation_from_rpy(Vec3(0, kPi / 2, 0)), Vec3(0.5, 0, 0)};
    const Transform up{Eigen::Matrix3d::Identity(), Vec3(0, 0, 0.5)};
    link.solids = {Cylinder{up, 0.1, 1}, Cylinder{to_side, 0.1, 1}};
    link.spheres = {{Vec3(0, 0, 0), 0.1}, {Vec3(0, 0, 1), 0.1}, {Vec3(1, 0, 0), 0.1}};
    internal::join_capsules(link);
    CHECK(link.capsules.size() == 2);
    CHECK(link.solids.empty());
    CHECK(link.spheres.empty());
  }

  TEST_CASE("a mesh like a capsule becomes one that contains it") {
    Rng rng(6);
    for (int i = 0; i < 5; ++i) {
      const TriangleMesh mesh = make_capsule(0.05, 0.3, rng);
      const LinkSpheres made = approximate_solid(mesh, {});
      CHECK(made.spheres.empty());
      REQUIRE(made.capsules.size() == 1);
      CHECK(made.capsules[0].radius == doctest::Approx(0.05).epsilon(0.02));
      CHECK((made.capsules[0].b - made.capsules[0].a).norm() == doctest::Approx(0.3).epsilon(0.02));
      CHECK(made.max_excess < 0.002);
      for (const Triangle& t : mesh) {
        for (const Vec3& p : {t.a, t.b, t.c}) {
          CHECK(distance_to_axis(made.capsules[0], p) <= made.capsules[0].radius);
        }
      }
    }
  }

  TEST_CASE("a slender cylinder is within a capsule, a stout one and a box are not") {
    const auto fit = [](const TriangleMesh& mesh) {
      return fit_capsule(mesh, SolidModel(mesh), 0.015);
    };
    const auto slender = require(fit(internal::triangulate(Cylinder{{}, 0.01, 0.4})));
    CHECK(slender.excess.max <= 0.015);
    CHECK(slender.excess.mean <= 0.0075);
    CHECK_FALSE(fit(internal::triangulate(Cylinder{{}, 0.06, 0.3})).has_value());
    CHECK_FALSE(fit(internal::triangulate(make_box({0.2, 0.1, 0.1}))).has_value());
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("distances to a surface are those of the exact geometry, also from slivers") {
    Rng rng(7);
    TriangleMesh mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    mesh.push_back({{0, 0, 0.2}, {0.1, 0, 0.2}, {0.2, 1e-12, 0.2}});
    mesh.push_back({{0.3, 0, 0}, {0.3, 0, 0}, {0.4, 0, 0}});
    for (int i = 0; i < 200; ++i) {
      mesh.push_back({random_point(rng, 0.3), random_point(rng, 0.3), random_point(rng, 0.3)});
    }
    const internal::SurfaceDistance surface(mesh);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = random_point(rng, 0.5);
      double least = std::numeric_limits<double>::infinity();
      for (const Triangle& t : mesh) {
        least = std::min(least, (p - internal::nearest_on(p, t)).norm());
      }
      CHECK(surface.from(p) == doctest::Approx(least).epsilon(1e-9));
      CHECK(surface.from(p, 2 * least) == surface.from(p));
      CHECK(surface.from(p, 0.5 * least) == 0.5 * least);
    }
  }
}

}  // namespace
}  // namespace mneme::test
