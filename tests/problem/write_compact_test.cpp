// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "support/support.h"

namespace mneme::test {
namespace {

const Transform kPose{rotation_from_rpy({0.1, -0.2, 2.5}), {0.5, -0.25, 1.125}};

FramedScene strange_scene() {
  return {{"a: scene",
           {{"ball", {Sphere{{1, 2, 3}, 0.1}}},
            {"table", {Box{kPose, {0.1, 0.2, 0.3}}, Cylinder{kPose, 0.05, 0.7}}}}},
          "base_link"};
}

TEST_SUITE("unit") {
  TEST_CASE("a scene that is written as compact JSON reads back") {
    const TemporaryDirectory directory;
    FramedScene scene = strange_scene();
    scene.scene.obstacles.push_back({"bar", {Capsule{{1, 0, 0}, {0, 1, 0}, 0.02}}});
    write_file(directory / "s.json", to_compact_json(scene));
    const auto read = extract_scene(directory / "s.json" + "#a: scene");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->frame == "base_link");
    CHECK(read->scene.name == "a: scene");
    REQUIRE(read->scene.obstacles.size() == 3);
    const auto& box = std::get<Box>(read->scene.obstacles[1].shapes.at(0));
    CHECK((box.pose.rotation - kPose.rotation).norm() < 1e-12);
    CHECK(box.pose.translation == kPose.translation);
    CHECK(box.half_extents == Vec3(0.1, 0.2, 0.3));
    CHECK(std::get<Cylinder>(read->scene.obstacles[1].shapes.at(1)).length == 0.7);
    CHECK(std::get<Capsule>(read->scene.obstacles[2].shapes.at(0)).b == Vec3(0, 1, 0));
  }

  TEST_CASE("a scene in the root link's frame names no frame") {
    CHECK(to_compact_json({{"s", {}}, ""}) ==
          "{\n \"problems\": [\n  {\n   \"name\": \"s\",\n   \"obstacles\": []\n  }\n ]\n}\n");
  }
}

}  // namespace
}  // namespace mneme::test
