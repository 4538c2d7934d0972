// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/box_surface.h"
#include "geometry/random_compounds.h"
#include "memory/random_pairs.h"
#include "support/kinds.h"
#include "support/lifting_arm.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::test {
namespace {

using BodyKey = std::array<double, kBodyKeySize>;

/// The numbers of an obstacle in the key of a pair that no joint of the robot turns or lifts.
BodyKey body_key(const Obstacle& obstacle) {
  const PrimitiveKey pair = make_body_primitive({}, obstacle, {"", {Sphere{}}}).key;
  BodyKey key;
  std::copy_n(pair.begin(), key.size(), key.begin());
  return key;
}

double key_distance(const BodyKey& a, const BodyKey& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

Obstacle random_obstacle(Rng& rng) {
  Obstacle obstacle{"random", {}};
  const int count = 1 + static_cast<int>(rng.index(3));
  for (int i = 0; i < count; ++i) {
    obstacle.shapes.push_back(random_shape(static_cast<int>(rng.index(kShapeKinds)), rng));
  }
  return obstacle;
}

Box random_box(Rng& rng) { return std::get<Box>(random_shape(1, rng)); }

std::vector<LocalPrimitive> body_pairs(const Robot& robot, const Scene& scene,
                                       std::optional<double> max_gap = {}) {
  return require(decompose({robot, scene}, {{}, max_gap}));
}

/// Centroid and S of one shape, from points drawn uniformly within it.
BodyKey sampled_key(const Shape& shape, int count, Rng& rng) {
  const Sphere around = bounding_sphere(shape);
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (int found = 0; found < count;) {
    const Vec3 p = random_vector(rng, around.radius);
    if (distance(Vec3(around.center + p), shape) > 0) continue;
    ++found;
    sum += p;
    squares += p * p.transpose();
  }
  const Vec3 mean = sum / count;
  const Eigen::Matrix3d covariance = 3 * (squares / count - mean * mean.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Matrix3d s = solver.operatorSqrt();
  const Vec3 c = around.center + mean;
  const double twice = std::numbers::sqrt2;
  return {c.x(),   c.y(),           c.z(),           s(0, 0),        s(1, 1),
          s(2, 2), twice * s(0, 1), twice * s(0, 2), twice * s(1, 2)};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a pair of meshes or of clouds has nearly the key of the boxes that they show") {
    const Robot robot = lifting_arm();
    Rng rng(31);
    for (int round = 0; round < 20; ++round) {
      Scene boxes{"boxes", {}}, meshes{"meshes", {}}, clouds{"clouds", {}};
      for (const double side : {-0.3, 0.3}) {
        Box box{random_pose(rng, 0.05), {0.1, 0.1, rng.uniform(0.02, 0.2)}};
        box.pose.translation.x() += side;
        boxes.obstacles.push_back({"box", {box}});
        meshes.obstacles.push_back({"mesh", {compound_of(surface_of(box))}});
        std::vector<CloudPoint> points;
        for (int i = 0; i < 5000; ++i) {
          Vec3 p = Vec3::NullaryExpr([&] { return rng.uniform(-1, 1); });
          p[i % 3] = i % 2 == 0 ? 1 : -1;
          const Eigen::Vector3f at = (box.pose * p.cwiseProduct(box.half_extents)).cast<float>();
          points.push_back({at.x(), at.y(), at.z()});
        }
        clouds.obstacles.push_back({"cloud", {compound_of(std::move(points), 1e-4)}});
      }
      const auto expected = body_pairs(robot, boxes, 1.0);
      REQUIRE(expected.size() == 1);
      for (const Scene& scene : {meshes, clouds}) {
        CAPTURE(scene.name);
        const auto pairs = body_pairs(robot, scene, 1.0);
        REQUIRE(pairs.size() == 1);
        CHECK(largest_difference(pairs[0].key, expected[0].key) < 0.02);
      }
    }
  }

  TEST_CASE("a key holds the centroid and the half sizes, as far as a shape has them") {
    const double r3 = std::sqrt(3.0) / 2, r5 = std::sqrt(0.6);
    CHECK(largest_difference(body_key({"", {box_at({1, 2, 3}, {0.1, 0.2, 0.3})}}),
                             BodyKey{1, 2, 3, 0.1, 0.2, 0.3, 0, 0, 0}) < 1e-12);
    Cylinder cylinder{{}, 0.2, 0.8};
    cylinder.pose.translation = Vec3(1, 0, -1);
    CHECK(largest_difference(body_key({"", {cylinder}}),
                             BodyKey{1, 0, -1, 0.2 * r3, 0.2 * r3, 0.4, 0, 0, 0}) < 1e-12);
    CHECK(largest_difference(body_key({"", {Sphere{{0, 1, 0}, 0.5}}}),
                             BodyKey{0, 1, 0, 0.5 * r5, 0.5 * r5, 0.5 * r5, 0, 0, 0}) < 1e-12);
  }

  TEST_CASE("meshes without thickness have places and sizes, and count by their areas") {
    const auto sheet = [](const Vec3& corner, double width, double height) {
      const Vec3 across(0, width, 0), up(0, 0, height);
      return Shape(
          compound_of(std::vector<Triangle>{{corner, corner + across, corner + up},
                                            {corner + across + up, corner + up, corner + across}}));
    };
    const Obstacle one{"", {sheet({1, 2, 3}, 0.2, 0.4)}};
    CHECK(largest_difference(body_key(one), BodyKey{1, 2.1, 3.2, 0, 0.1, 0.2, 0, 0, 0}) < 1e-6);
    const Obstacle two{"", {sheet({1, 2, 3}, 0.2, 0.1), sheet({1, 2, 3.1}, 0.2, 0.3)}};
    CHECK(largest_difference(body_key(one), body_key(two)) < 1e-6);
    const Robot robot = lifting_arm();
    const auto keys_at = [&](double x) {
      return body_pairs(
          robot,
          {"", {{"a", {sheet({x, 0, 0}, 0.2, 0.4)}}, {"b", {sheet({x, 0.3, 0}, 0.2, 0.4)}}}});
    };
    CHECK(largest_difference(keys_at(0.5).at(0).key, keys_at(0.9).at(0).key) ==
          doctest::Approx(0.4).epsilon(0.1));
  }

  TEST_CASE("a box that stands askew has numbers off the diagonal") {
    Box box = box_at(Vec3::Zero(), {0.3, 0.1, 0.2});
    box.pose.rotation = rotation_about(Vec3::UnitZ(), std::numbers::pi / 4);
    CHECK(largest_difference(body_key({"", {box}}),
                             BodyKey{0, 0, 0, 0.2, 0.2, 0.2, 0.1 * std::numbers::sqrt2, 0, 0}) <
          1e-12);
  }

  TEST_CASE("a capsule has the same key from either end, and none of its ends need differ") {
    const Capsule capsule{{1, 0, 0}, {2, 1, 1}, 0.2};
    CHECK(largest_difference(body_key({"", {capsule}}),
                             body_key({"", {Capsule{capsule.b, capsule.a, 0.2}}})) < 1e-12);
    const Capsule ball{{1, 0, 0}, {1, 0, 0}, 0.2};
    for (const double value : body_key({"", {ball}})) CHECK(std::isfinite(value));
    const Capsule down{{0, 0, 1}, {0, 0, -1}, 0.2};
    for (const double value : body_key({"", {down}})) CHECK(std::isfinite(value));
  }

  TEST_CASE("every pair of obstacles that are close enough is a primitive, in scene order") {
    const Cylinder tin{{Eigen::Matrix3d::Identity(), {1, 0, 0.2}}, 0.05, 0.2};
    const Scene scene{"",
                      {{"a", {box_at({1, 0, 0}, {0.1, 0.1, 0.1})}},
                       {"far", {box_at({5, 0, 0}, {0.1, 0.1, 0.1})}},
                       {"b", {Sphere{{1, 0.5, 0}, 0.2}}},
                       {"c", {tin}}}};
    const auto primitives = body_pairs(lifting_arm(), scene, 0.25);
    REQUIRE(primitives.size() == 2);
    CHECK(primitives[0].obstacles == std::vector<int>{0, 2});
    CHECK(primitives[0].gap == doctest::Approx(0.2));
    CHECK(primitives[1].obstacles == std::vector<int>{0, 3});
    CHECK(primitives[1].gap == 0);
    CHECK(body_pairs(lifting_arm(), scene, 10).size() == 6);
    CHECK(body_pairs(lifting_arm(), {}).empty());
  }

  TEST_CASE("without a gap in the settings a quarter of a metre is the most") {
    const auto boxes = [](double gap) {
      return Scene{"",
                   {{"a", {box_at({1, 0, 0}, {0.1, 0.1, 0.1})}},
                    {"b", {box_at({1.2 + gap, 0, 0}, {0.1, 0.1, 0.1})}}}};
    };
    CHECK(body_pairs(lifting_arm(), boxes(0.249)).size() == 1);
    CHECK(body_pairs(lifting_arm(), boxes(0.251)).empty());
  }

  TEST_CASE("an obstacle of many shapes is one body, and its gap that of the nearest of them") {
    const Obstacle bookcase{
        "bookcase", {box_at({1, 0, 0}, {0.2, 0.5, 0.02}), box_at({1, 0, 1}, {0.2, 0.5, 0.02})}};
    const Obstacle ball{"ball", {Sphere{{1, 0, 0.3}, 0.1}}};
    const auto primitives = body_pairs(lifting_arm(), {"", {bookcase, ball}});
    REQUIRE(primitives.size() == 1);
    CHECK(primitives[0].gap == doctest::Approx(0.18));
    const LocalPrimitive made =
        make_body_primitive(find_symmetric_joints(lifting_arm()), bookcase, ball);
    CHECK(made.gap == doctest::Approx(0.18));
    CHECK(made.key == primitives[0].key);
    CHECK(made.obstacles == std::vector<int>{0, 1});
  }

  TEST_CASE("a key has two images, the second with the obstacles swapped") {
    const SymmetricJoints joints = find_symmetric_joints(lifting_arm());
    const Obstacle a{"a", {box_at({1, 0, 0}, {0.1, 0.2, 0.3})}};
    const Obstacle b{"b", {Sphere{{1, 1, 0.5}, 0.2}}};
    const auto all = kind_named("body_pairs").images(make_body_primitive(joints, a, b).key);
    REQUIRE(all.size() == 2);
    CHECK(all[0].key == make_body_primitive(joints, a, b).key);
    CHECK(all[1].key == make_body_primitive(joints, b, a).key);
    CHECK(!all[1].is_mirrored);
  }

  TEST_CASE("arms in the plane take pairs of bodies only if they are asked to") {
    CHECK(default_memory_kind(planar8()).name == "pairs");
    CHECK(default_memory_kind(lifting_arm()).name == "body_pairs");
    const Robot robot = planar8();
    const Scene scene = make_circle_scene("", {{3, 1, 0.9}, {3, -1, 0.9}});
    const auto result = require(decompose({robot, scene}, of_kind("body_pairs")));
    REQUIRE(result.size() == 1);
    CHECK(result[0].key.size() == 2 * kBodyKeySize);
  }
}

TEST_SUITE("law") {
  TEST_CASE("order and sign of a box's axes do not matter") {
    Rng rng(41);
    for (int i = 0; i < 500; ++i) {
      const Box box = random_box(rng);
      Box renamed = box;
      for (int column = 0; column < 3; ++column) {
        const double sign = rng.index(2) == 0 ? 1 : -1;
        renamed.pose.rotation.col(column) = sign * box.pose.rotation.col((column + i) % 3);
        renamed.half_extents[column] = box.half_extents[(column + i) % 3];
      }
      REQUIRE(largest_difference(body_key({"", {box}}), body_key({"", {renamed}})) < 1e-9);
    }
  }

  TEST_CASE("a box in two parts, wherever it is cut, has the key of the whole") {
    Rng rng(42);
    for (int i = 0; i < 500; ++i) {
      const Box whole = random_box(rng);
      const Vec3 axis = Vec3::Unit(i % 3);
      const double half = whole.half_extents[i % 3], cut = rng.uniform(-half, half);
      const auto part = [&](double from, double to) {
        Box result = whole;
        result.half_extents[i % 3] = 0.5 * (to - from);
        result.pose.translation = whole.pose * Vec3(0.5 * (from + to) * axis);
        return result;
      };
      REQUIRE(largest_difference(body_key({"", {whole}}),
                                 body_key({"", {part(-half, cut), part(cut, half)}})) < 1e-9);
    }
  }

  TEST_CASE("the distance of two obstacles' keys is the same wherever both are moved") {
    Rng rng(43);
    for (int i = 0; i < 500; ++i) {
      const Obstacle a = random_obstacle(rng), b = random_obstacle(rng);
      const Transform X = random_pose(rng, 3.0);
      const double expected = key_distance(body_key(a), body_key(b));
      REQUIRE(key_distance(body_key(moved_obstacle(X, a)), body_key(moved_obstacle(X, b))) ==
              doctest::Approx(expected).epsilon(1e-9));
    }
  }

  TEST_CASE("the key stays when the scene is turned and lifted, and the motion back follows it") {
    const SymmetricJoints joints = find_symmetric_joints(lifting_arm());
    Rng rng(44);
    for (int i = 0; i < 500; ++i) {
      const Obstacle a = random_obstacle(rng), b = random_obstacle(rng);
      const LocalPrimitive here = make_body_primitive(joints, a, b);
      const Symmetry motion{rng.uniform(-3, 3), false, rng.uniform(-1, 1)};
      const Transform X = transform_of(joints, motion);
      const LocalPrimitive there =
          make_body_primitive(joints, moved_obstacle(X, a), moved_obstacle(X, b));
      INFO("seed 44, case ", i);
      REQUIRE(largest_difference(here.key, there.key) < 1e-9);
      const Symmetry expected = compose(motion, here.to_scene);
      REQUIRE(std::abs(std::remainder(there.to_scene.rotation - expected.rotation,
                                      2 * std::numbers::pi)) < 1e-9);
      REQUIRE(there.to_scene.lift == doctest::Approx(expected.lift).epsilon(1e-9));
      REQUIRE(there.gap == doctest::Approx(here.gap).epsilon(1e-3).scale(1));
    }
  }

  TEST_CASE("the middle of a canonical key is on the positive x axis, at the height of the lift") {
    const SymmetricJoints both{1, 0, 0.3, -0.2}, turn{0, -1, 0.3, -0.2}, neither;
    Rng rng(45);
    for (int i = 0; i < 200; ++i) {
      const Obstacle a = random_obstacle(rng), b = random_obstacle(rng);
      const auto middle = [&](const SymmetricJoints& joints) {
        const PrimitiveKey key = make_body_primitive(joints, a, b).key;
        return Vec3(0.5 * (key[0] + key[9]), 0.5 * (key[1] + key[10]), 0.5 * (key[2] + key[11]));
      };
      const Vec3 before = middle(neither);
      const double radius = std::hypot(before.x() - 0.3, before.y() + 0.2);
      REQUIRE((middle(both) - Vec3(radius, 0, 0)).norm() < 1e-12);
      REQUIRE((middle(turn) - Vec3(radius, 0, before.z())).norm() < 1e-12);
    }
  }

  TEST_CASE("swapped obstacles are at error zero, others at the squared distance of their keys") {
    const SymmetricJoints joints = find_symmetric_joints(lifting_arm());
    Rng rng(46);
    for (int i = 0; i < 500; ++i) {
      const Obstacle a = random_obstacle(rng), b = random_obstacle(rng), c = random_obstacle(rng);
      const PrimitiveKey key = make_body_primitive(joints, a, b).key;
      REQUIRE(similarity_error(kind_named("body_pairs"), key,
                               make_body_primitive(joints, b, a).key) < 1e-24);
      const PrimitiveKey other = make_body_primitive(joints, c, a).key;
      double least = 1e300;
      for (const KeyImage& image : kind_named("body_pairs").images(other)) {
        double sum = 0;
        for (std::size_t k = 0; k < key.size(); ++k) sum += std::pow(key[k] - image.key[k], 2);
        least = std::min(least, sum);
      }
      REQUIRE(similarity_error(kind_named("body_pairs"), key, other) ==
              doctest::Approx(least).epsilon(1e-12));
      REQUIRE(similarity_error(kind_named("body_pairs"), other, key) ==
              doctest::Approx(least).epsilon(1e-12));
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("keys are those of points drawn from the shape") {
    Rng rng(47);
    for (int i = 0; i < 12; ++i) {
      const Shape shape = random_shape(i % 3, rng);  // a capsule's key is that of a cylinder
      INFO("seed 47, case ", i, ", ", shape_name(shape));
      const double tolerance = 0.03 * bounding_sphere(shape).radius;
      CHECK(largest_difference(body_key({"", {shape}}), sampled_key(shape, 10000, rng)) <
            tolerance);
    }
  }
}

}  // namespace mneme::test
