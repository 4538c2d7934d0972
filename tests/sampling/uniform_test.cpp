// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sample_rows.h"

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("the seed decides the uniform stream") {
    check_seeds(*make_uniform_sampler(all_kinds()), 3);
  }

  TEST_CASE("streams of one sampler do not disturb each other") {
    const auto sampler = make_uniform_sampler(all_kinds());
    const Samples expected = draw(*sampler, 3, 5, 10);
    const auto first = sampler->start(5), second = sampler->start(5);
    std::vector<float> q(3), other(3);
    for (std::size_t i = 0; i < 10; ++i) {
      first->next(q);
      second->next(other);
      CHECK(q == other);
      CHECK(q[0] == expected.columns[0][i]);
    }
  }

  TEST_CASE("uniform samples say that they are uniform") {
    const auto sampler = make_uniform_sampler(all_kinds());
    for (const SampleSource source : draw(*sampler, 3, 1, 100).sources)
      CHECK(source == kUniformSource);
  }
}

TEST_SUITE("law") {
  TEST_CASE("uniform samples are within the limits") {
    check_limits(*make_uniform_sampler(all_kinds()), all_kinds(), 50000);
    check_limits(*make_uniform_sampler(planar8()), planar8(), 5000);
  }

  TEST_CASE("uniform samples have the moments of a uniform distribution and fill all cells") {
    const Robot robot = all_kinds();
    constexpr int kCount = 200000, kCells = 100;
    const Samples samples = draw(*make_uniform_sampler(robot), 3, 2, kCount);
    for (int j = 0; j < 3; ++j) {
      const auto& column = samples.columns[static_cast<std::size_t>(j)];
      const double lower = robot.group_joint(j).lower, upper = robot.group_joint(j).upper;
      const double deviation = (upper - lower) / std::sqrt(12.0);
      CHECK(std::abs(mean(column) - (lower + upper) / 2) < 5 * deviation / std::sqrt(kCount));
      CHECK(covariance(column, column) == doctest::Approx(deviation * deviation).epsilon(0.01));
      // 99 degrees of freedom: mean 99, standard deviation 14.
      const double chi2 = chi_square(column, lower, upper, kCells);
      CHECK(chi2 > 40);
      CHECK(chi2 < 170);
    }
  }

  TEST_CASE("joints, and samples in succession, are independent of each other") {
    const Samples samples = draw(*make_uniform_sampler(all_kinds()), 3, 3, 100000);
    const auto& [a, b, c] = std::tie(samples.columns[0], samples.columns[1], samples.columns[2]);
    CHECK(std::abs(correlation(a, b)) < 0.015);
    CHECK(std::abs(correlation(b, c)) < 0.015);
    CHECK(std::abs(correlation({a.begin(), a.end() - 1}, {a.begin() + 1, a.end()})) < 0.015);
    CHECK(std::abs(correlation({c.begin(), c.end() - 1}, {a.begin() + 1, a.end()})) < 0.015);
  }

  TEST_CASE("streams of neighbouring seeds are independent of each other") {
    const auto sampler = make_uniform_sampler(all_kinds());
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const Samples first = draw(*sampler, 3, seed, 20000),
                    second = draw(*sampler, 3, seed + 1, 20000);
      CHECK(std::abs(correlation(first.columns[0], second.columns[0])) < 0.035);
    }
  }
}

}  // namespace
}  // namespace mneme::test
