// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

#include "primitive/decomposers.h"

#include <limits>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a decomposer's version carries its name and a number") {
    const auto version = decomposer_version("pairs");
    REQUIRE(version.has_value());
    CHECK(*version == "pairs/1");
    const auto decomposer = internal::find_decomposer("pairs");
    REQUIRE(decomposer.has_value());
    CHECK((*decomposer)->key_size == 6);
  }

  TEST_CASE("an unknown decomposer is refused with the names of those there are") {
    const auto version = decomposer_version("triples");
    REQUIRE(!version.has_value());
    CHECK(version.error().code == ErrorCode::invalid);
    CHECK(version.error().message.find("'triples'") != std::string::npos);
    CHECK(version.error().message.find("pairs") != std::string::npos);
    DecomposeSettings settings;
    settings.decomposer = "triples";
    CHECK(!decompose(planar8(), Scene{}, settings).has_value());
  }

  TEST_CASE("a maximal gap that is no length is refused") {
    for (const double gap : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
      DecomposeSettings settings;
      settings.max_gap = gap;
      const auto result = decompose(planar8(), Scene{}, settings);
      REQUIRE(!result.has_value());
      CHECK(result.error().code == ErrorCode::invalid);
      CHECK(result.error().message.find("max-gap") != std::string::npos);
    }
  }

  TEST_CASE("the name in the settings picks the decomposer") {
    const auto result = decompose(planar8(), make_circle_scene("two", {{3, 1, 0.9}, {3, -1, 0.9}}));
    REQUIRE(result.has_value());
    CHECK(result->size() == 1);
  }
}

}  // namespace mneme::test
