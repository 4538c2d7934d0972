// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/part_distance.h"
#include "geometry/parts.h"
#include "spheres/solid_model.h"
#include "spheres/solids.h"

namespace mneme::test {
namespace {

using internal::TriangleMesh;

/// A surface by the questions that SolidModel has for it.
struct Surface {
  explicit Surface(const TriangleMesh& triangles)
      : mesh{{}, std::make_shared<const Parts<Triangle>>(triangles), 0},
        grid(triangles, false),
        winding_grid(triangles, true),
        is_closed(internal::is_closed(triangles)) {}
  [[nodiscard]] double distance(const Vec3& p) const {
    return internal::nearest_part(mesh, p, p).distance;
  }
  /// By a grid per direction, and by a search of the tree of triangles: the same answer.
  [[nodiscard]] bool is_enclosed(const Vec3& p) const {
    const bool is_in = grid(p);
    CHECK(is_in == internal::is_enclosed(p, [&](const internal::Line& line) {
            return internal::crossings_of(line, *mesh.parts);
          }));
    if (is_closed) CHECK(winding_grid(p) == is_in);
    return is_in;
  }

  Mesh mesh;
  internal::EnclosureGrid grid, winding_grid;
  bool is_closed;
};

/// The least distance from a point to a fine grid of points of the triangle: an upper bound.
double sampled_distance(const Vec3& point, const Triangle& t) {
  constexpr int kSteps = 60;
  double least = 1e9;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vec3 on = t.a + (t.b - t.a) * i / kSteps + (t.c - t.a) * j / kSteps;
      least = std::min(least, (point - on).norm());
    }
  }
  return least;
}

