// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

double key_distance(const PrimitiveKey& a, const PrimitiveKey& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

PrimitiveKey key_of(const Robot& robot, const Configuration& start, const Configuration& goal) {
  return make_query_primitive(robot, start, goal).key;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the key of a query holds its length and both ends, a continuous joint as a point") {
    const Robot robot = planar_arm({1, 1});
    const PrimitiveKey key = key_of(robot, {0, 1}, {kPi / 2, 2});
    REQUIRE(static_cast<int>(key.size()) == query_key_size(robot));
    const PrimitiveKey expected = {std::sqrt(3.0), 1, 0, 1, 0, 1, 2};
    CHECK(key_distance(key, expected) < 1e-12);
  }

  TEST_CASE("no obstacle belongs to the primitive of a query, and no symmetry moves it") {
    const LocalPrimitive primitive =
        make_query_primitive(planar_arm({1, 1}), std::vector{0.0, 1.0}, std::vector{1.0, 0.0});
    CHECK(primitive.obstacles.empty());
    CHECK(primitive.to_scene.rotation == 0);
    CHECK_FALSE(primitive.to_scene.is_mirrored);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the images of a query's key are its own and that of the reverse query") {
    for (const Robot& robot : {planar8(), planar_arm({1, 1}), upright_arm()}) {
      Rng rng(3);
      for (int i = 0; i < 20; ++i) {
        const Configuration start = random_configuration(robot, rng);
        const Configuration goal = random_configuration(robot, rng);
        const std::vector<KeyImage> found = images(key_of(robot, start, goal));
        REQUIRE(found.size() == 2);
        CHECK(found[0].key == key_of(robot, start, goal));
        CHECK(found[1].key == key_of(robot, goal, start));
        CHECK_FALSE(found[1].is_mirrored);
        CHECK(similarity_error(found[0].key, found[1].key) == 0);
      }
    }
  }

  TEST_CASE("keys of queries are as far apart as their ends, through the seam of a joint too") {
    const Robot robot = planar_arm({1, 1});
    const PrimitiveKey key = key_of(robot, {kPi - 0.01, 1}, {0, 0});
    CHECK(similarity_error(key, key_of(robot, {-kPi + 0.01, 1}, {0, 0})) ==
          doctest::Approx(0.0004).epsilon(0.01));
    CHECK(similarity_error(key, key_of(robot, {kPi - 0.01, 1}, {0, 0.5})) > 0.25);
  }
}

}  // namespace mneme::test
