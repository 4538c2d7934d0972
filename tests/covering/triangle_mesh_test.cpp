// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/solids.h"
#include "covering/triangle_mesh.h"

namespace mneme::test {
namespace {

using internal::Triangle;
using internal::TriangleMesh;

TEST_SUITE("unit") {
  TEST_CASE("a box has the area of its faces, its corners as bounds and no rim") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.2, 0.4, 0.6}, {1, 2, 3}));
    CHECK(internal::surface_area(mesh) == doctest::Approx(2 * (0.08 + 0.12 + 0.24)));
    CHECK(internal::bounds_of(mesh).low.isApprox(Vec3(0.9, 1.8, 2.7)));
    CHECK(internal::bounds_of(mesh).high.isApprox(Vec3(1.1, 2.2, 3.3)));
    CHECK(internal::is_closed(mesh));
  }

  TEST_CASE("a box follows its pose") {
    Box box = make_box({2, 4, 6});
    box.pose.rotation = rotation_about(Vec3::UnitZ(), std::acos(0.0));
    CHECK(internal::bounds_of(internal::triangulate(box)).high.isApprox(Vec3(2, 1, 3)));
  }

  TEST_CASE("the prism of a cylinder lies outside it and has no rim") {
    const TriangleMesh mesh = internal::triangulate(Cylinder{{}, 0.5, 2});
    CHECK(internal::is_closed(mesh));
    for (const Triangle& t : mesh) {
      for (const Vec3& middle :
           std::array<Vec3, 3>{0.5 * (t.a + t.b), 0.5 * (t.b + t.c), 0.5 * (t.c + t.a)}) {
        if (std::abs(middle.z()) == 1.0) continue;
        CHECK(middle.head<2>().norm() >= 0.5 - 1e-12);
        CHECK(middle.head<2>().norm() < 0.502);
      }
    }
  }

  TEST_CASE("a missing triangle makes a rim, and so does one that is turned over") {
    TriangleMesh mesh = internal::triangulate(make_box({1, 1, 1}));
    std::swap(mesh[3].a, mesh[3].b);
    CHECK_FALSE(internal::is_closed(mesh));
    mesh.erase(mesh.begin() + 3);
    CHECK_FALSE(internal::is_closed(mesh));
  }
}

TEST_SUITE("law") {
  TEST_CASE("subdivision keeps the area and the rims, and leaves no long edge") {
    const TriangleMesh mesh = internal::triangulate(Cylinder{{}, 0.3, 1});
    const TriangleMesh pieces = internal::subdivide(mesh, 0.05);
    CHECK(pieces.size() > mesh.size());
    CHECK(internal::surface_area(pieces) == doctest::Approx(internal::surface_area(mesh)));
    for (const Triangle& t : pieces) {
      CHECK(std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()}) <= 0.05);
    }
  }
}

}  // namespace
}  // namespace mneme::test
