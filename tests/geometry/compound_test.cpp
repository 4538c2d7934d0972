// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/fcl_shapes.h"
#include "geometry/part_distance.h"
#include "geometry/random_compounds.h"
#include "geometry/solids.h"
#include "support/support.h"

#include <array>
#include <cmath>

namespace mneme::test {
namespace {

constexpr std::array kMakers = {random_cloud, random_mesh, random_octree};

/// Points of the triangle's rim and inside, densely: no distance is less than that of the triangle.
double distance_by_samples(const Vec3& a, const Vec3& b, const Triangle& t) {
  constexpr int kSampleSteps = 60;
  double least = 1e9;
  for (int i = 0; i <= kSampleSteps; ++i) {
    for (int j = 0; i + j <= kSampleSteps; ++j) {
      const Vec3 p = t.a + (t.b - t.a) * i / kSampleSteps + (t.c - t.a) * j / kSampleSteps;
      least = std::min(least, distance_to_segment(a, b, Sphere{p, 1e-12}));
    }
  }
  return least;
}

Triangle random_triangle(Rng& rng) {
  return {random_vector(rng, 0.5), random_vector(rng, 0.5), random_vector(rng, 0.5)};
}

/// Where two triangles are nearest, an edge of one is nearest to the other.
double distance_by_edges(const Triangle& s, const Triangle& t) {
  using internal::distance_between;
  return std::min({distance_between(s.a, s.b, t), distance_between(s.b, s.c, t),
                   distance_between(s.c, s.a, t), distance_between(t.a, t.b, s),
                   distance_between(t.b, t.c, s), distance_between(t.c, t.a, s)});
}

/// With a corner in the plane of the other one, parallel to it, along an edge of it, with a corner
/// of it, a needle, nearly parallel: whatever makes comparisons degenerate.
Triangle awkward_neighbour(const Triangle& t, Rng& rng) {
  const Vec3 u = t.b - t.a, v = t.c - t.a, off = random_vector(rng, 0.5);
  const auto within = [&] { return Vec3(t.a + rng.uniform(-1, 2) * u + rng.uniform(-1, 2) * v); };
  switch (rng.index(6)) {
    case 0:
      return {within(), random_vector(rng, 0.5), random_vector(rng, 0.5)};
    case 1:
      return {t.a + off, t.b + off, t.c + off};
    case 2:
      return {t.a + off, t.a + off + 2 * u, random_vector(rng, 0.5)};
    case 3:
      return {t.a, random_vector(rng, 0.5), random_vector(rng, 0.5)};
    case 4:
      return {off, off + u, off + u + 1e-7 * random_vector(rng, 1)};
    default:
      return {t.a + off, t.b + off + 1e-6 * random_vector(rng, 1), t.c + off};
  }
}

/// Three points of the plane of a triangle, or of a line, or one point.
Triangle flat_neighbour(const Triangle& t, std::uint64_t dimensions, Rng& rng) {
  const Vec3 at = dimensions == 2 ? t.a : random_vector(rng, 0.5);
  const Vec3 u = dimensions > 0 ? Vec3(t.b - t.a) : Vec3::Zero();
  const Vec3 v = dimensions > 1 ? Vec3(t.c - t.a) : Vec3::Zero();
  const auto within = [&] { return Vec3(at + rng.uniform(-1, 2) * u + rng.uniform(-1, 2) * v); };
  return {within(), within(), within()};
}

constexpr int kSampleSteps = 24;

std::vector<Vec3> samples_of(const Triangle& t) {
  std::vector<Vec3> samples;
  for (int i = 0; i <= kSampleSteps; ++i) {
    for (int k = 0; k <= kSampleSteps - i; ++k) {
      const double u = static_cast<double>(i) / kSampleSteps,
                   v = static_cast<double>(k) / kSampleSteps;
      samples.push_back(t.a + u * (t.b - t.a) + v * (t.c - t.a));
    }
  }
  return samples;
}

double distance_by_samples(const Triangle& s, const Triangle& t) {
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> others = samples_of(t);
  for (const Vec3& p : samples_of(s)) {
    for (const Vec3& q : others) least = std::min(least, (p - q).squaredNorm());
  }
  return std::sqrt(least);
}

double longest_edge(const Triangle& t) {
  return std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()});
}

