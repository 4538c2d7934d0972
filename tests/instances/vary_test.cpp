// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "support/lifting_arm.h"
#include "support/support.h"

#include <cmath>

namespace mneme::test {
namespace {

Result<Variations> load(const std::string& text) {
  const TemporaryDirectory directory;
  write_file(directory / "v.yaml", text);
  return load_variations(directory / "v.yaml");
}

std::string refusal(const std::string& text) {
  const Error error = require_error(load(text));
  CHECK(error.code == ErrorCode::parse);
  return error.message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file says what varies, by how much and how") {
    const auto loaded = require(load(
        "scene: {position: {uniform: [0.1, 0.2, 0]}, center: [1, 0, 2], scale: {gaussian: 0.1}}\n"
        "obstacles:\n"
        "  can_*: {rpy: {gaussian: [0, 0, 0.3]}, size: {uniform: [0.01, 0.02]}}\n"
        "  ball: {size: {uniform: 0.05}}\n"));
    CHECK(loaded.scene.position.values == std::vector<double>{0.1, 0.2, 0});
    CHECK(!loaded.scene.position.is_gaussian);
    CHECK(loaded.scene.scale.is_gaussian);
    CHECK(loaded.scene.center == Vec3(1, 0, 2));
    REQUIRE(loaded.obstacles.size() == 2);
    CHECK(loaded.obstacles[0].name == "can_*");
    CHECK(loaded.obstacles[0].rpy.is_gaussian);
    CHECK(loaded.obstacles[0].size.values == std::vector<double>{0.01, 0.02});
    CHECK(loaded.obstacles[0].position.values.empty());
    CHECK(loaded.obstacles[1].size.values == std::vector<double>{0.05});
  }

  TEST_CASE("unknown keys are refused by name and line") {
    CHECK(contains(refusal("scene: {}\nobjects: {}\n"), "objects"));
    const std::string message = refusal("obstacles:\n  can: {colour: 1}\n");
    CHECK(contains(message, "v.yaml:2"));
    CHECK(contains(message, "colour"));
    CHECK(contains(refusal("scene: {size: {uniform: 0.1}}"), "size"));
    CHECK(contains(refusal("obstacles: {can: {center: [0, 0, 0]}}"), "center"));
  }

  TEST_CASE("a spread is uniform or gaussian, of numbers that are no less than zero") {
    CHECK(contains(refusal("scene: {position: [1, 2, 3]}"), "position"));
    CHECK(contains(refusal("scene: {position: {uniform: [0, 0, 0], gaussian: [0, 0, 0]}}"),
                   "uniform"));
    CHECK(contains(refusal("scene: {position: {}}"), "uniform"));
    CHECK(contains(refusal("scene: {position: {uniform: [0, -1, 0]}}"), "at least 0"));
    CHECK(contains(refusal("scene: {scale: {uniform: .nan}}"), "number"));
    CHECK(contains(refusal("scene: {scale: {uniform: high}}"), "number"));
  }

  TEST_CASE("wrong counts are refused") {
    CHECK(contains(refusal("scene: {position: {uniform: [0, 1]}}"), "3 numbers"));
    CHECK(contains(refusal("scene: {scale: {uniform: [0.1, 0.1]}}"), "1 number"));
    CHECK(contains(refusal("obstacles: {can: {size: {uniform: [1, 1, 1, 1]}}}"), "1 to 3"));
  }

  TEST_CASE("a missing file is named") {
    const Error error = require_error(load_variations("/nowhere/v.yaml"));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "/nowhere/v.yaml"));
  }
}

namespace {

Scene nominal() {
  return {
      "cell",
      {{"can_1", {Cylinder{{Eigen::Matrix3d::Identity(), {1, 0.2, 0.5}}, 0.05, 0.2}}},
       {"can_2", {Cylinder{{Eigen::Matrix3d::Identity(), {1, -0.2, 0.5}}, 0.05, 0.2}}},
       {"rod", {Capsule{{0, 0, 1}, {0, 0, 1.5}, 0.02}}},
       {"ball", {Sphere{{0.5, 0.5, 0.5}, 0.1}}},
       {"table", {box_at({1, 0, 0.3}, {0.3, 0.4, 0.02}), box_at({1, 0, 0.1}, {0.02, 0.02, 0.1})}}}};
}

Variation of(const std::string& name) {
  Variation variation;
  variation.name = name;
  return variation;
}

Scene varied(const Variations& variations, std::uint64_t seed) {
  Rng rng(seed);
  return require(vary(nominal(), variations, rng));
}

std::string refusal(const Variation& variation) {
  Rng rng(1);
  return require_error(vary(nominal(), {{}, {variation}}, rng)).message;
}

const Cylinder& can(const Scene& scene, std::size_t index = 0) {
  return std::get<Cylinder>(scene.obstacles[index].shapes[0]);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("without variations a scene stays as it is") {
    CHECK(to_yaml(varied({}, 3)) == to_yaml(nominal()));
  }

  TEST_CASE("only what is named varies, and a star names several") {
    Variation cans = of("can_*");
    cans.position = {{0.1, 0, 0.2}, false};
    const Scene scene = varied({{}, {cans}}, 4);
    CHECK(can(scene).pose.translation.x() != 1);
    CHECK(can(scene, 1).pose.translation.x() != can(scene).pose.translation.x());
    CHECK(can(scene).pose.translation.y() == 0.2);
    CHECK(std::get<Sphere>(scene.obstacles[3].shapes[0]).center == Vec3(0.5, 0.5, 0.5));
  }

  TEST_CASE("turning is about the obstacle's middle, and a body stays rigid") {
    Variation table = of("table");
    table.rpy = {{0, 0, 1}, false};
    const Scene scene = varied({{}, {table}}, 5);
    const auto& board = std::get<Box>(scene.obstacles[4].shapes[0]);
    const auto& leg = std::get<Box>(scene.obstacles[4].shapes[1]);
    CHECK((board.pose.translation - Vec3(1, 0, 0.3)).norm() < 1e-12);
    CHECK((leg.pose.translation - Vec3(1, 0, 0.1)).norm() < 1e-12);
    CHECK((board.pose.rotation - leg.pose.rotation).norm() < 1e-12);
    CHECK((board.pose.rotation - Eigen::Matrix3d::Identity()).norm() > 1e-3);
  }

  TEST_CASE("sizes of every shape vary, and stay positive") {
    Variation cans = of("can_1"), rod = of("rod"), ball = of("ball");
    cans.size = {{0.04, 0.3}, false};
    rod.size = {{0.01, 0.2}, true};
    ball.size = {{0.3}, true};
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const Scene scene = varied({{}, {cans, rod, ball}}, seed);
      REQUIRE(can(scene).radius > 0);
      REQUIRE(std::abs(can(scene).radius - 0.05) <= 0.04);
      REQUIRE(can(scene).length > 0);
      const auto& capsule = std::get<Capsule>(scene.obstacles[2].shapes[0]);
      REQUIRE(capsule.radius > 0);
      REQUIRE((0.5 * (capsule.a + capsule.b) - Vec3(0, 0, 1.25)).norm() < 1e-12);
      REQUIRE(std::get<Sphere>(scene.obstacles[3].shapes[0]).radius > 0);
    }
  }

