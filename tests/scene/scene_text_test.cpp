// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "support/support.h"

#include <string>
#include <variant>

namespace mneme {
namespace {

using test::contains;
using test::require;

const std::string kText = R"((shop floor)+
* bench top
0.5 0 0.25
0 0 0.7071067811865476 0.7071067811865476
2
box
0.5 1.5 0.125
0 0 0
0 0 0 1
0 0 0 0
cylinder
0.0625 0.25
1 0 0.5
0 0 0 1
0 0 0 0
1
grip
0 0 0
0 0 0 1
* ball
0 0 0
0 0 0 1
1
sphere
0.125
0.5 -0.25 0.75
0 0 0 1
1 0 0 1
0
.
)";

std::string scene_text_failure(const std::string& text) {
  const auto scene = parse_scene(text, "f.scene");
  return scene ? "" : scene.error().message;
}

std::string replaced_text(const std::string& from, const std::string& to) {
  std::string text = kText;
  const std::size_t at = text.find(from);
  REQUIRE_MESSAGE(at != std::string::npos, from);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a quaternion of zeros is the identity, as in messages of MoveIt") {
    const auto scene = require(parse_scene(
        replaced_text("0 0 0.7071067811865476 0.7071067811865476", "0 0 0 0"), "f.scene"));
    CHECK(std::get<Box>(scene.obstacles[0].shapes[0]).pose.rotation == Eigen::Matrix3d::Identity());
    CHECK(contains(scene_text_failure(
                       replaced_text("0 0 0.7071067811865476 0.7071067811865476", "0 0 0 1e-9")),
                   "expected a quaternion of length 1, got 0 0 0 1e-09"));
  }

  TEST_CASE("sizes of 0 and quaternions of other lengths in scene text are taken with a warning") {
    const auto scene = require(parse_scene(replaced_text("0.125\n0.5", "0\n0.5"), "f.scene"));
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0] == "f.scene:25: a size of 0 is taken for 0.1 mm");
    const auto scaled = require(parse_scene(
        replaced_text("0 0 0.7071067811865476 0.7071067811865476", "0 0 1 1"), "f.scene"));
    CHECK(scaled.warnings.size() == 1);
    CHECK(scaled.obstacles == parse_scene(kText, "f.scene").value().obstacles);
  }

  TEST_CASE("scene text has bodies with poses, whose shapes have poses in them") {
    const auto scene = require(parse_scene(kText, "f.scene"));
    CHECK(scene.name == "(shop floor)+");
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[0].name == "bench top");
    REQUIRE(scene.obstacles[0].shapes.size() == 2);
    const Box& box = std::get<Box>(scene.obstacles[0].shapes[0]);
    CHECK(box.half_extents == Vec3(0.25, 0.75, 0.0625));
    CHECK(box.pose.translation == Vec3(0.5, 0, 0.25));
    const Cylinder& leg = std::get<Cylinder>(scene.obstacles[0].shapes[1]);
    CHECK(leg.radius == 0.0625);
    CHECK(leg.length == 0.25);
    CHECK(leg.pose.translation.isApprox(Vec3(0.5, 1, 0.75)));
    CHECK(std::get<Sphere>(scene.obstacles[1].shapes[0]).center == Vec3(0.5, -0.25, 0.75));
  }

  TEST_CASE("a cone of scene text is taken for the cylinder around it, with a warning") {
    const auto scene = require(parse_scene(replaced_text("cylinder", "cone"), "f.scene"));
    CHECK(scene.obstacles == parse_scene(kText, "f.scene").value().obstacles);
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0].ends_with("a cone is taken for the cylinder around it"));
  }

  TEST_CASE("scene text of old versions has no poses of bodies and no subframes") {
    const auto scene = require(parse_scene(
        "old\n* part\n2\nmesh\n3 1\n0 0 0\n1 0 0\n0 1 0\n0 1 2\n0 0 1\n0 0 0 1\n0 0 0 0\nplane\n"
        "0 0 2 -1\n5 0 0\n0 0 0 1\n0 0 0 0\n.\n",
        "f.scene"));
    REQUIRE(scene.obstacles.at(0).shapes.size() == 2);
    const Mesh& mesh = std::get<Mesh>(scene.obstacles[0].shapes[0]);
    CHECK(mesh.parts->list().size() == 1);
    CHECK(mesh.pose.translation == Vec3(0, 0, 1));
    CHECK(std::get<Box>(scene.obstacles[0].shapes[1]).pose.translation.isApprox(Vec3(0, 0, 0.5)));
    CHECK(parse_scene("nothing\n.\n", "f.scene").value().obstacles.empty());
  }

  TEST_CASE("scene text that is malformed is refused by line") {
    CHECK(scene_text_failure(kText.substr(0, 100)).starts_with("f.scene:"));
    CHECK(
        scene_text_failure(replaced_text("cylinder", "prism")) ==
        "f.scene:11: object \"bench top\" has the shape \"prism\"; expected sphere, box, cylinder, "
        "cone, mesh or plane");
    CHECK(scene_text_failure(replaced_text("0.125\n0.5", "-1\n0.5")) ==
          "f.scene:25: expected a size above 0, got -1");
    CHECK(scene_text_failure(replaced_text("0.125\n0.5", "nan\n0.5")) ==
          "f.scene:25: expected a finite number, got \"nan\"");
    CHECK(scene_text_failure(replaced_text("* ball", "ball"))
              .starts_with("f.scene:20: expected \"* NAME\""));
    CHECK(scene_text_failure(replaced_text("0\n.\n", "0\n")) ==
          "f.scene:30: the scene ends early; expected a line with a dot last");
    CHECK(scene_text_failure("m\n* a\n1\nmesh\n1 1\n0 0 0\n0 0 1\n") ==
          "f.scene:7: there is no vertex 1");
  }
}

TEST_SUITE("law") {
  TEST_CASE("every prefix of scene text and every damaged byte is read or refused") {
    for (std::size_t size = 0; size < kText.size(); ++size) {
      static_cast<void>(scene_text_failure(kText.substr(0, size)));
    }
    Rng rng(5);
    for (int repetition = 0; repetition < 3000; ++repetition) {
      std::string text = kText;
      text[rng.index(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(rng.index(256));
      const std::string message = scene_text_failure(text);
      CHECK((message.empty() || message.starts_with("f.scene:")));
    }
  }
}

}  // namespace mneme