TEST_SUITE("law") {
  TEST_CASE("triangles in one plane, or without area, are as far apart as their points are") {
    constexpr std::uint64_t kSeed = 72;
    Rng rng(kSeed);
    for (std::uint64_t i = 0; i < 600; ++i) {
      const std::uint64_t dimensions = i % 3;
      Triangle s = random_triangle(rng);
      const Triangle t = flat_neighbour(s, dimensions, rng);
      if (i % 2 == 0 && dimensions < 2) s = flat_neighbour(s, 1, rng);
      const double sampled = distance_by_samples(s, t);
      const double step = (longest_edge(s) + longest_edge(t)) / kSampleSteps;
      INFO("seed " << kSeed << ", pair " << i);
      for (const double found :
           {internal::distance_between(s, t, 1e9), internal::distance_between(t, s, 1e9)}) {
        CHECK(found <= sampled + 1e-9);
        // In one plane rounding may take what is near for a contact.
        if (dimensions < 2 || found > 0) CHECK(found >= sampled - step);
      }
    }
  }

  TEST_CASE("triangles are as far apart as their edges say, or farther than what is asked for") {
    constexpr std::uint64_t kSeed = 71;
    constexpr double kFar = 1e9, kTolerance = 1e-8;
    Rng rng(kSeed);
    int touching = 0;
    for (int i = 0; i < 20000; ++i) {
      const Triangle s = random_triangle(rng);
      const Triangle t = i % 2 == 0 ? random_triangle(rng) : awkward_neighbour(s, rng);
      const double expected = distance_by_edges(s, t);
      INFO("seed " << kSeed << ", pair " << i);
      CHECK(internal::distance_between(s, t, kFar) ==
            doctest::Approx(expected).epsilon(kTolerance));
      CHECK(internal::distance_between(t, s, kFar) ==
            doctest::Approx(expected).epsilon(kTolerance));
      CHECK(internal::distance_between(s, t, expected + 0.01) ==
            doctest::Approx(expected).epsilon(kTolerance));
      const double less = 0.9 * expected;
      if (less > kTolerance) CHECK(internal::distance_between(s, t, less) == less);
      touching += expected == 0 ? 1 : 0;
    }
    CHECK(touching > 2000);
    CHECK(touching < 18000);
  }

  TEST_CASE("distances from points, meshes and octrees are those from their nearest part") {
    Rng rng(61);
    for (const auto make : kMakers) {
      for (int i = 0; i < 20; ++i) {
        const Shape made = make(rng), shape = transformed(random_pose(rng, 1.0), made);
        for (int k = 0; k < 50; ++k) {
          const Vec3 a = random_vector(rng, 1.5), b = k % 2 == 0 ? a : random_vector(rng, 1.5);
          const double expected = std::visit(DistanceByParts{a, b}, shape);
          INFO("seed 61, " << shape_name(shape) << ' ' << i << ", segment " << k);
          CHECK(distance_to_segment(a, b, shape) == doctest::Approx(expected).epsilon(1e-9));
          if (k % 2 == 0) {
            CHECK((internal::nearest_point(a, shape) - a).norm() == doctest::Approx(expected));
          }
        }
      }
    }
  }

  TEST_CASE("a segment is as far from a triangle as from its nearest point") {
    Rng rng(62);
    int crossing = 0;
    for (int i = 0; i < 300; ++i) {
      const Triangle t{random_vector(rng, 1), random_vector(rng, 1), random_vector(rng, 1)};
      const Vec3 a = random_vector(rng, 1), b = i % 3 == 0 ? a : random_vector(rng, 1);
      const double exact = internal::distance_between(a, b, t);
      const double sampled = distance_by_samples(a, b, t);
      INFO("seed 62, triangle " << i);
      CHECK(exact <= sampled + 1e-9);
      CHECK(sampled - exact < 0.03);
      crossing += exact == 0 ? 1 : 0;
    }
    CHECK(crossing > 10);
  }

  TEST_CASE("spheres and capsules are as far from a mesh as FCL has them") {
    Rng rng(64);
    int apart = 0, touching = 0;
    for (int i = 0; i < 20; ++i) {
      const Shape made = random_mesh(rng), mesh = transformed(random_pose(rng, 0.5), made);
      const double radius = std::get<Mesh>(mesh).radius;
      for (int k = 0; k < 20; ++k) {
        const Capsule own{random_vector(rng, 1.2), random_vector(rng, 1.2), 0.05};
        const double exact = distance_to_segment(own.a, own.b, mesh) + radius;
        const double expected = fcl_distance(own, mesh);
        INFO("seed 64, mesh " << i << ", capsule " << k);
        CHECK(std::abs(std::max(exact - own.radius, 0.0) - expected) < 1e-4);
        ++(expected > 0 ? apart : touching);
      }
    }
    CHECK(apart > 50);
    CHECK(touching > 50);
  }

  TEST_CASE("the oriented box of a compound shape holds all of its parts") {
    Rng rng(65);
    for (int i = 0; i < 30; ++i) {
      const Shape made = kMakers[i % 3](rng), shape = transformed(random_pose(rng, 1.0), made);
      const Shape box = std::visit(
          [](const auto& s) -> Shape {
            if constexpr (requires { s.parts; }) return internal::oriented_box(s);
            return s;
          },
          shape);
      REQUIRE(shape_name(box) == "box");
      const Sphere around = bounding_sphere(shape);
      for (int k = 0; k < 50; ++k) {
        const Vec3 outside = around.center + random_vector(rng, 1.0);
        CHECK(distance(outside, box) <= distance(outside, shape) + 1e-6);
        CHECK(distance(internal::nearest_point(outside, shape), box) < 1e-6);
      }
    }
  }

  TEST_CASE("a compound shape moves, grows and is bounded with its parts") {
    Rng rng(63);
    for (const auto make : kMakers) {
      const Shape shape = make(rng);
      const Transform X = random_pose(rng, 1.0);
      const Sphere bound = bounding_sphere(transformed(X, shape));
      for (int k = 0; k < 50; ++k) {
        const Vec3 p = random_vector(rng, 2.0);
        CHECK(distance(X * p, transformed(X, shape)) == doctest::Approx(distance(p, shape)));
        CHECK(distance(p, transformed(X, shape)) >= distance(p, Shape{bound}) - 1e-9);
        const Shape larger = internal::scaled(shape, Vec3::Zero(), 2);
        CHECK(distance(2 * p, larger) == doctest::Approx(2 * distance(p, shape)).epsilon(1e-5));
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