  TEST_CASE("scale changes all lengths of a body about its middle") {
    Variation table = of("table");
    table.scale = {{0.5}, false};
    const Scene scene = varied({{}, {table}}, 6);
    const auto& board = std::get<Box>(scene.obstacles[4].shapes[0]);
    const auto& leg = std::get<Box>(scene.obstacles[4].shapes[1]);
    const double factor = board.half_extents.x() / 0.3;
    CHECK(factor != 1);
    CHECK(board.half_extents.z() == doctest::Approx(0.02 * factor));
    CHECK((board.pose.translation - leg.pose.translation).norm() == doctest::Approx(0.2 * factor));
  }

  TEST_CASE("names that nobody has or that two variations mean, and useless numbers, are refused") {
    CHECK(contains(refusal(of("cup")), "'cup'"));
    Variation wrong = of("ball");
    wrong.size = {{0.1, 0.1}, false};
    CHECK(contains(refusal(wrong), "'ball'"));
    Variation table = of("table");
    table.size = {{0.1, 0.1, 0.1}, false};
    CHECK(contains(refusal(table), "2 shapes"));
    Variation flat = of("ball");
    flat.position = {{0.1, 0.1}, false};
    CHECK(contains(refusal(flat), "'ball': its position has 2 numbers; expected 3"));
    flat.position = {};
    flat.scale = {{0.1, 0.1, 0.1}, true};
    CHECK(contains(refusal(flat), "its scale has 3 numbers; expected 1"));
    Variations whole;
    whole.scene.size = {{0.1}, false};
    Rng rng(1);
    CHECK(contains(require_error(vary(nominal(), whole, rng)).message,
                   "whole scene: it has a 'size'"));
    const Error error = require_error(vary(nominal(), {{}, {of("can_*"), of("can_1")}}, rng));
    CHECK(contains(error.message, "'can_1'"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("the whole scene moves rigidly about its centre") {
    Variations variations;
    variations.scene.position = {{0.1, 0.1, 0.1}, true};
    variations.scene.rpy = {{0.2, 0.2, 1}, true};
    variations.scene.center = Vec3(1, 0, 0.5);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Scene scene = varied(variations, seed);
      const Vec3 a = can(scene).pose.translation, b = can(scene, 1).pose.translation;
      REQUIRE((a - b).norm() == doctest::Approx(0.4));
      REQUIRE((a - std::get<Sphere>(scene.obstacles[3].shapes[0]).center).norm() ==
              doctest::Approx((Vec3(1, 0.2, 0.5) - Vec3(0.5, 0.5, 0.5)).norm()));
    }
  }

  TEST_CASE("draws have the spread that was asked for") {
    Variation uniform = of("can_1"), gaussian = of("can_2");
    uniform.position = {{0.3, 0, 0}, false};
    gaussian.position = {{0.3, 0, 0}, true};
    Rng rng(9);
    double squares_uniform = 0, squares_gaussian = 0, most = 0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      const auto scene = vary(nominal(), {{}, {uniform, gaussian}}, rng);
      const double u = can(*scene).pose.translation.x() - 1;
      const double g = can(*scene, 1).pose.translation.x() - 1;
      most = std::max(most, std::abs(u));
      squares_uniform += u * u;
      squares_gaussian += g * g;
    }
    CHECK(most <= 0.3);
    CHECK(std::sqrt(squares_uniform / kDraws) == doctest::Approx(0.3 / std::sqrt(3)).epsilon(0.05));
    CHECK(std::sqrt(squares_gaussian / kDraws) == doctest::Approx(0.3).epsilon(0.05));
  }

  TEST_CASE("the same seed gives the same scene") {
    Variations variations;
    variations.scene.rpy = {{0.2, 0.2, 1}, true};
    CHECK(to_yaml(varied(variations, 8)) == to_yaml(varied(variations, 8)));
    CHECK(to_yaml(varied(variations, 8)) != to_yaml(varied(variations, 9)));
  }
}

}  // namespace mneme::test
