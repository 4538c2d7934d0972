// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/passage_queries.h"
#include "support/lifting_arm.h"

#include <algorithm>

namespace mneme::test {
namespace {

/// Two upright posts in front of lifting_arm().
Scene posts(double half) {
  const auto post = [](const std::string& name, double y) {
    return Obstacle{name, {Cylinder{{Eigen::Matrix3d::Identity(), {0.85, y, 0.8}}, 0.03, 0.4}}};
  };
  return {"posts", {post("a", -0.1 + half), post("b", -0.1 - half)}};
}

CollisionChecker checker_of(const Scene& scene) {
  auto checker = CollisionChecker::make(lifting_arm(), scene);
  REQUIRE(checker.has_value());
  return *checker;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("bodies that touch have no queries") {
    const CollisionChecker checker = checker_of(posts(0.03));
    CHECK(!internal::PassageQueries::make(checker).has_value());
    const CollisionChecker alone = checker_of({"one", {posts(0.1).obstacles[0]}});
    CHECK(!internal::PassageQueries::make(alone).has_value());
  }

  TEST_CASE("there is a stratum per joint that carries a part of the arm, the last one first") {
    const CollisionChecker checker = checker_of(posts(0.09));
    CHECK(internal::PassageQueries::make(checker)->depth_count() == 3);
  }
}

TEST_SUITE("law") {
  TEST_CASE("starts are valid, cover the middle with the part of their depth, and are not clear") {
    const Robot robot = lifting_arm();
    const CollisionChecker checker = checker_of(posts(0.09));
    const auto queries = internal::PassageQueries::make(checker);
    REQUIRE(queries.has_value());
    const Vec3 middle(0.85, -0.1, 0.8);
    Rng rng(76);
    for (int i = 0; i < 20; ++i) {
      const auto start = queries->draw_start(0, {}, rng);
      REQUIRE(start.has_value());
      REQUIRE(!robot.describe_violation(*start, "start").has_value());
      REQUIRE(checker.is_valid(std::span<const double>(*start)));
      REQUIRE(!queries->is_clear(*start));
      const auto poses = robot.link_poses(*start);
      const auto points = internal::body_points(robot);
      REQUIRE(std::ranges::any_of(points, [&](const internal::BodyPoint& point) {
        const Vec3 center = poses[static_cast<std::size_t>(point.link)] * point.center;
        return point.link == 4 && (center - middle).norm() < point.radius;
      }));
    }
  }

  TEST_CASE("the same seed draws the same start") {
    const CollisionChecker checker = checker_of(posts(0.09));
    const auto queries = internal::PassageQueries::make(checker);
    Rng a(77), b(77);
    CHECK(queries->draw_start(0, {}, a) == queries->draw_start(0, {}, b));
  }

  TEST_CASE("an arm that is turned away is clear") {
    const CollisionChecker checker = checker_of(posts(0.09));
    const auto queries = internal::PassageQueries::make(checker);
    CHECK(queries->is_clear(Configuration{0.1, 2.4, 0, 0}));
  }
}

}  // namespace mneme::test
