// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <thread>
#include <vector>

namespace mneme {

TEST_SUITE("unit") {
  TEST_CASE("the generator is xoshiro256++ seeded by splitmix64") {
    // The outputs of splitmix64 for seed 0 are published with it; xoshiro256++ is applied by hand.
    const std::array<std::uint64_t, 4> state{0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4,
                                             0x06C45D188009454F, 0xF88BB8A8724C81EC};
    const std::uint64_t sum = state[0] + state[3];
    CHECK(Rng(0).next() == ((sum << 23) | (sum >> 41)) + state[0]);
  }

  TEST_CASE("the same seed gives the same sequence and another seed another one") {
    Rng a(7), b(7), c(8);
    int different = 0;
    for (int i = 0; i < 1000; ++i) {
      const double x = a.normal();
      CHECK(x == b.normal());
      different += x != c.normal() ? 1 : 0;
    }
    CHECK(different > 990);
  }

  TEST_CASE("a bell is a sum of eight bytes: few values, the same for the same seed") {
    Rng a(7), b(7), bits(7), c(8);
    int different = 0;
    for (int i = 0; i < 1000; ++i) {
      const float x = a.bell();
      CHECK(x == b.bell());
      different += x != c.bell() ? 1 : 0;
      int sum = 0;
      for (std::uint64_t word = bits.next(); word != 0; word >>= 8) sum += word & 255;
      CHECK(x == doctest::Approx((sum - 1020) / 209.0215).epsilon(1e-6));
    }
    CHECK(different > 900);
  }

  TEST_CASE("an index stays below its count and reaches every value") {
    Rng rng(1);
    std::array<int, 7> counts{};
    for (int i = 0; i < 70000; ++i) ++counts.at(rng.index(7));
    for (const int count : counts) CHECK(std::abs(count - 10000) < 500);
    CHECK(rng.index(1) == 0);
  }

  TEST_CASE("derived seeds differ between tasks and between jobs") {
    std::set<std::uint64_t> seeds;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      for (std::uint64_t task = 0; task < 100; ++task) seeds.insert(derive_seed(seed, task));
    }
    CHECK(seeds.size() == 10000);
    CHECK(derive_seed(3, 4) == derive_seed(3, 4));
  }

  TEST_CASE("streams of different threads are independent of each other") {
    std::vector<double> sums(4, 0.0);
    std::vector<std::thread> threads;
    for (double& sum : sums) {
      threads.emplace_back([&sum] {
        Rng rng(5);
        for (int i = 0; i < 10000; ++i) sum += rng.normal();
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const double sum : sums) CHECK(sum == sums[0]);
  }
}

TEST_SUITE("law") {
  TEST_CASE("uniform numbers lie in the interval with its mean and variance") {
    Rng rng(2);
    const int count = 400000;
    double sum = 0, square_sum = 0;
    bool is_inside = true;
    for (int i = 0; i < count; ++i) {
      const double x = rng.uniform(-1, 3);
      is_inside = is_inside && x >= -1 && x < 3;
      sum += x;
      square_sum += (x - 1) * (x - 1);
    }
    CHECK(is_inside);
    CHECK(std::abs(sum / count - 1) < 5 * 2 / std::sqrt(3.0 * count));
    CHECK(square_sum / count == doctest::Approx(4.0 / 3).epsilon(0.01));
  }

  TEST_CASE("normal numbers have the first four moments of the standard normal") {
    Rng rng(3);
    const int count = 1000000;
    std::array<double, 5> moments{};
    for (int i = 0; i < count; ++i) {
      const double x = rng.normal();
      double power = 1;
      for (std::size_t k = 1; k < moments.size(); ++k) moments[k] += (power *= x) / count;
    }
    CHECK(std::abs(moments[1]) < 5e-3);
    CHECK(std::abs(moments[2] - 1) < 7e-3);
    CHECK(std::abs(moments[3]) < 2e-2);
    CHECK(std::abs(moments[4] - 3) < 5e-2);
  }

  TEST_CASE("bells have mean 0 and deviation 1, and the shape of a normal distribution") {
    Rng rng(5);
    const int count = 1000000;
    std::array<double, 5> moments{};
    double most = 0;
    int within = 0;
    for (int i = 0; i < count; ++i) {
      const double x = rng.bell();
      most = std::max(most, std::abs(x));
      within += std::abs(x) < 1 ? 1 : 0;
      double power = 1;
      for (std::size_t k = 1; k < moments.size(); ++k) moments[k] += (power *= x) / count;
    }
    CHECK(std::abs(moments[1]) < 5e-3);
    CHECK(std::abs(moments[2] - 1) < 7e-3);
    CHECK(std::abs(moments[3]) < 2e-2);
    // The excess of a sum of eight uniform numbers: -6 / 5 / 8.
    CHECK(std::abs(moments[4] - 2.85) < 5e-2);
    CHECK(most < 4.9);
    CHECK(most > 3.5);
    CHECK(std::abs(within / static_cast<double>(count) - 0.6827) < 0.01);
  }

  TEST_CASE("normal numbers fill bins as the normal distribution does, tails included") {
    // Bins of 0.25 from -4.5 to 4.5 and one beyond each side; the tail begins at 3.654.
    const int count = 20000000;
    std::array<double, 38> observed{};
    Rng rng(4);
    for (int i = 0; i < count; ++i) {
      const double bin = std::clamp(std::floor((rng.normal() + 4.5) / 0.25) + 1, 0.0, 37.0);
      observed.at(static_cast<std::size_t>(bin)) += 1;
    }
    double chi_square = 0, below = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      const double edge = -4.5 + 0.25 * static_cast<double>(i);
      const double up_to = i == 37 ? 1 : 0.5 * std::erfc(-edge / std::sqrt(2.0));
      const double expected = count * (up_to - below);
      chi_square += (observed[i] - expected) * (observed[i] - expected) / expected;
      below = up_to;
    }
    // 37 degrees of freedom: exceeded with probability 1e-5.
    CHECK(chi_square < 86);
  }
}

}  // namespace mneme
