// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

#include "planning/path_conversion.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("values are rounded to the nearest float and widened without change") {
    const std::vector<float> floats = internal::to_floats({0.1, -2.5, 0});
    CHECK(floats == std::vector<float>{0.1f, -2.5f, 0.0f});
    CHECK(internal::to_floats({}).empty());
    const Path path = internal::to_path({floats, {1.0f}});
    REQUIRE(path.size() == 2);
    CHECK(path[0] == Configuration{static_cast<double>(0.1f), -2.5, 0});
    CHECK(path[1] == Configuration{1});
    CHECK(internal::to_path({}).empty());
  }
}

}  // namespace mneme::test
