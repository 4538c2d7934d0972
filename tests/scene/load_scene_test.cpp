// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "support/support.h"

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("a scene file is read, and named after the file if it gives no name") {
    const TemporaryDirectory directory;
    write_file(directory / "room.yaml", "circles: {a: [1, 2, 3]}\n");
    const auto scene = load_scene(directory / "room.yaml");
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    CHECK(scene->name == "room");
    CHECK(scene->obstacles.size() == 1);
  }

  TEST_CASE("a file that is missing is an io error") {
    const auto scene = load_scene("/nonexistent.yaml");
    REQUIRE_FALSE(scene.has_value());
    CHECK(scene.error().code == ErrorCode::io);
  }

  TEST_CASE("malformed text is a parse error that names file and line") {
    const auto scene = parse_scene("name: x\ncircles: {a: [1, 2, x]}\n", "dir/s.yaml");
    REQUIRE_FALSE(scene.has_value());
    CHECK(scene.error().code == ErrorCode::parse);
    CHECK(scene.error().message == "dir/s.yaml:2: key circles.a[2]: expected a number, got \"x\"");
  }

  TEST_CASE("bytes that are no text are refused without harm") {
    Rng rng(61);
    for (int i = 0; i < 300; ++i) {
      std::string bytes;
      const std::uint32_t count = rng.index(200);
      for (std::uint32_t j = 0; j < count; ++j) {
        bytes +=
            i % 2 == 0 ? static_cast<char>(rng.index(256)) : "{}[]:-&*!|>'\"#, a1\n"[rng.index(19)];
      }
      INFO("seed 61, case " << i);
      const auto scene = parse_scene(bytes, "noise");
      REQUIRE((scene.has_value() || scene.error().message.rfind("noise:", 0) == 0));
    }
  }
}

}  // namespace
}  // namespace mneme::test
