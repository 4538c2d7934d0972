// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "geometry/axis_box.h"
#include "spheres/approximate_solid.h"
#include "spheres/solids.h"

#include <limits>

namespace mneme::test {
namespace {

using internal::approximate_solid;
using internal::TriangleMesh;

bool is_round(double value) { return std::abs(value * 1e5 - std::round(value * 1e5)) < 1e-6; }

TEST_SUITE("unit") {
  TEST_CASE("a cube that one sphere approximates well enough gets one") {
    const LinkSpheres made =
        approximate_solid(internal::triangulate(make_box({0.06, 0.06, 0.06})), {0.025, 16});
    REQUIRE(made.spheres.size() == 1);
    CHECK(made.spheres[0].center.norm() < 0.002);
    CHECK(made.spheres[0].radius == doctest::Approx(0.03 * std::sqrt(3.0)).epsilon(0.02));
  }

  TEST_CASE("where the excess needs more spheres than a link may have, it is enlarged") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.3, 0.2, 0.15}));
    const LinkSpheres few = approximate_solid(mesh, {0.02, 3});
    const LinkSpheres more = approximate_solid(mesh, {0.02, 12});
    CHECK(few.spheres.size() <= 3);
    CHECK(more.spheres.size() <= 12);
    CHECK(more.spheres.size() > 3);
    CHECK(few.uncovered == 0);
    CHECK(more.uncovered == 0);
    CHECK(more.mean_excess < few.mean_excess);
  }

  TEST_CASE("sheets, slivers and rods are approximated too") {
    const std::vector<TriangleMesh> meshes = {
        {{{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}}},
        make_tube(0.05, 0.25),
        internal::triangulate(make_box({0.1, 0.001, 0.001})),
    };
    for (const TriangleMesh& mesh : meshes) {
      const LinkSpheres made = approximate_solid(mesh, {0.02, 12});
      CHECK(made.uncovered == 0);
      CHECK(made.spheres.size() <= 12);
      CHECK(made.max_excess < 0.06);
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
      const LinkSpheres made = approximate_solid(mesh, {0.03, 50});
      CHECK(made.uncovered == 0);
      CHECK(internal::uncovered_fraction(internal::sample_surface(mesh, 50000), made.spheres) == 0);
      CHECK(made.max_excess <= 0.03 + 1e-4);
      CHECK(made.mean_excess < 0.7 * made.max_excess);
      const internal::SolidModel solid(mesh);
      const internal::AxisBox bounds = internal::box_around(mesh);
      Rng rng(23);
      int inside = 0;
      for (int i = 0; i < 5000; ++i) {
        const Vec3 share{rng.uniform(), rng.uniform(), rng.uniform()};
        const Vec3 p = bounds.low + share.cwiseProduct(bounds.high - bounds.low);
        if (!solid.contains(p)) continue;
        ++inside;
        CHECK(is_held(p, made.spheres));
      }
      CHECK(inside > 1000);
    }
  }

  TEST_CASE("an approximation asks for interrupts all along, and ends at one") {
    const auto mesh = internal::triangulate(make_box({0.06, 0.05, 0.3}));
    int polls = 0;
    {
      const InterruptScope counting([&] { return ++polls < 0; });
      static_cast<void>(approximate_solid(mesh, {0.02, 12}));
    }
    CHECK(polls > 100);
    for (const int last : {1, polls / 2, polls - 1}) {
      int seen = 0;
      const InterruptScope ending([&] { return ++seen >= last; });
      CHECK_THROWS_AS(static_cast<void>(approximate_solid(mesh, {0.02, 12})), Interrupted);
      CHECK(seen == last);
    }
  }

  TEST_CASE("the same solid gets the same spheres, on round numbers") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.25, 0.1, 0.08}));
    const LinkSpheres first = approximate_solid(mesh, {});
    const LinkSpheres second = approximate_solid(mesh, {});
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
    CHECK(approximate_solid(mesh, {0.02, 200}).spheres.size() >
          approximate_solid(mesh, {0.03, 200}).spheres.size());
  }
}

using internal::Excess;
using internal::SolidModel;

