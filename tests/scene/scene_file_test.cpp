// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "input/input.h"
#include "scene/read_yaml.h"
#include "scene/scene_input.h"
#include "support/support.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::SceneBuilder;

TEST_SUITE("unit") {
  TEST_CASE("shapes of one body make one obstacle at the place of the first") {
    SceneBuilder builder;
    CHECK_FALSE(builder.add("leg", "table", Sphere{}));
    CHECK_FALSE(builder.add("ball", "", Sphere{}));
    CHECK_FALSE(builder.add("", "table", Box{}));
    const Scene scene = builder.take("room").scene;
    CHECK(scene.name == "room");
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[0].name == "table");
    REQUIRE(scene.obstacles[0].shapes.size() == 2);
    CHECK(shape_name(scene.obstacles[0].shapes[1]) == "box");
    CHECK(scene.obstacles[1].name == "ball");
  }

  TEST_CASE("names that are missing or taken are refused") {
    SceneBuilder builder;
    REQUIRE_FALSE(builder.add("a", "", Sphere{}));
    REQUIRE_FALSE(builder.add("part", "body", Sphere{}));
    CHECK(builder.add("", "", Sphere{}) == "expected a name");
    CHECK(builder.add("a", "", Sphere{}) == "expected a unique name, got \"a\" a second time");
    const std::string bad = "expected a name that is UTF-8 text without NUL, got \"b";
    CHECK(builder.add("b\xff", "", Sphere{}) == bad + "\xff\"");
    CHECK(builder.add("", "b\xfe", Sphere{}) == bad + "\xfe\"");
    CHECK(builder.add("part", "body", Sphere{}) ==
          "expected a unique name, got \"part\" a second time");
    CHECK(builder.add("body", "", Sphere{}) ==
          "expected a unique name, got \"body\", which names a body");
    CHECK(builder.add("b", "a", Sphere{}) ==
          "expected a unique body name, got \"a\", which names an obstacle");
    CHECK(builder.take("").scene.obstacles.size() == 2);
  }
}

using internal::Input;

TEST_SUITE("unit") {
  TEST_CASE("a rotation is read in the order that is asked for") {
    const auto first = [](const Input& input) { return internal::read_rotation(input, true); };
    const auto last = [](const Input& input) { return internal::read_rotation(input, false); };
    const Eigen::Matrix3d about_z = rotation_about(Vec3::UnitZ(), 0.5 * 3.14159265358979);
    CHECK((read_yaml("[2, 0, 0, 2]", first).value() - about_z).norm() < 1e-12);
    CHECK((read_yaml("[0, 0, 1, 1]", last).value() - about_z).norm() < 1e-12);
    CHECK(failure_of("[0, 0, 0, 0]", last) ==
          "f:1: expected a quaternion of length 1, got [0, 0, 0, 0]");
    CHECK(failure_of("[0, 0, 0, 11]", last) ==
          "f:1: expected a quaternion of length 1, got [0, 0, 0, 11]");
    CHECK(failure_of("[0, 0, 0]", last) ==
          "f:1: expected 4 numbers (a quaternion x, y, z, w), got a list of 3");
  }

  TEST_CASE("a point has three finite numbers") {
    CHECK(read_yaml("[1, -2, .5]", internal::read_point).value() == Vec3(1, -2, 0.5));
    CHECK(failure_of("[1, 2, .nan]", internal::read_point).find("f:1: ") == 0);
  }
}

const std::string kObstacleSource = "f";

using internal::ObstacleSpelling;

Result<Scene> read_obstacle_list(const std::string& yaml,
                                 const ObstacleSpelling& spelling = internal::kSceneSpelling) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml(yaml, "f");
    internal::SceneBuilder builder;
    internal::read_obstacles(internal::Input(value, kObstacleSource), spelling, builder);
    return builder.take("").scene;
  });
}

Shape read_shape(const std::string& yaml) {
  return require(read_obstacle_list("- {name: x, " + yaml + "}")).obstacles.at(0).shapes.at(0);
}

