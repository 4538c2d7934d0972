// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"
#include "planning/nearest_kernels.h"

#include <cmath>
#include <numbers>

namespace mneme::test {
namespace {

constexpr float kTurn = static_cast<float>(2 * std::numbers::pi);

/// Configurations in the blocks that the kernels read.
struct Blocks {
  int joint_count = 0;
  int count = 0;  ///< a multiple of internal::kBlockSize
  std::vector<float> values;
  std::vector<float> periods;

  Blocks(int joint_count_, int block_count)
      : joint_count(joint_count_),
        count(block_count * internal::kBlockSize),
        values(static_cast<std::size_t>((joint_count + 1) * count)),
        periods(static_cast<std::size_t>(joint_count)) {}

  float& at(int index, int joint) {
    const int block = index / internal::kBlockSize, lane = index % internal::kBlockSize;
    return values[static_cast<std::size_t>(
        (block * (joint_count + 1) + joint) * internal::kBlockSize + lane)];
  }
  /// Fills in what the kernels expect behind the joints.
  void measure_norms() {
    for (int i = 0; i < count; ++i) {
      float sum = 0;
      for (int j = 0; j < joint_count; ++j) sum += at(i, j) * at(i, j);
      at(i, joint_count) = 0.5f * sum;
    }
  }
  double squared_distance(int index, const std::vector<float>& q) {
    double sum = 0;
    for (int j = 0; j < joint_count; ++j) {
      const auto i = static_cast<std::size_t>(j);
      double difference = static_cast<double>(at(index, j)) - q[i];
      if (periods[i] > 0) difference = std::remainder(difference, 2 * std::numbers::pi);
      sum += difference * difference;
    }
    return sum;
  }
  std::pair<int, float> nearest(Isa isa, const std::vector<float>& q) const {
    return internal::nearest_kernels(isa).nearest(values.data(), count / internal::kBlockSize,
                                                  joint_count, q.data(), periods.data());
  }
  std::vector<float> distances(Isa isa, const std::vector<float>& q) const {
    std::vector<float> result(static_cast<std::size_t>(count));
    internal::nearest_kernels(isa).distances(values.data(), count / internal::kBlockSize,
                                             joint_count, q.data(), periods.data(), result.data());
    return result;
  }
};

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("kernels of every instruction set find what a plain loop finds") {
    Rng rng(1);
    for (const Isa isa : available_isas()) {
      for (int round = 0; round < 300; ++round) {
        INFO(to_string(isa), ", round ", round);
        Blocks blocks{1 + static_cast<int>(rng.index(12)), 1 + static_cast<int>(rng.index(9))};
        for (float& period : blocks.periods) period = rng.index(2) == 0 ? kTurn : 0;
        const auto value = [&] { return static_cast<float>(rng.uniform(-3.1415, 3.1415)); };
        for (float& entry : blocks.values) entry = value();
        blocks.measure_norms();
        std::vector<float> q(static_cast<std::size_t>(blocks.joint_count));
        for (float& entry : q) entry = value();

        double least = 1e9;
        const std::vector<float> distances = blocks.distances(isa, q);
        for (int i = 0; i < blocks.count; ++i) {
          const double expected = blocks.squared_distance(i, q);
          least = std::min(least, expected);
          REQUIRE(distances[static_cast<std::size_t>(i)] ==
                  doctest::Approx(expected).epsilon(3e-5).scale(1));
        }
        const auto [index, distance] = blocks.nearest(isa, q);
        REQUIRE(index >= 0);
        REQUIRE(index < blocks.count);
        CHECK(distance == doctest::Approx(least).epsilon(3e-5).scale(1));
        CHECK(blocks.squared_distance(index, q) == doctest::Approx(least).epsilon(3e-5).scale(1));
        CHECK(distance == distances[static_cast<std::size_t>(index)]);
      }
    }
  }

  TEST_CASE("the lowest index wins among equals, in whichever lane and block") {
    Rng rng(2);
    for (const Isa isa : available_isas()) {
      for (int round = 0; round < 300; ++round) {
        INFO(to_string(isa), ", round ", round);
        Blocks blocks(3, 6);
        // Multiples of 1/4: their distances are exact, and many of them equal.
        for (float& entry : blocks.values) entry = 0.25f * static_cast<float>(rng.index(5));
        blocks.measure_norms();
        const std::vector<float> q = {0.5f, 0.25f, 1.25f};
        int expected = 0;
        for (int i = 1; i < blocks.count; ++i) {
          if (blocks.squared_distance(i, q) < blocks.squared_distance(expected, q)) expected = i;
        }
        CHECK(blocks.nearest(isa, q).first == expected);
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("joints with a period are near across the jump, the others are not") {
    for (const Isa isa : available_isas()) {
      INFO(to_string(isa));
      Blocks blocks(1, 1);
      for (int i = 0; i < blocks.count; ++i) blocks.at(i, 0) = 0.1f;
      blocks.at(11, 0) = -3.1f;
      blocks.measure_norms();
      const std::vector<float> q = {3.1f};
      CHECK(blocks.nearest(isa, q).first == 0);
      blocks.periods[0] = kTurn;
      CHECK(blocks.nearest(isa, q).first == 11);
      const double across = 2 * std::numbers::pi - 6.2;
      CHECK(blocks.nearest(isa, q).second == doctest::Approx(across * across).epsilon(1e-4));
    }
  }
}

}  // namespace mneme::test
