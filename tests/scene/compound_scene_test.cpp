// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "support/support.h"

#include <doctest/doctest.h>

#include <limits>
#include <string>

namespace mneme::test {
namespace {

constexpr const char* kCloud =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nend_header\n0 0 0\n1 2 3\nnan 0 0\n";

std::string obj_of(const std::string& corner) {
  return "v 0 0 0\nv 1 0 0\nv " + corner + "\nf 1 2 3\n";
}

/// Files of each kind, and a scene that names `obstacle`.
struct Files {
  TemporaryDirectory directory;

  Files() {
    write_file(directory / "cloud.ply", kCloud);
    write_file(directory / "mesh.obj", obj_of("0 1 0"));
    write_file(directory / "large.obj", obj_of("0 1000 0"));
    write_file(directory / "empty.obj", "");
    write_file(directory / "map.bt",
               std::string("# Octomap OcTree binary file\nid OcTree\nres 0.1\ndata\n\2") + '\0');
  }
  Result<Scene> load(const std::string& obstacle) const {
    write_file(directory / "scene.yaml", "obstacles:\n  - {" + obstacle + "}\n");
    return load_scene(directory / "scene.yaml");
  }
  std::string message_of(const std::string& obstacle) const {
    const auto scene = load(obstacle);
    return scene ? "" : scene.error().message;
  }
};

template <class S>
S shape_of(const Scene& scene) {
  return std::get<S>(scene.obstacles.at(0).shapes.at(0));
}

TEST_SUITE("unit") {
  TEST_CASE("a scene reads points, a mesh and an octree from files beside it") {
    const Files files;
    const Scene cloud =
        require(files.load("name: c, type: points, file: cloud.ply, radius: 0.005"));
    CHECK(shape_of<PointCloud>(cloud).parts->list().size() == 2);
    CHECK(shape_of<PointCloud>(cloud).radius == 0.005);
    REQUIRE(cloud.warnings.size() == 1);
    CHECK(contains(cloud.warnings[0], "1 of 3 points are not finite and ignored"));
    const Scene mesh =
        require(files.load("name: m, type: mesh, file: mesh.obj, scale: 2, position: [0, 0, 1]"));
    CHECK(shape_of<Mesh>(mesh).parts->list().at(0).area() == doctest::Approx(2));
    CHECK(distance(Vec3(0.5, 0.5, 3), mesh.obstacles[0].shapes[0]) == doctest::Approx(2));
  }

  TEST_CASE("a mesh in millimetres is read with a warning that names the unit") {
    const Files files;
    const Scene scene = require(files.load("name: m, type: mesh, file: large.obj"));
    REQUIRE(scene.warnings.size() == 1);
    CHECK(contains(scene.warnings[0], "is 1000 m long; one in millimetres needs scale: 0.001"));
    CHECK(
        require(files.load("name: m, type: mesh, file: large.obj, scale: 0.001")).warnings.empty());
    CHECK(require(files.load("name: o, type: octree, file: map.bt")).warnings.empty());
  }

  TEST_CASE("missing, empty and other files are refused by name") {
    const Files files;
    const auto of_mesh = [&](const std::string& file) {
      return files.message_of("name: m, type: mesh, file: " + file);
    };
    CHECK(contains(of_mesh("none.stl"), "none.stl: cannot be read: No such file"));
    CHECK(contains(of_mesh("empty.obj"), "empty.obj: is empty"));
    CHECK(contains(of_mesh("cloud.xyz"), "expected a file named .stl, .obj, .dae or .ply"));
    CHECK(contains(of_mesh("[1]"), "expected the path of a file"));
    CHECK(contains(files.message_of("name: c, type: points, file: none.pcd, radius: 1"),
                   "none.pcd: cannot be read"));
    CHECK(contains(files.message_of("name: c, type: points, file: cloud.ply"), "radius"));
    CHECK(contains(files.message_of("name: o, type: octree, file: cloud.ply"), "OctoMap 1"));
    CHECK(contains(files.message_of("name: o, type: octree, file: map.bt, unknown: maybe"),
                   "expected free or occupied"));
  }

  TEST_CASE("a list beside a file is refused, and what only a file may have beside a list") {
    const Files files;
    CHECK(contains(files.message_of("name: c, type: points, file: cloud.ply, radius: 1, "
                                    "points: [1, 2, 3]"),
                   "expected either file or points, got both"));
    CHECK(contains(files.message_of("name: m, type: mesh, file: mesh.obj, triangles: [0]"),
                   "expected either file or triangles, got both"));
    CHECK(contains(files.message_of("name: o, type: octree, file: map.bt, cubes: [0, 0, 0, 1]"),
                   "expected either file or cubes, got both"));
    CHECK(
        contains(files.message_of("name: o, type: octree, unknown: occupied, cubes: [0, 0, 0, 1]"),
                 "unknown: expected the key file with it, got cubes"));
  }

  TEST_CASE("points, triangles and cubes as lists are read back from text to the same") {
    const char* text =
        "name: s\nobstacles:\n"
        "  - {name: a, type: points, radius: 0.01, points: [0, 0, 0, 0.5, 0.25, 1]}\n"
        "  - {name: b, type: mesh, position: [1, 2, 3], triangles: [0, 0, 0, 1, 0, 0, 0, 1, 0]}\n"
        "  - {name: c, type: octree, cubes: [0, 0, 0, 0.5, 1, 1, 1, 0.25]}\n";
    const auto scene = require(parse_scene(text, "f"));
    const char* rows =
        "name: s\nobstacles:\n"
        "  - {name: a, type: points, radius: 0.01, points: [[0, 0, 0], [0.5, 0.25, 1]]}\n"
        "  - {name: b, type: mesh, position: [1, 2, 3], triangles: [[0, 0, 0, 1, 0, 0, 0, 1, 0]]}\n"
        "  - {name: c, type: octree, cubes: [[0, 0, 0, 0.5], [1, 1, 1, 0.25]]}\n";
    CHECK(to_yaml(require(parse_scene(rows, "f"))) == to_yaml(scene));
    const auto again = require(parse_scene(to_yaml(scene), "again"));
    CHECK(to_yaml(again) == to_yaml(scene));
    CHECK(std::get<Octree>(again.obstacles[2].shapes[0]).parts->list()[1].half_extent == 0.125);
    CHECK(std::get<Mesh>(again.obstacles[1].shapes[0]).pose.translation == Vec3(1, 2, 3));
  }

  TEST_CASE("lists of the wrong length and keys of other types are refused") {
    const Files files;
    CHECK(contains(files.message_of("name: a, type: points, radius: 1, points: [1, 2]"),
                   "expected 3 numbers for each of the parts, got 2"));
    CHECK(contains(files.message_of("name: a, type: mesh, triangles: []"), "got 0"));
    CHECK(
        contains(files.message_of("name: a, type: octree, cubes: [0, 0, 0, -1]"), "edges above 0"));
    CHECK(
        contains(files.message_of("name: a, type: points, radius: 1, points: [[1, 2, 3], [4, 5]]"),
                 "numbers of one part"));
    CHECK(contains(
        files.message_of("name: a, type: mesh, triangles: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]"),
        "numbers of one part"));
    CHECK(contains(files.message_of("name: a, type: mesh, points: [1, 2, 3]"), "unknown key"));
    CHECK(contains(files.message_of("name: a, type: points, radius: 1, points: [1, 2, .inf]"),
                   "finite"));
  }
}

Obstacle ball(const std::string& name) { return {name, {Sphere{Vec3::Zero(), 0.1}}}; }

Scene with_cloud() {
  const auto points =
      std::make_shared<Parts<CloudPoint>>(std::vector<CloudPoint>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  Scene scene{"s", {}};
  require(scene.add({"cloud", {PointCloud{{}, points, 0.1}}}));
  return scene;
}

std::string edit_message(const Result<void>& result) {
  return result ? "" : result.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("obstacles are added, moved and removed by name") {
    Scene scene{"s", {}};
    require(scene.add(ball("a")));
    require(scene.add(ball("b")));
    require(scene.move("b", {Eigen::Matrix3d::Identity(), Vec3(1, 2, 3)}));
    CHECK(std::get<Sphere>(scene.find("b")->shapes[0]).center == Vec3(1, 2, 3));
    scene.end_contacts = {{"hand", "a", 0.01}, {"a", "b", 0.01}, {"hand", "b", 0.01}};
    require(scene.remove("a"));
    CHECK(scene.obstacles.size() == 1);
    CHECK(scene.find("a") == nullptr);
    CHECK(scene.end_contacts == std::vector<EndContact>{{"hand", "b", 0.01}});
  }

  TEST_CASE("rotations stay rotations after a thousand moves to a pose") {
    Scene scene{"s", {}};
    require(scene.add({"b", {Box{{}, Vec3(0.1, 0.2, 0.3)}, Cylinder{{}, 0.1, 0.2}}}));
    const auto pose = [&](std::size_t i) {
      return std::visit(
          [](const auto& own) {
            if constexpr (requires { own.pose; }) return own.pose;
            return Transform();
          },
          scene.find("b")->shapes[i]);
    };
    for (int i = 1; i <= 1000; ++i) {
      const Transform after{rotation_about(Vec3(0.6, 0, 0.8), 0.7 * i), Vec3(0.1 * (i % 7), 0, 0)};
      require(scene.move("b", after * pose(0).inverse()));
      for (const std::size_t shape : {0U, 1U}) {
        const Transform reached = pose(shape);
        CHECK((reached.rotation - after.rotation).norm() < 1e-9);
        CHECK((reached.translation - after.translation).norm() < 1e-9);
      }
    }
    const Scene before = scene;
    for (const Transform& wrong : {Transform{2 * Eigen::Matrix3d::Identity(), Vec3::Zero()},
                                   Transform{Eigen::Matrix3d::Identity(), Vec3(NAN, 0, 0)}}) {
      CHECK(edit_message(scene.move("b", wrong)) ==
            "obstacle \"b\": expected a rigid motion of finite numbers");
    }
    CHECK(scene == before);
  }

  TEST_CASE("shapes of one name are one body, also after obstacles were changed by hand") {
    Scene scene{"s", {}};
    require(scene.add_shape("a", Sphere{Vec3::Zero(), 1}));
    require(scene.add_shape("a", Sphere{Vec3::UnitX(), 1}));
    REQUIRE(scene.obstacles.size() == 1);
    CHECK(scene.obstacles[0].shapes.size() == 2);
    scene.obstacles.push_back(ball("b"));
    CHECK_FALSE(scene.add(ball("b")).has_value());
    require(scene.remove("a"));
    CHECK(scene.add(ball("a")).has_value());
    Scene copy = scene;
    CHECK(copy == scene);
    CHECK_FALSE(copy.add(ball("a")).has_value());
    const Scene moved_to = std::move(copy);
    copy = Scene{"t", {}};
    CHECK(copy.add(ball("a")).has_value());
    CHECK(edit_message(scene.add_shape("a", Sphere{Vec3::Zero(), -1})).starts_with("obstacle 'a'"));
  }

  TEST_CASE("a shape goes to its obstacle where another one took the place of one before it") {
    Scene scene{"s", {}};
    for (const char* name : {"a", "b"}) require(scene.add(ball(name)));
    require(scene.remove("a"));
    scene.obstacles.push_back(ball("c"));
    require(scene.add_shape("b", Sphere{Vec3::UnitX(), 1}));
    CHECK(scene.find("b")->shapes.size() == 2);
    scene.obstacles[0].name = "d";
    require(scene.add_shape("b", Sphere{Vec3::UnitX(), 1}));
    CHECK(scene.find("d")->shapes.size() == 2);
    CHECK(scene.obstacles.size() == 3);
  }

  TEST_CASE("adding an obstacle does not read those that are there") {
    constexpr int kCount = 100'000;
    Scene scene{"s", {}};
    const Stopwatch stopwatch;
    for (int i = 0; i < kCount; ++i) REQUIRE(scene.add(ball("b" + std::to_string(i))).has_value());
    // A search through the list took minutes.
    CHECK(stopwatch.elapsed_s() < 10);
  }

  TEST_CASE("names that are unknown or taken are errors that name them") {
    Scene scene = with_cloud();
    const std::string unknown = "obstacle \"x\": there is none of this name in scene \"s\"";
    CHECK(edit_message(scene.remove("x")) == unknown);
    CHECK(edit_message(scene.move("x", {})) == unknown);
    CHECK(edit_message(scene.replace_points("x", 0, {})) == unknown);
    CHECK(edit_message(scene.add(ball("cloud"))) ==
          "obstacle \"cloud\": expected a unique name; the scene has an obstacle of this name");
    CHECK(edit_message(scene.add(ball(""))) == "obstacle \"\": expected a name");
    CHECK(edit_message(scene.add({"e", {}})) == "obstacle \"e\": expected a shape");
    const auto many = std::make_shared<Parts<CloudPoint>>(std::vector<CloudPoint>(4'000'001));
    CHECK(edit_message(scene.add({"m", {PointCloud{{}, many, 0.1}}})) ==
          "obstacle 'm': expected at most 4000000 points, got 4000001");
  }

  TEST_CASE("shapes that are none are not added") {
    Scene scene;
    CHECK(edit_message(scene.add({"c", {PointCloud{}}})) == "obstacle 'c': its cloud has no parts");
    CHECK(edit_message(scene.add({"m", {Mesh{}}})) == "obstacle 'm': its mesh has no parts");
    CHECK(edit_message(scene.add({"b", {Box{{}, {0.1, -0.1, 0.1}}}})) ==
          "obstacle 'b': its box has a size that is not positive");
    const auto inverted = std::make_shared<Parts<Cube>>(std::vector<Cube>{{{0, 0, 0}, -0.1}});
    CHECK(edit_message(scene.add({"o", {Octree{{}, inverted, 0}}})) ==
          "obstacle 'o': its octree has a part that is not finite or has a negative size");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Triangle& t :
         {Triangle{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Triangle{{0, 0, 0}, {1, nan, 0}, {0, 1, 0}},
          Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, nan}}}) {
      const auto torn = std::make_shared<Parts<Triangle>>(std::vector<Triangle>{t});
      CHECK(edit_message(scene.add({"t", {Mesh{{}, torn, 0}}})) ==
            "obstacle 't': its mesh has a part that is not finite or has a negative size");
    }
    CHECK(scene.obstacles.empty());
  }

