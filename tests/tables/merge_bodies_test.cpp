// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "tables/merge_bodies.h"
#include "tables/shape_groups.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace mneme::test {
namespace {

using internal::Body;

/// The rule by all pairs, again for each merger.
bool merge_closest_of_all(std::vector<Body>& bodies, bool must_merge) {
  const auto volume = [](const Sphere& ball) { return std::pow(ball.radius + 0.15, 3); };
  std::size_t first = 0, second = 0;
  double least = must_merge ? std::numeric_limits<double>::infinity() : 1.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t k = i + 1; k < bodies.size(); ++k) {
      if (bodies[i].frame != bodies[k].frame) continue;
      const double ratio = volume(internal::enclosing_ball(bodies[i].ball, bodies[k].ball)) /
                           (volume(bodies[i].ball) + volume(bodies[k].ball));
      if (!(ratio < least)) continue;
      least = ratio;
      first = i;
      second = k;
    }
  }
  if (second == 0) return false;
  bodies[first].ball = internal::enclosing_ball(bodies[first].ball, bodies[second].ball);
  for (const int link : bodies[second].links) bodies[first].links.push_back(link);
  bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(second));
  return true;
}

/// Bodies at points of a coarse grid, so that many pairs are equally far apart; some are large.
std::vector<Body> random_bodies(int count, int frames, Rng& rng) {
  std::vector<Body> bodies;
  for (int i = 0; i < count; ++i) {
    const auto coordinate = [&] { return 0.1 * static_cast<double>(rng.index(6)); };
    Body body;
    body.frame = static_cast<int>(rng.index(static_cast<std::uint32_t>(frames)));
    body.ball = {{coordinate(), coordinate(), coordinate()}, rng.index(8) == 0 ? 0.5 : 0.05};
    body.links = {i};
    bodies.push_back(body);
  }
  return bodies;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("Bodies are merged as by a look at all pairs, equal ones in their order") {
    Rng rng(5);
    for (int round = 0; round < 300; ++round) {
      CAPTURE(round);
      const int count = 1 + static_cast<int>(rng.index(40));
      std::vector<Body> merged = random_bodies(count, 1 + round % 3, rng);
      std::vector<Body> expected = merged;
      const std::size_t most = round % 2 == 0 ? 100 : 5;
      while (merge_closest_of_all(expected, expected.size() > most)) continue;
      internal::merge_bodies(merged, most);
      REQUIRE(merged.size() == expected.size());
      for (std::size_t i = 0; i < merged.size(); ++i) {
        CHECK(merged[i].links == expected[i].links);
        CHECK(merged[i].ball.center == expected[i].ball.center);
        CHECK(merged[i].ball.radius == expected[i].ball.radius);
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("thousands of bodies in one frame are merged in moments") {
    Rng rng(6);
    std::vector<Body> bodies;
    for (int i = 0; i < 2000; ++i) {
      const auto coordinate = [&] { return rng.uniform(-10.0, 10.0); };
      bodies.push_back({0, {{coordinate(), coordinate(), coordinate()}, 0.05}, {i}});
    }
    internal::merge_bodies(bodies, 100);
    CHECK(bodies.size() <= 100);
    std::size_t links = 0;
    for (const Body& body : bodies) links += body.links.size();
    CHECK(links == 2000);
  }
}

}  // namespace mneme::test
