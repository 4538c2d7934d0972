// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/time_barrier.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace mneme::test {
namespace {

using internal::BarrierTables;
using internal::PointRows;

/// A spline of `joints` joints with boxes, limits and weights of a Newton step.
struct Step {
  Step(std::size_t joints, std::uint64_t seed, bool has_jerk = true) : points(kCount, joints) {
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
        const bool has_none = o == 2 && (j == 1 || !has_jerk);
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
    return internal::barrier_kernels(isa).newton_step(tables, kWeight, step_s);
  }

  /// Newton's equations of a joint without structure: curvatures and slopes of all barriers by the
  /// points and, in the last row, by the step.
  [[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::VectorXd> equations(std::size_t j) const {
    constexpr double kFactors[3][4] = {{-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(kCount + 1, kCount + 1);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(kCount + 1);
    const auto add = [&](const Eigen::VectorXd& by, double room) {
      slope += by / room;
      curvature += by * by.transpose() / (room * room);
    };
    for (std::size_t o = 0; o < 3; ++o) {
      const auto order = static_cast<double>(o + 1);
      const double limit = limits[o][j] * std::pow(step_s, order);
      for (std::size_t i = 0; i + o + 1 < kCount && weights[o][j] > 0; ++i) {
        Eigen::VectorXd by = Eigen::VectorXd::Zero(kCount + 1);
        double change = 0;
        for (std::size_t k = 0; k <= o + 1; ++k) {
          by[static_cast<Eigen::Index>(i + k)] = kFactors[o][k];
          change += kFactors[o][k] * points[i + k][j];
        }
        by[kCount] = -order / step_s * limit;
        add(by, limit - change);
        by.head(kCount) *= -1;
        add(by, limit + change);
      }
    }
    for (std::size_t i = 3; i + 3 < kCount; ++i) {
      const Eigen::VectorXd by = Eigen::VectorXd::Unit(kCount + 1, static_cast<Eigen::Index>(i));
      add(by, upper[i][j] - points[i][j]);
      add(-by, points[i][j] - lower[i][j]);
    }
    return {curvature, slope};
  }

  /// Third difference of a joint at `i`, as jerk.
  [[nodiscard]] double jerk(std::size_t i, std::size_t j) const {
    const double* p[4] = {points[i], points[i + 1], points[i + 2], points[i + 3]};
    return (p[3][j] - 3 * p[2][j] + 3 * p[1][j] - p[0][j]) / std::pow(step_s, 3);
  }

  static constexpr std::size_t kCount = 40;
  static constexpr double kWeight = 1e5;
  double step_s = 0.2;
  PointRows points, lower, upper;
  std::array<std::vector<double>, 3> limits, weights;
  std::vector<double> scratch;
};

/// The changes of free points of all joints and of the step, at last, that solve the equations.
Eigen::VectorXd dense_step(const Step& step) {
  constexpr Eigen::Index kFree = Step::kCount - 6;
  const auto joints = static_cast<Eigen::Index>(step.points.joint_count());
  const Eigen::Index last = joints * kFree;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(last + 1, last + 1);
  Eigen::VectorXd slopes = Eigen::VectorXd::Zero(last + 1);
  slopes[last] = Step::kWeight;
  for (Eigen::Index j = 0; j < joints; ++j) {
    const auto [curvature, slope] = step.equations(static_cast<std::size_t>(j));
    all.block(j * kFree, j * kFree, kFree, kFree) = curvature.block(3, 3, kFree, kFree);
    all.block(j * kFree, last, kFree, 1) = curvature.block(3, Step::kCount, kFree, 1);
    all.block(last, j * kFree, 1, kFree) = curvature.block(Step::kCount, 3, 1, kFree);
    all(last, last) += curvature(Step::kCount, Step::kCount);
    slopes.segment(j * kFree, kFree) = slope.segment(3, kFree);
    slopes[last] += slope[Step::kCount];
  }
  return all.partialPivLu().solve(-slopes);
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("a Newton step solves the equations of all barriers, of jerk or not") {
    for (const bool has_jerk : {true, false}) {
      CAPTURE(has_jerk);
      for (const Isa isa : available_isas()) {
        CAPTURE(to_string(isa));
        Step step(7, 4, has_jerk);
        for (int k = 0; k < 3; ++k) {
          const Step before = step;
          const Eigen::VectorXd moves = step.take(isa) * dense_step(before);
          const double most = moves.lpNorm<Eigen::Infinity>();
          const double step_move = step.step_s - before.step_s;
          CHECK(step_move == doctest::Approx(moves[moves.size() - 1]).epsilon(1e-7));
          for (std::size_t j = 0, at = 0; j < 7; ++j) {
            for (std::size_t i = 3; i + 3 < Step::kCount; ++i, ++at) {
              const double move = step.points[i][j] - before.points[i][j];
              CHECK(std::abs(move - moves[static_cast<Eigen::Index>(at)]) < 1e-7 * most);
            }
          }
        }
      }
    }
  }

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
