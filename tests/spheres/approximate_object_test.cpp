// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "spheres/solids.h"
#include "geometry/random_shapes.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

namespace mneme::test {
namespace {

constexpr const char* kArm = R"(<robot name="arm">
  <link name="base"/><link name="tool"/>
  <joint name="turn" type="continuous"><parent link="base"/><child link="tool"/></joint>
</robot>)";

ApproximatedObject require_spheres(AttachedObject object,
                                   const SphereSettings& settings = kObjectSpheres) {
  return require(approximate_object(std::move(object), settings));
}

bool holds(const ApproximatedObject& object, const Vec3& point) {
  return std::ranges::any_of(object.spheres, [&](const Sphere& s) {
    return (point - s.center).norm() <= s.radius + 1e-12;
  });
}

/// Points of the surface of spheres that are farther than `excess` from the solid.
int count_beyond(const ApproximatedObject& object, const Shape& solid, double excess, Rng& rng) {
  int beyond = 0;
  for (const Sphere& s : object.spheres) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 direction = random_pose(rng, 1).rotation.col(0);
      beyond += distance(s.center + s.radius * direction, solid) > excess + 1e-9 ? 1 : 0;
    }
  }
  return beyond;
}

Vec3 random_point_in(const Box& box, Rng& rng) {
  Vec3 p;
  for (int i = 0; i < 3; ++i) p[i] = rng.uniform(-1, 1) * box.half_extents[i];
  return box.pose * p;
}

Vec3 random_point_in(const Cylinder& c, Rng& rng) {
  // Often at the rim.
  const double r = c.radius * std::min(1.0, rng.uniform(0, 1.5)), angle = rng.uniform(-kPi, kPi);
  const double z = c.length / 2 * std::clamp(rng.uniform(-1.5, 1.5), -1.0, 1.0);
  return c.pose * Vec3(r * std::cos(angle), r * std::sin(angle), z);
}

