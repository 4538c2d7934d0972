// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "support/support.h"

namespace mneme::test {
namespace {

Result<Variations> load(const std::string& text) {
  const TemporaryDirectory directory;
  write_file(directory / "v.yaml", text);
  return load_variations(directory / "v.yaml");
}

std::string refusal(const std::string& text) {
  const auto loaded = load(text);
  REQUIRE(!loaded.has_value());
  CHECK(loaded.error().code == ErrorCode::parse);
  return loaded.error().message;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file says what varies, by how much and how") {
    const auto loaded = load(
        "scene: {position: {uniform: [0.1, 0.2, 0]}, center: [1, 0, 2], scale: {gaussian: 0.1}}\n"
        "obstacles:\n"
        "  can_*: {rpy: {gaussian: [0, 0, 0.3]}, size: {uniform: [0.01, 0.02]}}\n"
        "  ball: {size: {uniform: 0.05}}\n");
    REQUIRE_MESSAGE(loaded.has_value(), (loaded ? "" : loaded.error().message));
    CHECK(loaded->scene.position.values == std::vector<double>{0.1, 0.2, 0});
    CHECK(!loaded->scene.position.is_gaussian);
    CHECK(loaded->scene.scale.is_gaussian);
    CHECK(loaded->scene.center == Vec3(1, 0, 2));
    REQUIRE(loaded->obstacles.size() == 2);
    CHECK(loaded->obstacles[0].name == "can_*");
    CHECK(loaded->obstacles[0].rpy.is_gaussian);
    CHECK(loaded->obstacles[0].size.values == std::vector<double>{0.01, 0.02});
    CHECK(loaded->obstacles[0].position.values.empty());
    CHECK(loaded->obstacles[1].size.values == std::vector<double>{0.05});
  }

  TEST_CASE("unknown keys are refused by name and line") {
    CHECK(has(refusal("scene: {}\nobjects: {}\n"), "objects"));
    const std::string message = refusal("obstacles:\n  can: {colour: 1}\n");
    CHECK(has(message, "v.yaml:2"));
    CHECK(has(message, "colour"));
    CHECK(has(refusal("scene: {size: {uniform: 0.1}}"), "size"));
    CHECK(has(refusal("obstacles: {can: {center: [0, 0, 0]}}"), "center"));
  }

  TEST_CASE("a spread is uniform or gaussian, of numbers that are no less than zero") {
    CHECK(has(refusal("scene: {position: [1, 2, 3]}"), "position"));
    CHECK(has(refusal("scene: {position: {uniform: [0, 0, 0], gaussian: [0, 0, 0]}}"), "uniform"));
    CHECK(has(refusal("scene: {position: {}}"), "uniform"));
    CHECK(has(refusal("scene: {position: {uniform: [0, -1, 0]}}"), "at least 0"));
    CHECK(has(refusal("scene: {scale: {uniform: .nan}}"), "number"));
    CHECK(has(refusal("scene: {scale: {uniform: high}}"), "number"));
  }

  TEST_CASE("wrong counts are refused") {
    CHECK(has(refusal("scene: {position: {uniform: [0, 1]}}"), "3 numbers"));
    CHECK(has(refusal("scene: {scale: {uniform: [0.1, 0.1]}}"), "1 number"));
    CHECK(has(refusal("obstacles: {can: {size: {uniform: [1, 1, 1, 1]}}}"), "1 to 3"));
  }

  TEST_CASE("a missing file is named") {
    const auto loaded = load_variations("/nowhere/v.yaml");
    REQUIRE(!loaded.has_value());
    CHECK(loaded.error().code == ErrorCode::io);
    CHECK(has(loaded.error().message, "/nowhere/v.yaml"));
  }
}

}  // namespace mneme::test
