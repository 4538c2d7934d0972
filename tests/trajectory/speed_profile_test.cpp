// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"
#include "trajectory/dense_profile.h"
#include "trajectory/empty_scene.h"
#include "trajectory/speed_profile.h"
#include "trajectory/trajectory_flaws.h"

namespace mneme::test {
namespace {

/// One joint that slides by `length` metres.
internal::RoundedPath slide(double length) {
  return {{{{0.5}, {1}, {}, length, true}}, {0.5 + length}};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a short way is sped up and slowed down, a long one has a steady part") {
    for (const auto& [length, velocity, acceleration] :
         std::vector<std::array<double, 3>>{{1, 10, 1}, {1, 0.5, 1}, {1e-5, 1, 1}, {50, 2, 0.1}}) {
      const Trajectory motion =
          internal::follow_fastest(slide(length), {{velocity}, {acceleration}});
      const bool is_short = length * acceleration < velocity * velocity;
      const double expected = is_short ? 2 * std::sqrt(length / acceleration)
                                       : length / velocity + velocity / acceleration;
      CAPTURE(expected);
      CHECK(motion.duration_s() == doctest::Approx(expected));
      CHECK(motion.at(expected / 2).position[0] == doctest::Approx(0.5 + length / 2));
      CHECK(motion.at(expected / 2 * (1 - 1e-9)).velocity[0] ==
            doctest::Approx(is_short ? std::sqrt(length * acceleration) : velocity));
    }
  }

  TEST_CASE("a path that stays where it is takes no time") {
    const Trajectory motion = internal::follow_fastest({{}, {1, 2}}, {{1, 1}, {1, 1}});
    CHECK(motion.duration_s() == 0);
    CHECK(motion.at(0).position == Configuration{1, 2});
    CHECK(motion.at(0).velocity == Configuration{0, 0});
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("no motion along the same path is faster by a twentieth") {
    const EmptyScene empty(planar8());
    Rng rng(31);
    double worst = 0;
    for (int i = 0; i < 40; ++i) {
      CAPTURE(i);
      const Path path = random_path(empty.robot(), rng);
      const RateLimits limits = random_limits(empty.robot(), rng);
      const double tolerance = std::pow(10, rng.uniform(-3, 0));
      const auto rounded =
          internal::round_corners(empty.robot(), path, tolerance, &empty.verifier());
      const double duration = internal::follow_fastest(rounded, limits).duration_s();
      if (rounded.curves.empty()) continue;
      const double ratio = duration / dense_duration(rounded, limits, 400);
      CHECK(ratio < 1.05);
      CHECK(ratio > 0.99);
      worst = std::max(worst, ratio);
    }
    MESSAGE("slowest: ", worst);
  }
}

}  // namespace mneme::test
