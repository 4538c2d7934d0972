// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "problem/moveit_files.h"

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("the scene of every kind of file is read without its robot") {
    const MoveitFiles files;
    const auto check = [](const std::string& where, const std::string& name,
                          const std::string& frame) {
      const auto scene = extract_scene(where);
      REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
      CHECK(scene->scene.obstacles.at(0).name == name);
      CHECK(scene->frame == frame);
    };
    check(files / "request0001.yaml", "ball", "base");
    check(files / "scene0001.yaml", "ball", "base");
    check(files / "scene0001.yaml" + "," + files / "request0001.yaml", "ball", "base");
    write_file(files / "scene.yaml", "circles: {a: [1, 2, 3]}\n");
    check(files / "scene.yaml", "a", "");
    write_file(files / "p.yaml", "robot: nobody\nframe: hand\nscene: scene.yaml\n");
    check(files / "p.yaml", "a", "hand");
    write_file(files / "p.json", R"({"frame": "hand", "problems": [{"circles": [[1, 2, 3]]}]})");
    check(files / "p.json#1", "circle_1", "hand");
  }

  TEST_CASE("a scene is moved from its frame to the root link") {
    const Robot robot = parse_robot(kLiftUrdf, "lifter.urdf").value();
    const Scene scene = make_circle_scene("s", {{3, 4, 1}});
    const auto center = [](const Result<Scene>& moved) {
      return std::get<Sphere>(moved.value().obstacles.at(0).shapes.at(0)).center;
    };
    CHECK(center(in_root_frame({scene, ""}, robot)) == Vec3(3, 4, 0));
    CHECK((center(in_root_frame({scene, "base"}, robot)) - Vec3(-4, 3, 0.5)).norm() < 1e-12);
    CHECK(in_root_frame({scene, "table"}, robot).error().message ==
          "s: expected a link of robot lifter as frame, got \"table\"");
    CHECK(in_root_frame({scene, "arm"}, robot).error().code == ErrorCode::unsupported);
  }
}

}  // namespace
}  // namespace mneme::test