TEST_SUITE("unit") {
  TEST_CASE("spheres and capsules are taken as they are") {
    const Sphere sphere{{1, 2, 3}, 0.1};
    const Capsule capsule{{0, 0, 0}, {0, 0, 1}, 0.2};
    const ApproximatedObject made =
        require_spheres({"two", "hand", {sphere, capsule}, {}, {"thumb"}});
    REQUIRE(made.spheres.size() == 1);
    REQUIRE(made.capsules.size() == 1);
    CHECK(made.spheres[0].radius == 0.1);
    CHECK(made.capsules[0].b == Vec3(0, 0, 1));
    CHECK(made.object.name == "two");
    CHECK(made.object.may_touch == std::vector<std::string>{"thumb"});
  }

  TEST_CASE("a box of a decimetre takes 27 spheres that stick out by 13 mm at most") {
    const ApproximatedObject made =
        require_spheres({"box", "hand", {Box{{}, Vec3::Constant(0.05)}}, {}, {}});
    CHECK(made.spheres.size() == 27);
    Rng rng(1);
    CHECK(count_beyond(made, Box{{}, Vec3::Constant(0.05)}, 0.013, rng) == 0);
  }

  TEST_CASE("of what became spheres the surface is kept, and these come last") {
    const test::TemporaryDirectory directory;
    const std::string path = directory / "cube.stl";
    write_file(path, to_text_stl(internal::triangulate(make_box(Vec3::Constant(0.1)))));
    const Box box{{}, Vec3::Constant(0.05)};
    const Cylinder can{{Eigen::Matrix3d::Identity(), {1, 0, 0}}, 0.03, 0.12};
    const Sphere ball{{0, 1, 0}, 0.2};
    const ApproximatedObject made =
        require_spheres({"all", "hand", {box, ball, can}, {{path, Vec3::Ones(), {}}}, {}});
    REQUIRE(made.approximation.has_value());
    const std::vector<Triangle>& surface = made.approximation->surface.parts->list();
    CHECK(surface.size() ==
          12 + internal::triangulate(can).size() + internal::triangulate(box).size());
    CHECK(made.approximation->sphere_count + 1 == std::ssize(made.spheres));
    CHECK(made.spheres[0] == ball);
    CHECK(made.approximation->excess <= kObjectSpheres.excess);
    CHECK(made.approximation->surface.pose == Transform{});
    CHECK_FALSE(require_spheres({"ball", "hand", {ball}, {}, {}}).approximation.has_value());
  }

  TEST_CASE("large objects have no more spheres than they may") {
    Rng rng(3);
    for (const Shape& shape : {Shape(Box{{}, {1000, 0.01, 2}}), Shape(Cylinder{{}, 3000, 0.1}),
                               Shape(Cylinder{{}, 0.01, 5000}), Shape(Box{{}, {9, 9, 9}})}) {
      const ApproximatedObject made = require_spheres({"large", "hand", {shape}, {}, {}});
      CHECK(made.spheres.size() <= 64);
      CHECK(!made.spheres.empty());
      CHECK(made.approximation->excess > kObjectSpheres.excess);
      CHECK(count_beyond(made, shape, made.approximation->excess, rng) == 0);
    }
  }

  TEST_CASE("meshes are approximated as those of links") {
    const test::TemporaryDirectory directory;
    const std::string path = directory / "cube.stl";
    write_file(path, to_text_stl(internal::triangulate(make_box(Vec3::Constant(0.1)))));
    const ApproximatedObject made =
        require_spheres({"cube", "hand", {}, {{path, Vec3::Ones(), {}}}, {}});
    Rng rng(2);
    for (int i = 0; i < 1000; ++i) {
      CHECK(holds(made, random_point_in(Box{{}, Vec3::Constant(0.05)}, rng)));
    }
    const auto missing =
        approximate_object({"cube", "hand", {}, {{directory / "none.stl", Vec3::Ones(), {}}}, {}});
    REQUIRE(!missing.has_value());
    CHECK(missing.error().message.starts_with("attached object 'cube': "));
    CHECK(contains(missing.error().message, "none.stl"));
  }

  TEST_CASE("triangles are approximated as a mesh file of them") {
    const test::TemporaryDirectory directory;
    const std::string path = directory / "cube.stl";
    const internal::TriangleMesh triangles = internal::triangulate(make_box(Vec3::Constant(0.125)));
    write_file(path, to_text_stl(triangles));
    const Transform pose{Eigen::Matrix3d::Identity(), {0, 0, 0.3}};
    Mesh mesh{pose, std::make_shared<Parts<Triangle>>(triangles), 0};
    const ApproximatedObject made = require_spheres({"cube", "hand", {mesh}, {}, {}});
    const ApproximatedObject of_file =
        require_spheres({"cube", "hand", {}, {{path, Vec3::Ones(), pose}}, {}});
    REQUIRE(made.spheres.size() == of_file.spheres.size());
    for (std::size_t i = 0; i < made.spheres.size(); ++i) {
      CHECK((made.spheres[i].center - of_file.spheres[i].center).norm() < 1e-6);
    }
    CHECK(made.approximation->surface.parts->list().size() == 12);
    mesh.radius = 0.01;
    const Error error = require_error(approximate_object({"cube", "hand", {mesh}, {}, {}}));
    CHECK(contains(error.message, "mesh without a radius"));
  }

  TEST_CASE("objects without shape or size are refused by name") {
    const auto refusal = [](const AttachedObject& object) {
      return require_error(approximate_object(object)).message;
    };
    CHECK(refusal({"cup", "hand", {}}) == "attached object 'cup': it has no shapes");
    const std::string no_size = " has a size that is not positive";
    CHECK(refusal({"cup", "hand", {Sphere{Vec3::Zero(), 0}}}) ==
          "attached object 'cup': its sphere" + no_size);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(refusal({"cup", "hand", {Box{{}, {nan, 1, 1}}}}) ==
          "attached object 'cup': its box" + no_size);
    CHECK(refusal({"cup", "hand", {Box{{}, {-0.1, 0.1, 0.1}}}}) ==
          "attached object 'cup': its box" + no_size);
    CHECK(refusal({"cup", "hand", {Capsule{Vec3::Zero(), Vec3::UnitX(), -0.1}}}) ==
          "attached object 'cup': its capsule" + no_size);
    CHECK(refusal({"cup", "hand", {Sphere{{0, nan, 0}, 0.1}}}) ==
          "attached object 'cup': its sphere is not finite");
    const Transform stretched{2 * Eigen::Matrix3d::Identity(), Vec3::Zero()};
    CHECK(refusal({"cup", "hand", {Cylinder{stretched, 0.1, 0.1}}}) ==
          "attached object 'cup': its cylinder is posed by a matrix that is no rotation");
  }

  TEST_CASE("settings that no spheres can obey are refused") {
    for (const SphereSettings& settings :
         {SphereSettings{0, 64}, SphereSettings{0.02, 0}, SphereSettings{0.02, 64, 0}}) {
      const Error error =
          require_error(approximate_object({"box", "hand", {Box{{}, {0.1, 0.1, 0.1}}}}, settings));
      CHECK(error.code == ErrorCode::invalid);
    }
  }

  TEST_CASE("attach approximates and attaches") {
    const Robot bare = parse_robot(kArm, "arm.urdf").value();
    const auto robot = require(attach(bare, {{"cup", "tool", {Cylinder{{}, 0.03, 0.12}}}}));
    CHECK(robot.links().back().spheres.size() == robot.attached()[0].spheres.size());
    REQUIRE(robot.links().back().approximation.has_value());
    CHECK(robot.links().back().approximation->surface ==
          robot.attached()[0].approximation->surface);
    CHECK(contains(attach(bare, {{"cup", "hand", {Sphere{Vec3::Zero(), 1}}}}).error().message,
                   "'hand'"));
    CHECK(attach(bare, {{"cup", "tool", {}}}).error().message ==
          "attached object 'cup': it has no shapes");
  }
}

TEST_SUITE("law") {
  TEST_CASE("boxes and cylinders lie within their spheres, which stick out by what they may") {
    constexpr std::uint64_t kSeed = 77;
    Rng rng(kSeed);
    for (int i = 0; i < 100; ++i) {
      INFO("seed " << kSeed << ", object " << i);
      const SphereSettings settings{.excess = rng.uniform(0.006, 0.05), .max_spheres = 1000};
      // So large that these are enough.
      const double size = std::min(1.0, settings.excess / 0.016);
      Box box{random_pose(rng, 0.2), {}};
      for (int k = 0; k < 3; ++k) box.half_extents[k] = rng.uniform(0.001, 0.12 * size);
      const Cylinder can{random_pose(rng, 0.2), rng.uniform(0.002, 0.12 * size),
                         rng.uniform(0.002, 0.3 * size)};
      const ApproximatedObject boxes = require_spheres({"box", "hand", {box}, {}, {}}, settings);
      const ApproximatedObject cans = require_spheres({"can", "hand", {can}, {}, {}}, settings);
      for (int k = 0; k < 100; ++k) {
        REQUIRE(holds(boxes, random_point_in(box, rng)));
        REQUIRE(holds(cans, random_point_in(can, rng)));
      }
      CHECK(count_beyond(boxes, box, settings.excess, rng) == 0);
      CHECK(count_beyond(cans, can, settings.excess, rng) == 0);
    }
  }
}

}  // namespace
}  // namespace mneme::test
