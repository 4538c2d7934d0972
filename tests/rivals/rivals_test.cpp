// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/arm_cell.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("rivals are no planners: nobody gets one by accident") {
    REQUIRE_FALSE(rivals().empty());
    for (const Rival& rival : rivals()) {
      CHECK(find_rival(rival.name) == &rival);
      CHECK_FALSE(find_planner(rival.name).has_value());
      CHECK_FALSE(rival.summary.empty());
    }
    CHECK(find_rival("rrt_connect") == nullptr);
  }
}

}  // namespace mneme::test