TEST_SUITE("unit") {
  TEST_CASE("no triangle is nearer than a limit that is not above the distance") {
    const Surface surface(internal::triangulate(make_box({2, 2, 2})));
    const Vec3 point(3, 0, 0);
    CHECK(surface.distance(point) == doctest::Approx(2));
    CHECK(internal::nearest_part(surface.mesh, point, point, 2.5).distance == doctest::Approx(2));
    CHECK(internal::nearest_part(surface.mesh, point, point, 1.5).part == -1);
  }

  TEST_CASE("a triangle without area is as far as its edges") {
    const Surface surface({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}});
    CHECK(surface.distance({1.5, 0, 3}) == doctest::Approx(3));
    CHECK_FALSE(surface.is_enclosed({0.5, 0.1, 0}));
  }

  TEST_CASE("the middle of a tube without caps is enclosed, and what is before its mouth is not") {
    const Surface surface(make_tube(0.1, 1));
    CHECK(surface.is_enclosed({0.01, 0.02, 0.03}));
    CHECK_FALSE(surface.is_enclosed({0.01, 0.02, 0.7}));
    CHECK_FALSE(surface.is_enclosed({0.3, 0, 0}));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("where two closed surfaces overlap is enclosed") {
    const TriangleMesh both = joined(internal::triangulate(make_box({2, 2, 2})),
                                     internal::triangulate(make_box({2, 2, 2}, {1.5, 0, 0})));
    const internal::EnclosureGrid grid(both, internal::is_closed(both));
    for (const double x : {-0.9, 0.0, 0.6, 0.9, 2.4}) CHECK(grid({x, 0.1, 0.2}));
    for (const double x : {-1.1, 2.6}) CHECK_FALSE(grid({x, 0.1, 0.2}));
  }

  TEST_CASE("nothing is enclosed by a sheet") {
    const Surface surface({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    for (const double z : {-0.2, -0.01, 0.01, 0.2}) CHECK_FALSE(surface.is_enclosed({0.3, 0.3, z}));
  }
}

TEST_SUITE("law") {
  TEST_CASE("inside and outside are told apart whichever way the triangles turn") {
    TriangleMesh mesh = internal::triangulate(make_box({2, 1, 0.5}));
    for (std::size_t i = 0; i < mesh.size(); i += 3) std::swap(mesh[i].a, mesh[i].c);
    const Surface surface(mesh);
    Rng rng(3);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = random_point(rng, 1.5);
      const bool is_inside = std::abs(p.x()) < 1 && std::abs(p.y()) < 0.5 && std::abs(p.z()) < 0.25;
      CHECK(surface.is_enclosed(p) == is_inside);
    }
  }

  TEST_CASE("a grid of lines counts as a search of the tree does, in soups of any triangles") {
    Rng rng(4);
    int enclosed = 0;
    for (const double size : {0.05, 0.5, 3.0}) {
      TriangleMesh soup;
      for (int i = 0; i < 300; ++i) {
        const Vec3 corner = random_point(rng, 1);
        soup.push_back(
            {corner, corner + random_point(rng, size), corner + random_point(rng, size)});
      }
      const Surface surface(soup);
      for (int i = 0; i < 500; ++i) enclosed += surface.is_enclosed(random_point(rng, 1.2)) ? 1 : 0;
    }
    CHECK(enclosed > 50);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("distances are those of the nearest of many points on the triangles") {
    Rng rng(7);
    TriangleMesh mesh;
    for (int i = 0; i < 40; ++i) {
      const Vec3 corner = random_point(rng, 1);
      mesh.push_back({corner, corner + random_point(rng, 0.3), corner + random_point(rng, 0.3)});
    }
    const Surface surface(mesh);
    for (int i = 0; i < 60; ++i) {
      const Vec3 point = random_point(rng, 1.5);
      double expected = 1e9;
      for (const Triangle& t : mesh) expected = std::min(expected, sampled_distance(point, t));
      CHECK(surface.distance(point) <= expected + 1e-12);
      CHECK(surface.distance(point) >= expected - 0.01);
    }
  }
}

using internal::SolidModel;

TriangleMesh cube(double size, const Vec3& center = Vec3::Zero()) {
  return internal::triangulate(make_box(Vec3::Constant(size), center));
}

TEST_SUITE("unit") {
  TEST_CASE("where parts overlap, inner walls do not count") {
    const SolidModel solid(joined(cube(0.2), cube(0.2, {0.1, 0, 0})));
    CHECK(solid.contains({0.05, 0.01, 0.02}));
    CHECK(solid.contains({-0.05, 0, 0}));
    CHECK(solid.depth({0.05, 0, 0}) == doctest::Approx(0.1).epsilon(1e-6));
  }

  TEST_CASE("a closed cavity is inside") {
    const SolidModel solid(joined(cube(0.4), cube(0.2)));
    CHECK(solid.contains({0.01, 0.02, 0.03}));
    CHECK(solid.depth({0, 0, 0}) == doctest::Approx(0.2));
  }

  TEST_CASE("a tube without caps is full") {
    const SolidModel solid(make_tube(0.05, 0.4));
    CHECK(solid.contains({0.01, 0.01, 0.05}));
    CHECK_FALSE(solid.contains({0.01, 0.01, 0.26}));
    CHECK_FALSE(solid.contains({0.06, 0, 0}));
  }

  TEST_CASE("a shallow tray is hollow") {
    TriangleMesh tray = internal::triangulate(make_box({0.4, 0.4, 0.1}));
    std::erase_if(tray,
                  [](const Triangle& t) { return t.a.z() > 0 && t.b.z() > 0 && t.c.z() > 0; });
    const SolidModel solid(tray);
    CHECK_FALSE(solid.contains({0, 0, 0.03}));
    CHECK(solid.depth({0, 0, 0}) == doctest::Approx(-0.05));
  }

  TEST_CASE("a single triangle has no inside, but a distance") {
    const SolidModel solid({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    CHECK(solid.inner_voxels().empty());
    CHECK(solid.medial_balls().empty());
    CHECK(solid.depth({0.2, 0.2, 0.3}) == doctest::Approx(-0.3));
  }
}

TEST_SUITE("law") {
  TEST_CASE("depth in a box is the distance to its nearest face, and below zero outside") {
    const Box box = make_box({0.3, 0.2, 0.1}, {0.5, 0, 0});
    const SolidModel solid(internal::triangulate(box));
    Rng rng(11);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random_point(rng, 0.3) + Vec3(0.5, 0, 0);
      const double inside = (box.half_extents - (p - Vec3(0.5, 0, 0)).cwiseAbs()).minCoeff();
      const double expected = inside > 0 ? inside : -distance(p, box);
      CHECK(solid.depth(p) == doctest::Approx(expected).epsilon(1e-6));
    }
  }

  TEST_CASE("voxels fill the volume, and whole ones lie inside altogether") {
    const SolidModel solid(internal::triangulate(make_box({0.3, 0.2, 0.1})));
    const double voxel_volume = std::pow(solid.voxel_size(), 3);
    CHECK(static_cast<double>(solid.inner_voxels().size()) * voxel_volume ==
          doctest::Approx(0.006).epsilon(0.06));
    for (const SolidModel::Voxel& voxel : solid.inner_voxels()) {
      if (voxel.is_whole) CHECK(solid.depth(voxel.center) >= 0.86 * solid.voxel_size());
    }
  }

  TEST_CASE("every ball inside lies, but for the grid, in a medial one") {
    const SolidModel solid(internal::triangulate(make_box({0.3, 0.2, 0.1})));
    const std::vector<Sphere> medial = solid.medial_balls();
    CHECK(medial.size() < solid.inner_voxels().size() / 4);
    for (std::size_t i = 0; i < solid.inner_voxels().size(); i += 50) {
      const Vec3 center = solid.inner_voxels()[i].center;
      const double radius = solid.depth(center);
      CHECK(std::ranges::any_of(medial, [&](const Sphere& ball) {
        return (ball.center - center).norm() + radius <= ball.radius + 2 * solid.voxel_size();
      }));
    }
  }
}

}  // namespace
}  // namespace mneme::test
