// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sample_rows.h"

#include <array>
#include <set>

namespace mneme::test {
namespace {

/// `value` of a joint as a fraction of its limits.
double fraction(const Robot& robot, int joint, double value) {
  const Joint& j = robot.group_joint(joint);
  return (value - j.lower) / (j.upper - j.lower);
}

/// The largest error, over anchored boxes in the plane of two joints, of the share of samples in a
/// box as an estimate of its area.
double discrepancy(const Robot& robot, const Samples& samples, int first, int second) {
  constexpr int kGrid = 16;
  const auto& a = samples.columns[static_cast<std::size_t>(first)];
  const auto& b = samples.columns[static_cast<std::size_t>(second)];
  double worst = 0;
  for (int x = 1; x <= kGrid; ++x) {
    for (int y = 1; y <= kGrid; ++y) {
      int inside = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        inside +=
            fraction(robot, first, a[i]) * kGrid < x && fraction(robot, second, b[i]) * kGrid < y;
      }
      const double share = inside / static_cast<double>(a.size());
      worst = std::max(worst, std::abs(share - x * y / double{kGrid * kGrid}));
    }
  }
  return worst;
}

/// `x` as a fraction of a turn from -1/2 to 1/2.
double around(double x) { return x - std::round(x); }

TEST_SUITE("unit") {
  TEST_CASE("the seed decides the Halton stream") {
    check_seeds(*make_halton_sampler(all_kinds()), 3);
  }

  TEST_CASE("Halton samples say that they are uniform") {
    const auto sampler = make_halton_sampler(all_kinds());
    for (const SampleSource source : draw(*sampler, 3, 1, 100).sources)
      CHECK(source == kUniformSource);
  }

  TEST_CASE("samples are the Halton points of the first primes, shifted by a constant") {
    const Robot robot = planar8();
    constexpr std::array<int, 8> kPrimes = {2, 3, 5, 7, 11, 13, 17, 19};
    const Samples samples = draw(*make_halton_sampler(robot), 8, 4, 400);
    for (int j = 0; j < 8; ++j) {
      const auto& column = samples.columns[static_cast<std::size_t>(j)];
      const int base = kPrimes[static_cast<std::size_t>(j)];
      double shift = 0;
      for (int i = 1; i <= 400; ++i) {
        double inverse = 0, weight = 1;
        for (int rest = i; rest > 0; rest /= base) inverse += (rest % base) * (weight /= base);
        const double offset = fraction(robot, j, column[static_cast<std::size_t>(i - 1)]) - inverse;
        if (i == 1) shift = offset;
        REQUIRE(std::abs(around(offset - shift)) < 1e-6);
      }
    }
  }

  TEST_CASE("each seed has its own shift of each joint") {
    const Robot robot = planar8();
    const auto sampler = make_halton_sampler(robot);
    std::set<double> shifts;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      for (const auto& column : draw(*sampler, 8, seed, 1).columns) shifts.insert(column[0]);
    }
    CHECK(shifts.size() > 795);
  }
}

TEST_SUITE("law") {
  TEST_CASE("Halton samples are within the limits") {
    check_limits(*make_halton_sampler(all_kinds()), all_kinds(), 50000);
    check_limits(*make_halton_sampler(planar8()), planar8(), 5000);
  }

  TEST_CASE("the first samples over all seeds are uniform, so that none is favoured") {
    const auto sampler = make_halton_sampler(all_kinds());
    std::vector<double> firsts;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
      firsts.push_back(draw(*sampler, 3, seed, 1).columns[1][0]);
    }
    CHECK(chi_square(firsts, -2, 1, 50) < 95);
  }

  TEST_CASE("Halton samples are spread more evenly than random ones") {
    const Robot robot = all_kinds();
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Samples halton = draw(*make_halton_sampler(robot), 3, seed, 1000);
      const Samples random = draw(*make_uniform_sampler(robot), 3, seed, 1000);
      CAPTURE(seed);
      for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
        CHECK(discrepancy(robot, halton, a, b) < 0.5 * discrepancy(robot, random, a, b));
      }
      CHECK(discrepancy(robot, halton, 0, 1) < 0.012);
    }
  }
}

}  // namespace
}  // namespace mneme::test
