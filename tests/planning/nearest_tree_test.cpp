// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "planning/nearest_tree.h"

#include <algorithm>
#include <limits>

namespace mneme::test {
namespace {

std::vector<float> random_point(const Robot& robot, Rng& rng) {
  const Configuration q = random_configuration(robot, rng);
  return {q.begin(), q.end()};
}

double squared_distance(const Robot& robot, const std::vector<float>& a,
                        const std::vector<float>& b) {
  const double distance =
      robot.distance(Configuration(a.begin(), a.end()), Configuration(b.begin(), b.end()));
  return distance * distance;
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("a growing tree finds what a plain loop finds, for joints that wrap and that do not") {
    for (const Isa isa : {Isa::automatic, Isa::scalar}) {
      for (const Robot& robot : {planar8(), spatial_arm(), gantry(), thick_arm({1})}) {
        const internal::JointSpace space(robot);
        internal::NearestTree tree(space, isa);
        Rng rng(7);
        std::vector<std::vector<float>> rows;
        for (int size = 1; size <= 1500; ++size) {
          rows.push_back(random_point(robot, rng));
          tree.add(rows.back());
          REQUIRE(tree.size() == size);
          if (size % 37 != 1) continue;
          INFO(robot.name(), ", size ", size, ", ", to_string(isa));
          const std::vector<float> q = random_point(robot, rng);
          double least = std::numeric_limits<double>::infinity();
          for (const auto& row : rows) least = std::min(least, squared_distance(robot, row, q));
          const auto [index, squared] = tree.nearest(q);
          REQUIRE(index >= 0);
          REQUIRE(index < size);
          CHECK(squared == doctest::Approx(least).epsilon(1e-4).scale(1));
          CHECK(squared_distance(robot, rows[static_cast<std::size_t>(index)], q) ==
                doctest::Approx(least).epsilon(1e-4).scale(1));
        }
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("equal configurations fill leaf after leaf") {
    const Robot robot = thick_arm({1, 1});
    const internal::JointSpace space(robot);
    internal::NearestTree tree(space, Isa::automatic);
    const std::vector<float> same = {0.5f, -0.25f}, other = {0.75f, -0.25f};
    for (int i = 0; i < 5 * internal::kLeafSize; ++i) tree.add(same);
    tree.add(other);
    CHECK(tree.nearest(other).first == 5 * internal::kLeafSize);
    const auto [index, squared] = tree.nearest(same);
    CHECK(index < 5 * internal::kLeafSize);
    CHECK(squared == doctest::Approx(0).scale(1));
  }

  TEST_CASE("a cleared tree knows only what is added afterwards") {
    const Robot robot = thick_arm({1, 1});
    const internal::JointSpace space(robot);
    internal::NearestTree tree(space, Isa::automatic);
    Rng rng(3);
    for (int i = 0; i < 300; ++i) tree.add(random_point(robot, rng));
    tree.clear();
    CHECK(tree.size() == 0);
    tree.add(std::vector<float>{1, 1});
    CHECK(tree.nearest(std::vector<float>{-1, -1}).first == 0);
    CHECK(tree.nearest(std::vector<float>{-1, -1}).second == doctest::Approx(8));
  }
}

}  // namespace mneme::test
