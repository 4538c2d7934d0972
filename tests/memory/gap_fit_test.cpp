// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"
#include "support/threaded.h"
#include "memory/gap_fit.h"

#include <numbers>

namespace mneme::test {
namespace {

using internal::find_gap_crossing;
using internal::gap_segment;
using internal::GapCrossing;
using internal::GapFit;
using internal::GapSegment;
using internal::PlanarChain;
using internal::Vec2;

PlanarChain eight_links() { return PlanarChain::make(planar8()).value(); }

double gap_width(const GapSegment& gap) { return (gap.b - gap.a).norm(); }

/// -1, 0 or 1: where the second of the two links before `link` turns.
int elbow_side(std::span<const double> q, int link) {
  const double sine = std::sin(q[static_cast<std::size_t>(link - 1)]);
  return (sine > 0) - (sine < 0);
}

/// Gaps, and arms of planar8 that are threaded through them from link `link` on.
struct ThreadedArm {
  PrimitiveKey pair;
  Configuration q;
};
std::vector<ThreadedArm> threaded_arms(int link, int count) {
  const Robot robot = planar8();
  Rng rng(static_cast<std::uint64_t>(link) + 1);
  std::vector<ThreadedArm> arms;
  for (std::uint64_t seed = 0; static_cast<int>(arms.size()) < count; ++seed) {
    const PrimitiveKey pair = random_keys(1, seed).front();
    const CollisionChecker checker = make_checker(robot, make_scene(pair));
    if (const auto q = sample_threaded(checker, pair, link, 20, rng)) arms.push_back({pair, *q});
  }
  return arms;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("the crossing link is the first one that crosses, and lies where it says") {
    const PlanarChain chain = eight_links();
    for (int link = 0; link < 8; ++link) {
      for (const auto& [pair, q] : threaded_arms(link, 10)) {
        const GapSegment gap = gap_segment(pair);
        const GapCrossing crossing = find_gap_crossing(chain, gap, q);
        REQUIRE(crossing.link == link);
        CHECK(crossing.link == first_crossing_link(planar8(), pair, q));
        CHECK(crossing.entry >= 0);
        CHECK(crossing.entry <= chain.length(link));
        CHECK(std::abs(crossing.tilt) <= std::numbers::pi / 2);
        std::vector<Vec2> points;
        chain.points(q, points);
        const auto i = static_cast<std::size_t>(link);
        const Vec2 along = (points[i + 1] - points[i]).normalized();
        const Vec2 at = points[i] + crossing.entry * along;
        CHECK((at - (gap.a + crossing.fraction * (gap.b - gap.a))).norm() < 1e-9);
        const double sine = std::abs(along.dot((gap.b - gap.a).normalized()));
        CHECK(std::abs(std::sin(crossing.tilt)) == doctest::Approx(sine).epsilon(1e-9));
      }
    }
  }

  TEST_CASE("an arm that is fitted to its own gap stays as it is") {
    const PlanarChain chain = eight_links();
    for (int link = 0; link < 8; ++link) {
      for (const auto& [pair, q] : threaded_arms(link, 10)) {
        const GapSegment gap = gap_segment(pair);
        Configuration fitted = q;
        REQUIRE(GapFit(chain, gap, gap).fit(find_gap_crossing(chain, gap, q), fitted));
        for (std::size_t j = 0; j < q.size(); ++j) {
          CHECK(std::abs(std::remainder(fitted[j] - q[j], 2 * std::numbers::pi)) < 1e-6);
        }
      }
    }
  }

  TEST_CASE("an arm that is fitted to another gap crosses it as it crossed the first one") {
    const PlanarChain chain = eight_links();
    int fitted_count = 0;
    for (int link = 0; link < 8; ++link) {
      for (const auto& [pair, q] : threaded_arms(link, 10)) {
        const PrimitiveKey other = keys_near(pair, 1, 0.3, 5).front();
        const GapSegment from = gap_segment(pair), to = gap_segment(other);
        const GapCrossing before = find_gap_crossing(chain, from, q);
        Configuration fitted = q;
        if (!GapFit(chain, from, to).fit(before, fitted)) continue;
        ++fitted_count;
        for (int j = 0; j < 8; ++j) {
          const bool may_change = j == 0 || (j >= link - 2 && j <= link);
          const auto i = static_cast<std::size_t>(j);
          if (!may_change) CHECK(fitted[i] == q[i]);
        }
        if (link >= 2) CHECK(elbow_side(fitted, link) == elbow_side(q, link));
        const GapCrossing after = find_gap_crossing(chain, to, fitted);
        // A leading link may meet the other gap: the checker drops what is then in contact.
        if (after.link != link) continue;
        CHECK(after.fraction == doctest::Approx(before.fraction).epsilon(1e-6));
        if (link >= 1) CHECK(after.entry == doctest::Approx(before.entry).epsilon(1e-6));
        const double scale = std::min(1.0, std::sqrt(gap_width(to) / gap_width(from)));
        if (link >= 2) CHECK(std::abs(after.tilt - scale * before.tilt) < 1e-6);
      }
    }
    CHECK(fitted_count > 60);
  }

  TEST_CASE("fitted arms are free of contact where arms that are only moved meet the circles") {
    const Robot robot = planar8();
    const PlanarChain chain = eight_links();
    int moved_free = 0, fitted_free = 0;
    for (int link = 2; link < 8; ++link) {
      for (const auto& [pair, q] : threaded_arms(link, 10)) {
        const PrimitiveKey other = keys_near(pair, 1, 0.3, 5).front();
        const CollisionChecker checker = make_checker(robot, make_scene(other));
        moved_free += checker.is_valid(std::span<const double>(q)) ? 1 : 0;
        const GapSegment from = gap_segment(pair);
        Configuration fitted = q;
        if (!GapFit(chain, from, gap_segment(other)).fit(find_gap_crossing(chain, from, q), fitted))
          continue;
        fitted_free += checker.is_valid(std::span<const double>(fitted)) ? 1 : 0;
      }
    }
    CAPTURE(moved_free);
    CHECK(fitted_free > 2 * moved_free);
    CHECK(fitted_free > 25);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("an arm that crosses nowhere has no crossing") {
    const GapSegment far{Vec2(0, 20), Vec2(0, 21)};
    CHECK(find_gap_crossing(eight_links(), far, Configuration(8, 0.0)).link == -1);
  }

  TEST_CASE("a gap that is out of reach cannot be fitted to") {
    const PlanarChain chain = eight_links();
    for (const int link : {0, 1, 2, 7}) {
      const auto [pair, q] = threaded_arms(link, 1).front();
      const GapSegment from = gap_segment(pair);
      const GapSegment to{from.a + Vec2(30, 0), from.b + Vec2(30, 0)};
      Configuration fitted = q;
      CHECK(!GapFit(chain, from, to).fit(find_gap_crossing(chain, from, q), fitted));
    }
  }

  TEST_CASE("the tilt is kept in a wider gap and shrinks in a narrower one") {
    // Straight along x, then the last link tilted by 0.2 through a gap across the x axis.
    const PlanarChain chain = PlanarChain::make(planar_arm({1, 1, 1})).value();
    const Configuration q = {0.3, -0.6, 0.5};
    std::vector<Vec2> points;
    chain.points(q, points);
    const Vec2 middle = (points[2] + points[3]) / 2;
    const auto gap_of = [&](double width) {
      return GapSegment{middle - Vec2(0, width / 2), middle + Vec2(0, width / 2)};
    };
    const GapCrossing crossing = find_gap_crossing(chain, gap_of(0.4), q);
    REQUIRE(crossing.link == 2);
    CHECK(crossing.tilt == doctest::Approx(0.2));
    CHECK(crossing.fraction == doctest::Approx(0.5));
    CHECK(crossing.entry == doctest::Approx(0.5));
    for (const auto& [width, tilt] :
         std::vector<std::pair<double, double>>{{0.8, 0.2}, {0.1, 0.1}}) {
      Configuration fitted = q;
      REQUIRE(GapFit(chain, gap_of(0.4), gap_of(width)).fit(crossing, fitted));
      CHECK(fitted[0] + fitted[1] + fitted[2] == doctest::Approx(tilt));
    }
  }
}

}  // namespace mneme::test
