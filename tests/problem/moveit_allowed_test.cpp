// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_request.h"
#include "problem/small_robots.h"
#include "scene/read_yaml.h"
#include "support/support.h"

namespace mneme::test {
namespace {

using internal::Input;
using internal::MoveitAllowed;

Result<MoveitAllowed> read(const std::string& matrix) {
  return read_yaml("allowed_collision_matrix:\n" + matrix, [](const Input& input) {
    const Robot robot = parse_robot(kLiftUrdf, "lifter.urdf").value();
    return internal::read_moveit_allowed(input, robot, {"cup", "box"});
  });
}

TEST_SUITE("unit") {
  TEST_CASE("pairs of links that may touch are found, once each") {
    const auto allowed = read(
        "  entry_names: [arm, base, finger, cup]\n"
        "  entry_values: [[false, true, false, false], [true, true, false, false],\n"
        "    {enabled: [false, false, true, false]}, [false, false, false, true]]\n");
    REQUIRE_MESSAGE(allowed.has_value(), (allowed ? "" : allowed.error().message));
    CHECK(allowed->pairs == std::vector<std::pair<std::string, std::string>>{{"arm", "base"}});
    CHECK(allowed->warnings.empty());
  }

  TEST_CASE("objects may touch each other, and names that nobody has are left aside") {
    const auto allowed = read(
        "  entry_names: [cup, box, ghost, arm]\n"
        "  entry_values: [[false, true, true, false], [true, false, false, false],\n"
        "    [true, false, false, true], [false, false, true, false]]\n"
        "  default_entry_names: [spirit, arm]\n  default_entry_values: [true, false]\n");
    REQUIRE_MESSAGE(allowed.has_value(), (allowed ? "" : allowed.error().message));
    CHECK(allowed->pairs.empty());
    REQUIRE(allowed->warnings.size() == 1);
    CHECK(allowed->warnings[0] ==
          "f:2: key allowed_collision_matrix: left aside, because there is no such link or object: "
          "ghost, spirit");
  }

  TEST_CASE("a link that may touch an object is refused by name") {
    CHECK(read("  entry_names: [cup, arm]\n  entry_values:\n    - [false, true]\n    - [true, "
               "false]\n")
              .error()
              .message ==
          "f:4: key allowed_collision_matrix.entry_values[0]: object \"cup\" may "
          "touch link \"arm\", which is not supported");
    CHECK(read("  default_entry_names: [cup]\n  default_entry_values: [true]\n").error().message ==
          "f:2: key allowed_collision_matrix.default_entry_names[0]: object \"cup\" may touch "
          "everything, which is not supported");
  }

  TEST_CASE("matrices that are malformed are refused with line and key") {
    CHECK(read("  entry_names: [a, b]\n  entry_values: [[true, true]]\n").error().message ==
          "f:2: key allowed_collision_matrix: expected one row per name, got 1 for 2 names");
    CHECK(
        read("  entry_names: [a]\n  entry_values: [[true, true]]\n").error().message ==
        "f:3: key allowed_collision_matrix.entry_values[0]: expected one value per name, got 2 for "
        "1 names");
    CHECK(read("  entry_names: [a]\n  entry_values: [[1]]\n").error().message ==
          "f:3: key allowed_collision_matrix.entry_values[0][0]: expected true or false, got 1");
    CHECK(read("  entry_names: [a, b]\n  entry_values: [[true, true], [false, true]]\n")
              .error()
              .message ==
          "f:3: key allowed_collision_matrix.entry_values[1]: expected a symmetric "
          "matrix, got two values for a and b");
    CHECK(read("  default_entry_names: [a]\n").error().message ==
          "f:2: key allowed_collision_matrix: expected one default value per name, got 0 for 1 "
          "names");
  }
}

}  // namespace
}  // namespace mneme::test
