// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/lengths.h"
#include "support/support.h"

#include <bit>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("lengths have the same bits on all platforms") {
    Rng rng(1);
    std::uint32_t pairs = 0, triples = 0;
    for (int i = 0; i < 100000; ++i) {
      const float x = rng.bell(), y = rng.bell(), z = rng.bell();
      pairs = 31 * pairs + bits_of(length_of(x, y));
      triples = 31 * triples + bits_of(length_of(x, y, z));
      REQUIRE(length_of(x, y, z) == doctest::Approx(std::hypot(double{x}, double{y}, double{z})));
    }
    CHECK(pairs == 2832584620u);
    CHECK(triples == 945164932u);
  }

  TEST_CASE("no length overflows that is a float, and that of nothing is 0") {
    constexpr float kLarge = 0.5f * std::numeric_limits<float>::max();
    CHECK(length_of(kLarge, kLarge) == doctest::Approx(kLarge * std::sqrt(2.0)));
    CHECK(length_of(kLarge, 0, -kLarge) == doctest::Approx(kLarge * std::sqrt(2.0)));
    CHECK(length_of(0, 0) == 0);
    CHECK(length_of(0, 0, 0) == 0);
  }
}

}  // namespace mneme::internal