TEST_SUITE("unit") {
  TEST_CASE("sizes of a box are full extents") {
    const auto box = std::get<Box>(read_shape("type: box, position: [1, 2, 3], size: [2, 4, 6]"));
    CHECK(box.half_extents == Vec3(1, 2, 3));
    CHECK(box.pose.translation == Vec3(1, 2, 3));
    CHECK(box.pose.rotation == Eigen::Matrix3d::Identity());
  }

  TEST_CASE("spheres and cylinders keep their sizes") {
    const auto sphere =
        std::get<Sphere>(read_shape("type: sphere, position: [1, 2, 3], radius: 4"));
    CHECK(sphere.center == Vec3(1, 2, 3));
    CHECK(sphere.radius == 4);
    const auto cylinder =
        std::get<Cylinder>(read_shape("type: cylinder, position: [1, 2, 3], radius: 4, length: 5"));
    CHECK(cylinder.radius == 4);
    CHECK(cylinder.length == 5);
  }

  TEST_CASE("a capsule is given by its pose and length or by its ends") {
    const std::string pose = "type: capsule, position: [1, 0, 0], quat_xyzw: [0, 2, 0, 2], ";
    const auto posed = std::get<Capsule>(read_shape(pose + "radius: 0.1, length: 4"));
    CHECK((posed.a - Vec3(-1, 0, 0)).norm() < 1e-15);
    CHECK((posed.b - Vec3(3, 0, 0)).norm() < 1e-15);
    const auto ends =
        std::get<Capsule>(read_shape("type: capsule, a: [0, 1, 2], b: [3, 4, 5], radius: 0.1"));
    CHECK(ends.a == Vec3(0, 1, 2));
    CHECK(ends.b == Vec3(3, 4, 5));
  }

  TEST_CASE("the spelling decides the order of a quaternion") {
    const auto compact =
        read_obstacle_list("- {name: x, type: box, p: [0, 0, 0], q: [1, 0, 0, 1], size: [1, 1, 1]}",
                           internal::kCompactSpelling);
    REQUIRE(compact.has_value());
    const auto box = std::get<Box>(compact->obstacles[0].shapes[0]);
    CHECK((box.pose.rotation * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
    const auto scene = std::get<Box>(
        read_shape("type: box, position: [0, 0, 0], quat_xyzw: [0, 0, 1, 1], size: [1, 1, 1]"));
    CHECK((scene.pose.rotation - box.pose.rotation).norm() < 1e-15);
  }

  TEST_CASE("obstacles that are malformed are refused with key and expectation") {
    const auto refused = [](const std::string& yaml) {
      const auto scene = read_obstacle_list("- " + yaml);
      return scene ? std::string() : scene.error().message;
    };
    const std::string sphere = "{name: x, type: sphere, ";
    const std::string box = "{name: x, type: box, position: [0, 0, 0], ";
    CHECK(refused("7") == "f:1: key [0]: expected a map, got 7");
    CHECK(refused("{name: x}") == "f:1: key [0]: expected the key type, which is missing");
    CHECK(refused("{name: x, type: cone}") ==
          "f:1: key [0].type: expected sphere, box, cylinder, capsule, points, mesh or octree, got "
          "\"cone\"");
    CHECK(refused(sphere + "radius: 1}") ==
          "f:1: key [0]: expected the key position, which is missing");
    CHECK(refused(sphere + "position: [0, 0], radius: 1}") ==
          "f:1: key [0].position: expected 3 numbers (x, y, z in metres), got a list of 2");
    CHECK(refused(sphere + "position: [0, .nan, 0], radius: 1}") ==
          "f:1: key [0].position[1]: expected a finite number, got .nan");
    CHECK(refused(sphere + "position: [0, 0, 0], radius: -1}") ==
          "f:1: key [0].radius: expected a number above 0, got -1");
    CHECK(refused(sphere + "position: [0, 0, 0], radius: .inf}") ==
          "f:1: key [0].radius: expected a finite number, got .inf");
    CHECK(
        refused(sphere + "position: [0, 0, 0], radius: 1, length: 2}") ==
        "f:1: key [0].length: unknown key, expected one of name, body, type, position, quat_xyzw, "
        "radius");
    CHECK(refused(box + "size: [1, -2, 1]}") ==
          "f:1: key [0].size[1]: expected a number above 0, got -2");
    CHECK(refused(box + "size: 1}") ==
          "f:1: key [0].size: expected 3 numbers (full extents in metres), got 1");
    CHECK(refused(box + "quat_xyzw: [0, 0, 0, 0], size: [1, 1, 1]}") ==
          "f:1: key [0].quat_xyzw: expected a quaternion of length 1, got [0, 0, 0, 0]");
    CHECK(refused(box + "quat_xyzw: [0, 0, 1], size: [1, 1, 1]}") ==
          "f:1: key [0].quat_xyzw: expected 4 numbers (a quaternion x, y, z, w), got a list of 3");
    CHECK(refused("{type: sphere, position: [0, 0, 0], radius: 1}") ==
          "f:1: key [0]: expected a name");
    CHECK(refused("{name: '', type: sphere, position: [0, 0, 0], radius: 1}") ==
          "f:1: key [0].name: expected a name, got \"\"");
    CHECK(refused("{name: x, type: capsule, a: [0, 0, 0], radius: 1}") ==
          "f:1: key [0]: expected the key b, which is missing");
  }

  TEST_CASE("circles lie in the plane z = 0, named by a map or numbered in a list") {
    const auto value = internal::parse_yaml("[{a: [1, 2, 3]}, [[4, 5, 6]]]", "f");
    const auto both = internal::Input(value, kObstacleSource).items();
    internal::SceneBuilder builder;
    internal::read_circles(both[0], builder);
    internal::read_circles(both[1], builder);
    const Scene scene = builder.take("").scene;
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[0].name == "a");
    CHECK(scene.obstacles[1].name == "circle_1");
    const auto sphere = std::get<Sphere>(scene.obstacles[1].shapes[0]);
    CHECK(sphere.center == Vec3(4, 5, 0));
    CHECK(sphere.radius == 6);
  }
}

const std::string kSceneSource = "f";

Result<Scene> read_scene_text(const std::string& yaml) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml(yaml, "f");
    return internal::read_scene(internal::Input(value, kSceneSource), "default");
  });
}

