// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("problems that came with mneme are found by name") {
    const auto path = find_scene("planar/threaded_b2.yaml");
    REQUIRE(path.has_value());
    CHECK(load_problem(*path).has_value());
  }

  TEST_CASE("an unknown scene is an error that names the directories") {
    for (const char* name : {"planar/no_such.yaml", "planar", ""}) {
      const auto path = find_scene(name);
      REQUIRE_FALSE(path.has_value());
      CHECK(path.error().code == ErrorCode::io);
      CHECK(path.error().message.find("/scenes") != std::string::npos);
    }
  }
}

}  // namespace
}  // namespace mneme
