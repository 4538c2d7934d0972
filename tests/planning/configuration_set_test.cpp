// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "planning/configuration_set.h"
#include "path/waypoints.h"

#include <algorithm>
#include <numeric>

namespace mneme::test {
namespace {

using internal::to_floats;

/// Distances from `q` to all of `set`, by the library's double-precision metric.
std::vector<double> all_distances(const Robot& robot, const internal::ConfigurationSet& set,
                                  const std::vector<float>& q) {
  std::vector<double> result;
  const Configuration from(q.begin(), q.end());
  for (int i = 0; i < set.size(); ++i) {
    const Configuration to(set[i].begin(), set[i].end());
    result.push_back(robot.distance(from, to));
  }
  return result;
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("large sets find the nearest configuration while they grow, and after being cleared") {
    const Robot robot = spatial_arm();
    const internal::JointSpace space(robot);
    internal::ConfigurationSet set(space, Isa::automatic);
    Rng rng(5);
    for (int round = 0; round < 2; ++round) {
      for (int size = 1; size <= 3000; ++size) {
        set.add(to_floats(random_configuration(robot, rng)));
        if (size % 499 != 0) continue;
        const std::vector<float> q = to_floats(random_configuration(robot, rng));
        const std::vector<double> distances = all_distances(robot, set, q);
        const auto [index, squared] = set.nearest(q);
        const double least = *std::min_element(distances.begin(), distances.end());
        CHECK(distances.at(static_cast<std::size_t>(index)) ==
              doctest::Approx(least).epsilon(1e-4));
        CHECK(std::sqrt(squared) == doctest::Approx(least).epsilon(1e-4));
      }
      set.clear();
    }
  }

  TEST_CASE("sets of any size find the nearest configurations in order") {
    for (const Robot& robot : {planar8(), spatial_arm(), gantry(), thick_arm({1})}) {
      const internal::JointSpace space(robot);
      internal::ConfigurationSet set(space, Isa::automatic);
      Rng rng(4);
      for (int size = 1; size <= 70; ++size) {
        set.add(to_floats(random_configuration(robot, rng)));
        INFO(robot.name(), ", size ", size);
        const std::vector<float> q = to_floats(random_configuration(robot, rng));
        const std::vector<double> distances = all_distances(robot, set, q);
        std::vector<double> sorted = distances;
        std::sort(sorted.begin(), sorted.end());
        const auto [index, squared] = set.nearest(q);
        REQUIRE(index < size);
        CHECK(distances[static_cast<std::size_t>(index)] ==
              doctest::Approx(sorted[0]).epsilon(1e-4));
        CHECK(std::sqrt(squared) == doctest::Approx(sorted[0]).epsilon(1e-4));
        set.measure(q);
        for (const int count : {1, 7, 16, 100}) {
          std::vector<int> indices = {-5, 3};
          set.find_nearest(count, indices);
          REQUIRE(static_cast<int>(indices.size()) == std::min(count, size));
          std::vector<int> distinct = indices;
          std::sort(distinct.begin(), distinct.end());
          CHECK(std::unique(distinct.begin(), distinct.end()) == distinct.end());
          for (std::size_t i = 0; i < indices.size(); ++i) {
            const auto found = static_cast<std::size_t>(indices[i]);
            REQUIRE(distances.at(found) == doctest::Approx(sorted[i]).epsilon(1e-4));
          }
        }
        const int divisor = 2 + size % 5;
        double least = 1e9;
        std::vector<int> candidates;
        for (int i = 0; i < size; i += divisor) {
          candidates.push_back(i);
          least = std::min(least, distances[static_cast<std::size_t>(i)]);
        }
        const int found = set.find_nearest_of(candidates);
        REQUIRE(found >= 0);
        CHECK(found % divisor == 0);
        CHECK(distances.at(static_cast<std::size_t>(found)) ==
              doctest::Approx(least).epsilon(1e-4));
        CHECK(set.find_nearest_of({}) == -1);
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("configurations come back as they went in") {
    const Robot robot = planar8();
    const internal::JointSpace space(robot);
    internal::ConfigurationSet set(space, Isa::automatic);
    Rng rng(5);
    std::vector<std::vector<float>> added;
    for (int i = 0; i < 40; ++i) {
      added.push_back(to_floats(random_configuration(robot, rng)));
      CHECK(set.add(added.back()) == i);
    }
    REQUIRE(set.size() == 40);
    for (int i = 0; i < 40; ++i) {
      CHECK(std::ranges::equal(set[i], added[static_cast<std::size_t>(i)]));
      const auto [index, distance] = set.nearest(added[static_cast<std::size_t>(i)]);
      CHECK(index == i);
      CHECK(distance < 1e-4);
    }
  }

  TEST_CASE("equal configurations are found by their lowest index, also beside unused lanes") {
    const Robot robot = thick_arm({1, 1});
    const internal::JointSpace space(robot);
    for (int size = 1; size <= 40; ++size) {
      internal::ConfigurationSet set(space, Isa::automatic);
      const std::vector<float> q = {0.5f, -0.25f};
      for (int i = 0; i < size; ++i) set.add(q);
      CHECK(set.nearest(q).first == 0);
      std::vector<int> indices;
      set.measure(q);
      set.find_nearest(5, indices);
      std::vector<int> expected(static_cast<std::size_t>(std::min(size, 5)));
      std::iota(expected.begin(), expected.end(), 0);
      CHECK(indices == expected);
    }
  }

  TEST_CASE("a cleared set starts anew") {
    const Robot robot = thick_arm({1, 1});
    const internal::JointSpace space(robot);
    internal::ConfigurationSet set(space, Isa::automatic);
    for (int i = 0; i < 20; ++i) set.add(std::vector<float>{0.0f, 0.0f});
    set.clear();
    CHECK(set.size() == 0);
    CHECK(set.add(std::vector<float>{1.0f, 1.0f}) == 0);
    CHECK(set.nearest(std::vector<float>{0.0f, 0.0f}) == std::pair(0, 2.0f));
    std::vector<int> indices;
    set.measure(std::vector<float>{0.0f, 0.0f});
    set.find_nearest(10, indices);
    CHECK(indices == std::vector<int>{0});
  }

  TEST_CASE("queries speak of what was there when it was measured") {
    const Robot robot = thick_arm({1, 1});
    const internal::JointSpace space(robot);
    internal::ConfigurationSet set(space, Isa::automatic);
    set.add(std::vector<float>{1.0f, 1.0f});
    set.measure(std::vector<float>{0.0f, 0.0f});
    set.add(std::vector<float>{0.0f, 0.0f});
    std::vector<int> indices;
    set.find_nearest(10, indices);
    CHECK(indices == std::vector<int>{0});
    CHECK(set.find_nearest_of(std::vector<int>{0}) == 0);
    set.clear();
    set.find_nearest(10, indices);
    CHECK(indices.empty());
  }
}

}  // namespace mneme::test