TEST_SUITE("unit") {
  TEST_CASE("circles come before obstacles, and names must differ between them") {
    const std::string sphere = "type: sphere, position: [0, 0, 0], radius: 1}\n";
    const auto scene =
        read_scene_text("obstacles:\n  - {name: b, " + sphere + "circles: {a: [0, 0, 1]}\n");
    REQUIRE(scene.has_value());
    CHECK(scene->obstacles[0].name == "a");
    CHECK(scene->obstacles[1].name == "b");
    const auto clash =
        read_scene_text("circles: {a: [0, 0, 1]}\nobstacles:\n  - {name: a, " + sphere);
    REQUIRE_FALSE(clash.has_value());
    CHECK(clash.error().message ==
          "f:3: key obstacles[0]: expected a unique name, got \"a\" a second time");
  }

  TEST_CASE("pairs may touch at the ends of a path, and are written as they were read") {
    const std::string circle = "circles: {a: [0, 0, 1]}\n";
    const auto scene =
        read_scene_text(circle + "allow: [[hand, a], {pair: [cup, a], at_ends: 0.01}]");
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    CHECK(scene->obstacles[0].may_touch == std::vector<std::string>{"hand"});
    CHECK(scene->end_contacts == std::vector<EndContact>{{"cup", "a", 0.01}});
    CHECK(parse_scene(to_yaml(*scene), "f").value().end_contacts == scene->end_contacts);
    CHECK(read_scene_text(circle + "allow: [{pair: [cup, a], at_ends: 0}]").error().message ==
          "f:2: key allow[0].at_ends: expected a number above 0, got 0");
    CHECK(read_scene_text(circle + "allow: [{pair: [cup, a], at_ends: 2}]").error().message ==
          "f:2: key allow[0].at_ends: expected metres, at most 1, got 2");
    const auto of_links = read_scene_text(circle + "allow: [{pair: [cup, finger], at_ends: 0.1}]");
    REQUIRE(of_links.has_value());
    CHECK(parse_scene(to_yaml(*of_links), "f").value().end_contacts == of_links->end_contacts);
    CHECK(contains(read_scene_text(circle + "allow: [[cup, b]]").error().message,
                   "the scene has no obstacle \"b\""));
    CHECK_FALSE(read_scene_text(circle + "allow: [{pair: [cup, a]}]").has_value());
  }

  TEST_CASE("a scene that gives no name has the default one") {
    CHECK(read_scene_text("circles: []").value().name == "default");
    CHECK(read_scene_text("name: x").value().name == "x");
  }

  TEST_CASE("anything but a map of the known keys is refused") {
    CHECK(read_scene_text("circle: []").error().message ==
          "f:1: key circle: unknown key, expected one of name, circles, obstacles, allow; did you "
          "mean 'circles'?");
    CHECK(read_scene_text("").error().message == "f:1: expected a map, got nothing");
    CHECK(read_scene_text("just text").error().message == "f:1: expected a map, got \"just text\"");
    CHECK(read_scene_text("circles: 3").error().message ==
          "f:1: key circles: expected a list, got 3");
    CHECK(read_scene_text("circles:\n  a: [0, 0]").error().message ==
          "f:2: key circles.a: expected 3 numbers (x, y, radius in metres), got a list of 2");
    CHECK(read_scene_text("circles: [[0, 0, -1]]").error().message ==
          "f:1: key circles[0][2]: expected a number above 0, got -1");
  }

  TEST_CASE("sizes of 0 and quaternions of other lengths are taken, each with one warning") {
    const auto scene = require(read_scene_text(
        "obstacles:\n"
        "- {name: a, type: box, position: [0, 0, 0], size: [1, 0, 2], quat_xyzw: [0, 0, 0, 2]}\n"
        "- {name: b, type: sphere, position: [0, 0, 0], radius: 0}\n"
        "circles: {c: [0, 0, 0]}\n"));
    const auto& box = std::get<Box>(scene.find("a")->shapes[0]);
    CHECK(box.half_extents == Vec3(0.5, 0.5e-4, 1));
    CHECK(box.pose.rotation.isIdentity(1e-12));
    CHECK(std::get<Sphere>(scene.find("b")->shapes[0]).radius == 1e-4);
    CHECK(std::get<Sphere>(scene.find("c")->shapes[0]).radius == 1e-4);
    REQUIRE(scene.warnings.size() == 2);
    CHECK(scene.warnings[0] ==
          "f:4: key circles.c[2]: a size of 0 is taken for 0.1 mm (and 2 more)");
    CHECK(scene.warnings[1] ==
          "f:2: key obstacles[0].quat_xyzw: the quaternion's length is not 1, and the quaternion "
          "is scaled");
    CHECK(read_scene_text("circles: {c: [0, 0, 1]}").value().warnings.empty());
  }

  TEST_CASE("a cloud without points is left out with a warning") {
    const auto scene =
        require(read_scene_text("obstacles: [{name: a, type: points, radius: 0.01, points: []},"
                                " {name: b, type: points, radius: 0.01, points: [1, 2, 3]}]"));
    REQUIRE(scene.obstacles.size() == 1);
    CHECK(scene.obstacles[0].name == "b");
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0] ==
          "f:1: key obstacles[0].points: there are no points, and the cloud is left out");
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a scene file is read, and named after the file if it gives no name") {
    const TemporaryDirectory directory;
    write_file(directory / "room.yaml", "circles: {a: [1, 2, 3]}\n");
    const auto scene = require(load_scene(directory / "room.yaml"));
    CHECK(scene.name == "room");
    CHECK(scene.obstacles.size() == 1);
  }

  TEST_CASE("a file that is missing is an io error") {
    CHECK(require_error(load_scene("/nonexistent.yaml")).code == ErrorCode::io);
  }

  TEST_CASE("malformed text is a parse error that names file and line") {
    const Error error =
        require_error(parse_scene("name: x\ncircles: {a: [1, 2, x]}\n", "dir/s.yaml"));
    CHECK(error.code == ErrorCode::parse);
    CHECK(error.message == "dir/s.yaml:2: key circles.a[2]: expected a number, got \"x\"");
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

TEST_SUITE("unit") {
  TEST_CASE("circles become numbered spheres in the plane z = 0") {
    const Scene scene = make_circle_scene("two", {{1, 2, 3}, {4, 5, 6}});
    CHECK(scene.name == "two");
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[1].name == "circle_2");
    REQUIRE(scene.obstacles[1].shapes.size() == 1);
    const auto sphere = std::get<Sphere>(scene.obstacles[1].shapes[0]);
    CHECK(sphere.center == Vec3(4, 5, 0));
    CHECK(sphere.radius == 6);
  }
}

}  // namespace
}  // namespace mneme::test
