// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_solid.h"
#include "covering/solids.h"

namespace mneme::test {
namespace {

using internal::cover_solid;
using internal::TriangleMesh;

bool is_round(double value) { return std::abs(value * 1e5 - std::round(value * 1e5)) < 1e-6; }

TEST_SUITE("unit") {
  TEST_CASE("a cube that one sphere covers well enough gets one") {
    const LinkCover cover = cover_solid(internal::triangulate(make_box({0.06, 0.06, 0.06})), {});
    REQUIRE(cover.spheres.size() == 1);
    CHECK(cover.spheres[0].center.norm() < 0.002);
    CHECK(cover.spheres[0].radius == doctest::Approx(0.03 * std::sqrt(3.0)).epsilon(0.02));
  }

  TEST_CASE("where the excess needs more spheres than a link may have, it is enlarged") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.3, 0.2, 0.15}));
    const LinkCover few = cover_solid(mesh, {0.02, 3});
    const LinkCover more = cover_solid(mesh, {0.02, 12});
    CHECK(few.spheres.size() <= 3);
    CHECK(more.spheres.size() <= 12);
    CHECK(more.spheres.size() > 3);
    CHECK(few.uncovered == 0);
    CHECK(more.uncovered == 0);
    CHECK(more.mean_excess < few.mean_excess);
  }

  TEST_CASE("sheets, slivers and rods are covered too") {
    const std::vector<TriangleMesh> meshes = {
        {{{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}}},
        make_tube(0.05, 0.25),
        internal::triangulate(make_box({0.1, 0.001, 0.001})),
    };
    for (const TriangleMesh& mesh : meshes) {
      const LinkCover cover = cover_solid(mesh, {0.02, 12});
      CHECK(cover.uncovered == 0);
      CHECK(cover.spheres.size() <= 12);
      CHECK(cover.max_excess < 0.06);
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("surface and inside lie in the spheres, which stick out by the excess at most") {
    const std::vector<TriangleMesh> meshes = {
        internal::triangulate(make_box({0.25, 0.1, 0.08}, {0.1, 0.2, -0.3})),
        internal::triangulate(Cylinder{{}, 0.06, 0.3}),
        joined(internal::triangulate(make_box({0.2, 0.06, 0.06})),
               internal::triangulate(make_box({0.06, 0.06, 0.2}, {0.07, 0, 0.07}))),
    };
    for (const TriangleMesh& mesh : meshes) {
      const LinkCover cover = cover_solid(mesh, {0.03, 50});
      CHECK(cover.uncovered == 0);
      CHECK(internal::uncovered_fraction(internal::sample_surface(mesh, 50000), cover.spheres) ==
            0);
      CHECK(cover.max_excess <= 0.03 + 1e-4);
      CHECK(cover.mean_excess < 0.7 * cover.max_excess);
      const internal::SolidModel solid(mesh);
      const internal::Bounds bounds = internal::bounds_of(mesh);
      Rng rng(23);
      int inside = 0;
      for (int i = 0; i < 5000; ++i) {
        const Vec3 share(rng.uniform(), rng.uniform(), rng.uniform());
        const Vec3 p = bounds.low + share.cwiseProduct(bounds.high - bounds.low);
        if (!solid.contains(p)) continue;
        ++inside;
        CHECK(is_held(p, cover.spheres));
      }
      CHECK(inside > 1000);
    }
  }

  TEST_CASE("the same solid gets the same spheres, on round numbers") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.25, 0.1, 0.08}));
    const LinkCover first = cover_solid(mesh, {});
    const LinkCover second = cover_solid(mesh, {});
    REQUIRE(first.spheres.size() == second.spheres.size());
    for (std::size_t i = 0; i < first.spheres.size(); ++i) {
      CHECK(first.spheres[i].center == second.spheres[i].center);
      CHECK(first.spheres[i].radius == second.spheres[i].radius);
      CHECK(is_round(first.spheres[i].radius));
      for (const double x : first.spheres[i].center) CHECK(is_round(x));
    }
  }

  TEST_CASE("less excess takes more spheres") {
    const TriangleMesh mesh = internal::triangulate(Cylinder{{}, 0.06, 0.3});
    CHECK(cover_solid(mesh, {0.02, 200}).spheres.size() >
          cover_solid(mesh, {0.03, 200}).spheres.size());
  }
}

}  // namespace
}  // namespace mneme::test
