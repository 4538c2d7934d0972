// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/time_barrier.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mneme::test {
namespace {

using internal::BarrierTables;
using internal::PointRows;

/// A spline of `joints` joints with boxes, limits and weights of a Newton step.
struct Step {
  Step(std::size_t joints, std::uint64_t seed) : points(kCount, joints) {
    Rng rng(seed);
    const std::size_t stride = points.stride();
    for (std::size_t j = 0; j < joints; ++j) {
      const double from = rng.uniform(-1, 1), to = rng.uniform(-1, 1);
      for (std::size_t i = 0; i < kCount; ++i) {
        const double t = std::clamp((static_cast<double>(i) - 2) / (kCount - 5), 0.0, 1.0);
        points[i][j] = from + (to - from) * t * t * t * (10 + t * (6 * t - 15));
      }
    }
    lower = upper = points;
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t j = 0; j < stride; ++j) lower[i][j] -= 0.1, upper[i][j] += 0.1;
    }
    for (std::size_t o = 0; o < 3; ++o) {
      limits[o].assign(stride, 1e12);
      weights[o].assign(stride, 0);
      for (std::size_t j = 0; j < joints; ++j) {
        const bool has_none = o == 2 && j == 1;
        if (has_none) continue;
        limits[o][j] = rng.uniform(1, 2) * std::pow(20, o);
        weights[o][j] = 1;
      }
    }
    scratch.resize(internal::kBarrierArrays * kCount * stride);
  }

  double take(Isa isa) {
    const BarrierTables tables{kCount,
                               points.stride(),
                               points[0],
                               lower[0],
                               upper[0],
                               {limits[0].data(), limits[1].data(), limits[2].data()},
                               {weights[0].data(), weights[1].data(), weights[2].data()},
                               scratch.data()};
    return internal::barrier_kernels(isa).newton_step(tables, 1e5, step_s);
  }

  /// Third difference of a joint at `i`, as jerk.
  [[nodiscard]] double jerk(std::size_t i, std::size_t j) const {
    const double* p[4] = {points[i], points[i + 1], points[i + 2], points[i + 3]};
    return (p[3][j] - 3 * p[2][j] + 3 * p[1][j] - p[0][j]) / std::pow(step_s, 3);
  }

  static constexpr std::size_t kCount = 40;
  double step_s = 0.2;
  PointRows points, lower, upper;
  std::array<std::vector<double>, 3> limits, weights;
  std::vector<double> scratch;
};

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("Newton steps agree on all instruction sets, shorten the step and keep limits") {
    for (const std::size_t joints : {1, 3, 7, 8, 9, 17}) {
      CAPTURE(joints);
      std::optional<Step> first;
      for (const Isa isa : available_isas()) {
        CAPTURE(to_string(isa));
        Step step(joints, joints);
        const PointRows before = step.points;
        for (int k = 0; k < 12; ++k) {
          const double share = step.take(isa);
          CHECK(share > 0);
          CHECK(share <= 1);
        }
        CHECK(step.step_s < 0.15);
        for (std::size_t j = 0; j < joints; ++j) {
          for (std::size_t i = 0; i + 3 < Step::kCount; ++i) {
            if (step.weights[2][j] > 0) CHECK(std::abs(step.jerk(i, j)) < step.limits[2][j]);
            const double speed = (step.points[i + 1][j] - step.points[i][j]) / step.step_s;
            CHECK(std::abs(speed) < step.limits[0][j]);
            CHECK(step.points[i][j] > step.lower[i][j]);
            CHECK(step.points[i][j] < step.upper[i][j]);
          }
          for (std::size_t i = 0; i < 3; ++i) {
            CHECK(step.points[i][j] == before[i][j]);
            CHECK(step.points[Step::kCount - 1 - i][j] == before[Step::kCount - 1 - i][j]);
          }
        }
        if (!first) first = step;
        CHECK(step.step_s == doctest::Approx(first->step_s).epsilon(1e-6));
        for (std::size_t i = 0; i < Step::kCount; ++i) {
          CHECK(step.points[i][0] == doctest::Approx(first->points[i][0]).epsilon(1e-5).scale(1));
        }
      }
    }
  }
}

}  // namespace mneme::test
