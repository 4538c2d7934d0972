// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("each path becomes a row with the key of its ends and its waypoints in their order") {
    const Robot robot = planar_arm({1, 1});
    const std::vector<Path> paths = {{{0, 0}, {0.5, 0.25}, {1, 1}}, {{1, -1}, {2, 2}}};
    const std::vector<Experience> rows = learn_whole_paths(robot, paths);
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].sampler.means == std::vector<float>{0, 0, 0.5, 0.25, 1, 1});
    CHECK(rows[1].sampler.means == std::vector<float>{1, -1, 2, 2});
    for (std::size_t i = 0; i < rows.size(); ++i) {
      CHECK(rows[i].sampler.joint_count == 2);
      CHECK(rows[i].sampler.factor_rows.empty());
      CHECK(rows[i].key == make_query_primitive(robot, paths[i].front(), paths[i].back()).key);
    }
  }

  TEST_CASE("no path teaches nothing, nor does one without a configuration") {
    const Robot robot = planar_arm({1, 1});
    CHECK(learn_whole_paths(robot, {}).empty());
    const std::vector<Path> paths = {{}, {{1, -1}, {2, 2}}, {}};
    const std::vector<Experience> rows = learn_whole_paths(robot, paths);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].sampler.means == std::vector<float>{1, -1, 2, 2});
  }
}

}  // namespace mneme::test