TEST_SUITE("unit") {
  TEST_CASE("what no sphere holds is uncovered") {
    const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}};
    const std::vector<Sphere> spheres = {{{0, 0, 0}, 1}, {{2, 0, 0}, 0.5}};
    CHECK(internal::uncovered_fraction(points, spheres) == doctest::Approx(0.25));
    CHECK(internal::uncovered_fraction(points, {}) == 1);
    CHECK(internal::uncovered_fraction({}, {}) == 0);
  }

  TEST_CASE("the excess of a sphere around a box is that of its farthest point") {
    const SolidModel solid(internal::triangulate(make_box({0.2, 0.2, 0.2})));
    const std::vector<Sphere> sphere = {{{0, 0, 0}, 0.1 * std::sqrt(3.0)}};
    const Excess excess = internal::measure_excess(sphere, solid);
    CHECK(excess.max == doctest::Approx(0.1 * (std::sqrt(3.0) - 1)).epsilon(0.01));
    CHECK(excess.mean > 0.3 * excess.max);
    CHECK(excess.mean < excess.max);
  }

  TEST_CASE("skin that another sphere hides does not count, nor does what is inside") {
    const SolidModel solid(internal::triangulate(make_box({0.2, 0.2, 0.2})));
    const std::vector<Sphere> inside = {{{0, 0, 0}, 0.05}};
    CHECK(internal::measure_excess(inside, solid).max == 0);
    const std::vector<Sphere> hidden = {{{0, 0, 0}, 1}, {{0.3, 0, 0}, 0.1}};
    const std::vector<Sphere> alone = {{{0, 0, 0}, 1}};
    CHECK(internal::measure_excess(hidden, solid).mean ==
          doctest::Approx(internal::measure_excess(alone, solid).mean));
  }
}

TEST_SUITE("law") {
  TEST_CASE("samples lie on the surface, as many on each face as its area asks for") {
    const Box box = make_box({0.4, 0.2, 0.1});
    int on_top = 0;
    const auto points = internal::sample_surface(internal::triangulate(box), 10000);
    for (const Vec3& p : points) {
      CHECK((box.half_extents - p.cwiseAbs()).minCoeff() == doctest::Approx(0));
      on_top += p.z() > 0.05 - 1e-9 ? 1 : 0;
    }
    CHECK(on_top / 10000.0 == doctest::Approx(0.08 / 0.28).epsilon(0.05));
  }

  TEST_CASE("samples near the surface are inside, and no deeper than two voxels") {
    const SolidModel solid(internal::triangulate(Cylinder{{}, 0.1, 0.3}));
    const auto points = internal::sample_near_surface(solid, {});
    CHECK(points.size() > 1000);
    for (const Vec3& p : points) {
      CHECK(solid.depth(p) > 0);
      CHECK(solid.depth(p) < 2 * solid.voxel_size());
    }
  }
}

Link link_of(std::vector<Solid> solids) {
  Link link;
  link.name = "arm";
  link.solids = std::move(solids);
  return link;
}

TEST_SUITE("unit") {
  TEST_CASE("all solids of a link are approximated together, in the link's frame") {
    const TemporaryDirectory files;
    write_file(files / "part.stl", to_binary_stl(internal::triangulate(make_box({0.1, 0.1, 0.1}))));
    const Transform up{Eigen::Matrix3d::Identity(), {0, 0, 0.3}};
    const auto made = require(approximate_link(link_of(
        {make_box({0.1, 0.1, 0.1}), Cylinder{{Eigen::Matrix3d::Identity(), {0.3, 0, 0}}, 0.05, 0.1},
         MeshFile{files / "part.stl", Vec3::Ones(), up}})));
    CHECK(made.link == "arm");
    CHECK(made.uncovered == 0);
    for (const Vec3& p : {Vec3(0.05, 0.05, 0.05), Vec3(0.35, 0, 0.05), Vec3(-0.05, 0.05, 0.35)}) {
      CHECK(is_held(p, made.spheres));
    }
    CHECK_FALSE(is_held({0.15, 0.1, 0.15}, made.spheres));
  }

  TEST_CASE("settings that no spheres can obey are refused") {
    const Link link = link_of({make_box({0.1, 0.1, 0.1})});
    for (const SphereSettings& settings :
         {SphereSettings{0, 5}, SphereSettings{-1, 5}, SphereSettings{0.02, 0},
          SphereSettings{std::numeric_limits<double>::quiet_NaN(), 5},
          SphereSettings{std::numeric_limits<double>::infinity(), 5}}) {
      CHECK(require_error(approximate_link(link, settings)).code == ErrorCode::invalid);
    }
  }

  TEST_CASE("errors of solids are passed on") {
    const Error error =
        require_error(approximate_link(link_of({MeshFile{"/no/such.stl", Vec3::Ones(), {}}})));
    CHECK(contains(error.message, "link 'arm': mesh /no/such.stl"));
  }
}

}  // namespace
}  // namespace mneme::test