  TEST_CASE("points are replaced in this scene, not in a copy of it") {
    Scene scene = with_cloud();
    const Scene before = scene;
    const std::vector<CloudPoint> fresh = {{5, 5, 5}};
    require(scene.replace_points("cloud", 1, fresh));
    const auto points_of = [](const Scene& s) {
      return std::get<PointCloud>(s.obstacles[0].shapes[0]).parts->list();
    };
    CHECK(points_of(scene)[1] == CloudPoint{5, 5, 5});
    CHECK(points_of(before)[1] == CloudPoint{1, 0, 0});
    CHECK(distance(Vec3(5, 5, 5), scene.obstacles[0].shapes[0]) == 0);
    CHECK(distance(Vec3(5, 5, 5), before.obstacles[0].shapes[0]) > 1);
  }

  TEST_CASE("points that are not there or not finite are refused, and change nothing") {
    Scene scene = with_cloud();
    require(scene.add(ball("ball")));
    const std::vector<CloudPoint> two = {{1, 1, 1}, {2, 2, 2}};
    const std::vector<CloudPoint> wrong = {{0, 0, std::numeric_limits<float>::quiet_NaN()}};
    CHECK(edit_message(scene.replace_points("cloud", 2, two)) ==
          "obstacle \"cloud\": expected points 2 to 4 to be among the cloud's 3");
    CHECK(edit_message(scene.replace_points("cloud", 0, wrong)) ==
          "obstacle \"cloud\": expected finite coordinates");
    CHECK(edit_message(scene.replace_points("ball", 0, two)) ==
          "obstacle \"ball\": expected one cloud of points");
  }
}

}  // namespace
}  // namespace mneme::test
