// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "trajectory/empty_scene.h"
#include "trajectory/rounded_path.h"
#include "trajectory/trajectory_flaws.h"

namespace mneme::test {
namespace {

using internal::Curve;
using internal::round_corners;
using internal::RoundedPath;

int parabolas(const RoundedPath& path) {
  return static_cast<int>(
      std::ranges::count_if(path.curves, [](const Curve& curve) { return !curve.is_straight(); }));
}

int rests(const RoundedPath& path) {
  return static_cast<int>(std::ranges::count(path.curves, true, &Curve::begins_at_rest));
}

double deviation(const Path& path, const Curve& curve) {
  double most = 0;
  for (int i = 0; i <= 20; ++i) {
    Configuration q;
    for (std::size_t j = 0; j < curve.begin.size(); ++j) {
      q.push_back(curve.value(j, curve.length * i / 20));
    }
    most = std::max(most, distance_to(path, q));
  }
  return most;
}

const Path kCorner = {{-1, 0, 1}, {1, 0, 1}, {1, 1, 1}};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a corner is rounded by no more than the tolerance") {
    const EmptyScene empty(gantry());
    for (const double tolerance : {0.001, 0.01, 0.1}) {
      const RoundedPath path = round_corners(empty.robot(), kCorner, tolerance, &empty.verifier());
      REQUIRE(path.curves.size() == 3);
      CHECK(parabolas(path) == 1);
      CHECK(rests(path) == 1);
      const double most = deviation(kCorner, path.curves[1]);
      CHECK(most <= tolerance);
      CHECK(most > 0.5 * tolerance);
    }
  }

  TEST_CASE("a corner takes no more than half of each leg") {
    const EmptyScene empty(gantry());
    const RoundedPath path = round_corners(empty.robot(), kCorner, 10, &empty.verifier());
    REQUIRE(parabolas(path) == 1);
    CHECK(path.curves[0].length == doctest::Approx(1.5));
    CHECK(path.curves[1].length == doctest::Approx(1));
    CHECK(path.curves[2].length == doctest::Approx(0.5));
  }

  TEST_CASE("without a verifier, and without tolerance, it stops at each corner") {
    const EmptyScene empty(gantry());
    for (const auto& path : {round_corners(empty.robot(), kCorner, 0.1, nullptr),
                             round_corners(empty.robot(), kCorner, 0, &empty.verifier())}) {
      CHECK(path.curves.size() == 2);
      CHECK(rests(path) == 2);
    }
  }

  TEST_CASE("a corner that an obstacle fills is rounded less, or not at all") {
    // The ball of 0.1 m passes the post inside of the corner at this distance on both legs.
    const auto rounded = [](double gap) {
      const Vec3 post(1 - 0.101 - gap, 0.101 + gap, 1);
      const World world{"post", gantry(), {"", {make_ball("post", post, 1e-3)}}, {}};
      const CollisionChecker checker = make_checker(world);
      const MotionVerifier verifier(checker);
      return round_corners(world.robot, kCorner, 0.1, &verifier);
    };
    const RoundedPath wide = rounded(0.2), tight = rounded(0.012), closed = rounded(-0.05);
    REQUIRE(parabolas(wide) == 1);
    REQUIRE(parabolas(tight) == 1);
    CHECK(deviation(kCorner, tight.curves[1]) < 0.3 * deviation(kCorner, wide.curves[1]));
    CHECK(parabolas(closed) == 0);
    CHECK(rests(closed) == 2);
  }

  TEST_CASE("an estimate with a verifier slows down at corners that an obstacle fills") {
    const RateLimits limits{{2, 2, 2}, {4, 4, 4}, {40, 40, 40}};
    const EmptyScene empty(gantry());
    const double free_s = estimate_duration(empty.robot(), kCorner, limits);
    CHECK(estimate_duration(empty.robot(), kCorner, limits, &empty.verifier()) == free_s);
    const Vec3 post(1 - 0.102, 0.102, 1);
    const World world{"post", gantry(), {"", {make_ball("post", post, 1e-3)}}, {}};
    const CollisionChecker checker = make_checker(world);
    const MotionVerifier verifier(checker);
    CHECK(estimate_duration(world.robot, kCorner, limits, &verifier) > 1.05 * free_s);
    CHECK(estimate_duration(world.robot, kCorner, limits) == free_s);
  }

  TEST_CASE("waypoints in the same place are one, and both ends stay") {
    const EmptyScene empty(gantry());
    const Path path = {{0, 0, 0}, {0, 0, 0}, {1e-9, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1e-8, 0}};
    const RoundedPath rounded = round_corners(empty.robot(), path, 0.1, &empty.verifier());
    REQUIRE(rounded.curves.size() == 1);
    CHECK(rounded.curves[0].begin == path.front());
    CHECK(distance_to({path.back()}, rounded.end) < 1e-15);
    CHECK(round_corners(empty.robot(), {{1, 1, 1}}, 0.1, nullptr).curves.empty());
    CHECK(round_corners(empty.robot(), {{1, 1, 1}, {1, 1, 1}}, 0.1, nullptr).curves.empty());
  }

  TEST_CASE("continuous joints go the shorter way and do not jump") {
    const EmptyScene empty(planar_arm({1, 1}));
    const RoundedPath rounded =
        round_corners(empty.robot(), {{3, 0}, {-3, 0}, {-2, 1}}, 0.01, &empty.verifier());
    CHECK(rounded.end[0] == doctest::Approx(2 * kPi - 2));
    CHECK(rounded.curves[0].length < 2 * kPi - 6);
  }
}

TEST_SUITE("law") {
  TEST_CASE("curves join with one slope, except where it stops") {
    const EmptyScene empty(planar8());
    Rng rng(3);
    for (int i = 0; i < 100; ++i) {
      CAPTURE(i);
      const Path path = random_path(empty.robot(), rng);
      const RoundedPath rounded = round_corners(empty.robot(), path, 0.1, &empty.verifier());
      for (std::size_t k = 1; k < rounded.curves.size(); ++k) {
        const Curve &before = rounded.curves[k - 1], &after = rounded.curves[k];
        for (std::size_t j = 0; j < before.begin.size(); ++j) {
          CHECK(std::abs(before.value(j, before.length) - after.begin[j]) < 1e-5);
          if (after.begins_at_rest) continue;
          CHECK(std::abs(before.slope(j, before.length) - after.slope(j, 0)) < 1e-8);
        }
      }
    }
  }
}

}  // namespace mneme::test
