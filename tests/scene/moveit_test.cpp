// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "scene/moveit_scene.h"
#include "scene/read_yaml.h"
#include "support/support.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("lists and maps say the same pose") {
    const Transform list =
        read_yaml("{position: [1, 2, 3], orientation: [0, 0, 1, 1]}", internal::read_moveit_pose)
            .value();
    const Transform map = read_yaml(
                              "{position: {x: 1, y: 2, z: 3}, orientation: {w: 1, x: 0, y: 0, "
                              "z: 1}}",
                              internal::read_moveit_pose)
                              .value();
    CHECK((list * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm() < 1e-12);
    CHECK(list.rotation == map.rotation);
    CHECK(list.translation == map.translation);
    CHECK((read_yaml("{translation: [1, 2, 3], rotation: [0, 0, 1, 1]}",
                     internal::read_moveit_transform)
               .value()
               .rotation == list.rotation));
  }

  TEST_CASE("components of an orientation but w may be left out") {
    const auto read = internal::read_moveit_pose;
    CHECK(read_yaml("{position: [0, 0, 0], orientation: {w: 1}}", read).value().rotation ==
          Eigen::Matrix3d::Identity());
    CHECK(failure_of("{position: [0, 0, 0], orientation: {x: 1}}", read) ==
          "f:1: key orientation: expected the key w, which is missing");
  }

  TEST_CASE("an orientation that a message leaves at zero is the identity, as in MoveIt") {
    CHECK(read_yaml("{position: [0, 0, 0], orientation: {x: 0, y: 0, z: 0, w: 0}}",
                    internal::read_moveit_pose)
              .value()
              .rotation == Eigen::Matrix3d::Identity());
  }

  TEST_CASE("a missing orientation is none, anything else that is missing is refused") {
    const auto read = internal::read_moveit_pose;
    CHECK(read_yaml("{position: [1, 2, 3]}", read).value().rotation == Eigen::Matrix3d::Identity());
    CHECK(failure_of("{orientation: [0, 0, 0, 1]}", read) ==
          "f:1: expected the key position, which is missing");
    CHECK(failure_of("{position: {x: 1, y: 2}}", read) ==
          "f:1: key position: expected the key z, which is missing");
    CHECK(failure_of("{position: [0, 0, 0], orientation: [0, 0, 0, 0]}", read) ==
          "f:1: key orientation: expected a quaternion of length 1, got [0, 0, 0, 0]");
    CHECK(failure_of("{position: [0, 0, 0], rpy: [0, 0, 0]}", read) ==
          "f:1: key rpy: unknown key, expected one of position, orientation");
  }
}

using internal::MoveitState;
using internal::read_moveit_state;

TEST_SUITE("unit") {
  TEST_CASE("positions are read by joint, and the virtual joint poses the root link") {
    const MoveitState state = read_yaml(R"(
joint_state: {header: {frame_id: /world}, name: [a, b], position: [1, -2], velocity: [], effort: []}
multi_dof_joint_state:
  header: {frame_id: /world}
  joint_names: [virtual_joint]
  transforms: [{translation: [1, 2, 3], rotation: [0, 0, 0, 1]}]
is_diff: false
attached_collision_objects: []
)",
                                        read_moveit_state)
                                  .value();
    CHECK(state.positions == std::map<std::string, double>{{"a", 1}, {"b", -2}});
    REQUIRE(state.poses.contains("virtual_joint"));
    CHECK(state.poses.at("virtual_joint").translation == Vec3(1, 2, 3));
    CHECK(state.pose_frame == "world");
  }

  TEST_CASE("what a difference says stands for what was there") {
    MoveitState state;
    state.positions = {{"a", 1}, {"b", 2}};
    state.poses = {{"v", Transform{}}};
    MoveitState difference;
    difference.positions = {{"b", 3}};
    const MoveitState both = internal::overlaid(state, difference);
    CHECK(both.positions == std::map<std::string, double>{{"a", 1}, {"b", 3}});
    CHECK(both.poses.contains("v"));
  }

  TEST_CASE("attached objects have a link, shapes and links that may touch them") {
    const auto state = require(read_yaml(
        "attached_collision_objects: [{link_name: hand, touch_links: [finger, thumb], object: {id: "
        "cup, header: {frame_id: palm}, primitives: [{type: sphere, dimensions: [0.1]}], pose: "
        "{position: [1, 2, 3]}}}, {link_name: hand, object: {id: lid, operation: add}}]",
        read_moveit_state));
    REQUIRE(state.attached.size() == 2);
    const internal::MoveitAttached& cup = state.attached[0];
    CHECK(cup.link == "hand");
    CHECK(cup.touch_links == std::vector<std::string>{"finger", "thumb"});
    CHECK(cup.object.obstacle.name == "cup");
    CHECK(cup.object.frame == "palm");
    CHECK(std::get<Sphere>(cup.object.obstacle.shapes.at(0)).center == Vec3(1, 2, 3));
    CHECK(state.attached[1].object.obstacle.shapes.empty());
  }

  TEST_CASE("states that are malformed are refused") {
    const auto failure = [](const std::string& yaml) {
      return failure_of(yaml, read_moveit_state);
    };
    CHECK(failure("joint_state: {name: [a, b], position: [1]}") ==
          "f:1: key joint_state: expected as many entries in position as in name, got 1 and 2");
    CHECK(failure("joint_state: {name: [a, a], position: [1, 1]}") ==
          "f:1: key joint_state.name[1]: expected each joint once, got a again");
    CHECK(failure("joint_state: {name: [a], position: [.inf]}") ==
          "f:1: key joint_state.position[0]: expected a finite number, got .inf");
    CHECK(failure("multi_dof_joint_state: {joint_names: [a, b], transforms: [{}]}") ==
          "f:1: key multi_dof_joint_state: expected as many entries in transforms as in "
          "joint_names, got 1 and 2");
    CHECK(failure("attached_collision_objects:\n  - {link_name: hand, object: {id: ''}}") ==
          "f:2: key attached_collision_objects[0].object.id: expected a name, got \"\"");
    CHECK(failure("attached_collision_objects:\n  - {link_name: a, object: {id: x}}\n"
                  "  - {link_name: b, object: {id: x}}") ==
          "f:3: key attached_collision_objects[1].object: expected a unique name, got \"x\" "
          "again");
    CHECK(contains(failure("attached_collision_objects: [{object: {id: x}}]"),
                   "expected the key link_name"));
    CHECK(failure("joints: [1]") ==
          "f:1: key joints: unknown key, expected one of joint_state, multi_dof_joint_state, "
          "attached_collision_objects, is_diff");
  }
}

using internal::read_moveit_objects;

/// The message for an object "x" with these keys on one line.
std::string object_failure(const std::string& keys) {
  return failure_of("collision_objects:\n  - {id: x, " + keys + "}", read_moveit_objects);
}

const std::string kBall =
    "primitives: [{type: sphere, dimensions: [1]}], primitive_poses: [{position: [0, 0, 0]}]";
const std::string kPose = "primitive_poses: [{position: [0, 0, 0]}]";

TEST_SUITE("unit") {
  TEST_CASE("the pose of an object carries those of its primitives") {
    const auto objects = read_yaml(R"(
collision_objects:
  - id: table
    header: {frame_id: world}
    pose: {position: [0, 0, 1], orientation: [0, 0, 1, 1]}
    primitives:
      - {type: box, dimensions: [1, 2, 3]}
      - {type: 3, dimensions: [0.5, 0.1]}
      - {type: sphere, dimensions: [0.2]}
    primitive_poses:
      - {position: [1, 0, 0], orientation: [0, 0, 0, 1]}
      - {position: [0, 1, 0], orientation: [0, 0, 0, 1]}
      - {position: [0, 0, 1], orientation: [0, 0, 0, 1]}
    operation: 0
)",
                                   read_moveit_objects)
                             .value();
    REQUIRE(objects.size() == 1);
    CHECK(objects[0].frame == "world");
    CHECK(objects[0].obstacle.name == "table");
    const auto& shapes = objects[0].obstacle.shapes;
    REQUIRE(shapes.size() == 3);
    CHECK((std::get<Box>(shapes[0]).pose.translation - Vec3(0, 1, 1)).norm() < 1e-12);
    CHECK(std::get<Box>(shapes[0]).half_extents == Vec3(0.5, 1, 1.5));
    CHECK((std::get<Cylinder>(shapes[1]).pose.translation - Vec3(-1, 0, 1)).norm() < 1e-12);
    CHECK(std::get<Cylinder>(shapes[1]).length == 0.5);
    CHECK(std::get<Cylinder>(shapes[1]).radius == 0.1);
    CHECK((std::get<Sphere>(shapes[2]).center - Vec3(0, 0, 2)).norm() < 1e-12);
  }

  TEST_CASE("an object with a pose of its own needs none for its primitives") {
    const auto objects = require(read_yaml(
        "collision_objects: [{id: x, pose: {position: [1, 2, 3]}, primitives: [{type: sphere, "
        "dimensions: [1]}], primitive_poses: []}]",
        read_moveit_objects));
    CHECK(std::get<Sphere>(objects.at(0).obstacle.shapes.at(0)).center == Vec3(1, 2, 3));
  }

  TEST_CASE("objects that are not boxes, spheres and cylinders are refused by name") {
    CHECK(
        object_failure("primitives: [{type: prism, dimensions: [1]}], " + kPose) ==
        "f:2: key collision_objects[0].primitives[0].type: object \"x\" has a prism, which is not "
        "supported; expected box, sphere, cylinder or cone");
    CHECK(object_failure("operation: remove") ==
          "f:2: key collision_objects[0].operation: object \"x\": expected the operation add, got "
          "\"remove\"");
    CHECK(object_failure("operation: \"\\x02\"").ends_with("the operation add, got \"append\""));
    CHECK(contains(object_failure("operation: 7"), "expected the operation add of object \"x\""));
    CHECK(
        contains(failure_of("collision_objects: [{id: \"\xff\"}]", read_moveit_objects), "UTF-8"));
  }

  TEST_CASE("each spelling of the byte ADD adds an object, also one without a scene around it") {
    for (const char* operation : {"0", "'0'", "add", "ADD", "\"\\0\"", "\"\\x00\"", "'\\0'",
                                  "'\\x00'", "''", "\"\"", "b'\\x00'"}) {
      CAPTURE(operation);
      const std::string object =
          fmt::format("{{id: x, header: {{frame_id: base}}, operation: {}, {}}}", operation, kBall);
      CHECK(require(parse_scene(object, "f.yaml")).obstacles.at(0).name == "x");
      const auto world = require(parse_scene("collision_objects: [" + object + "]", "f.yaml"));
      CHECK(world.obstacles.size() == 1);
    }
  }

  TEST_CASE("a list that was cut when it was printed is refused with the way out") {
    const std::string fault = object_failure(
        "meshes: [{triangles: [{vertex_indices: [0, 1, 2]}, '...'], vertices: [[0, 0, 0], [1, 0, "
        "0], [0, 1, 0]]}], mesh_poses: [{position: [0, 0, 5]}]");
    CHECK_MESSAGE(contains(fault, "--full-length"), fault);
  }

  TEST_CASE("meshes, planes and an octomap of MoveIt are read") {
    const auto objects = require(read_yaml(
        "collision_objects: [{id: x, meshes: [{triangles: [{vertex_indices: [0, 1, 2]}], "
        "vertices: [{x: 0, y: 0, z: 0}, [1, 0, 0], [0, 1, 0]]}], mesh_poses: [{position: [0, 0, "
        "5]}], planes: [{coef: [0, 0, 2, -4]}], plane_poses: [{position: [0, 0, 1]}]}]\n"
        "octomap: {header: {frame_id: map}, origin: {position: [0, 0, 1]}, octomap: {binary: true, "
        "id: OcTree, resolution: 0.1, data: [2, 0]}}",
        read_moveit_objects));
    REQUIRE(objects.size() == 2);
    CHECK(objects.at(0).obstacle.name == "octomap");
    CHECK(objects.at(0).frame == "map");
    const auto octree = std::get<Octree>(objects.at(0).obstacle.shapes.at(0));
    CHECK(octree.parts->list().size() == 1);
    CHECK(octree.pose.translation == Vec3(0, 0, 1));
    const auto& shapes = objects.at(1).obstacle.shapes;
    REQUIRE(shapes.size() == 2);
    CHECK(distance(Vec3(0.2, 0.2, 7), shapes[0]) == doctest::Approx(2));
    CHECK(distance(Vec3(3, -4, 10), shapes[1]) == doctest::Approx(7).epsilon(1e-3));
  }

  TEST_CASE("malformed meshes, planes and octomaps are refused with line and key") {
    const std::string triangle = "triangles: [{vertex_indices: [0, 1, 2]}], vertices: ";
    CHECK(object_failure("meshes: [{vertices: []}], mesh_poses: [{position: [0, 0, 0]}]") ==
          "f:2: key collision_objects[0].meshes[0]: expected a mesh with a triangle that has an "
          "area");
    CHECK(contains(object_failure("meshes: [{" + triangle +
                                  "[[0, 0, 0]]}], mesh_poses: [{position: [0, 0, "
                                  "0]}]"),
                   "expected the index of one of 1 vertices, got 1"));
    CHECK(contains(object_failure("planes: [{coef: [0, 0, 1, 0]}]"),
                   "expected one pose per shape, got 1 planes and 0 poses"));
    CHECK(contains(
        object_failure("planes: [{coef: [0, 0, 0, 1]}], plane_poses: [{position: [0, 0, 0]}]"),
        "expected a normal that is not zero"));
    CHECK(contains(
        failure_of("octomap: {octomap: {binary: true, id: OcTree, resolution: 0.1, data: [2]}}",
                   read_moveit_objects),
        "ends within its tree"));
    CHECK(contains(failure_of("octomap: {octomap: {id: X, data: [2]}}", read_moveit_objects),
                   "expected OcTree or ColorOcTree"));
  }

  TEST_CASE("objects that are malformed are refused with line and key") {
    CHECK(
        object_failure("primitives: [{type: box, dimensions: [1, 1]}], " + kPose) ==
        "f:2: key collision_objects[0].primitives[0].dimensions: expected 3 numbers (full extents "
        "along x, y, z in metres), got a list of 2");
    CHECK(
        object_failure("primitives: [{type: sphere, dimensions: [-1]}], " + kPose) ==
        "f:2: key collision_objects[0].primitives[0].dimensions[0]: expected a number above 0, got "
        "-1");
    CHECK(object_failure("primitives: [{type: cube, dimensions: [1, 1, 1]}], " + kPose) ==
          "f:2: key collision_objects[0].primitives[0].type: expected box, sphere, cylinder or "
          "cone, got "
          "\"cube\"");
    CHECK(object_failure("primitives: [{type: sphere, dimensions: [1]}]") ==
          "f:2: key collision_objects[0]: object \"x\": expected one pose per shape, got 1 "
          "primitives "
          "and 0 poses");
    CHECK(object_failure("primitives: []") ==
          "f:2: key collision_objects[0]: object \"x\": expected at least one primitive, mesh or "
          "plane");
    CHECK(object_failure("colour: red").find("f:2: key collision_objects[0].colour: unknown key") ==
          0);
    CHECK(failure_of("collision_objects: [{id: \"\"}]", read_moveit_objects) ==
          "f:1: key collision_objects[0].id: expected a name, got \"\"");
    CHECK(failure_of("collision_objects: [{id: a name that is longer than others, header: "
                     "{frame_id: []}}]",
                     read_moveit_objects) ==
          "f:1: key collision_objects[0].header.frame_id: expected a text, got a list of 0");
    const std::string ball =
        "{id: x, primitives: [{type: sphere, dimensions: [1]}], " + kPose + "}";
    CHECK(failure_of("collision_objects: [" + ball + ", " + ball + "]", read_moveit_objects) ==
          "f:1: key collision_objects[1]: expected a unique name, got \"x\" again");
  }
}

using internal::Input;
using internal::MoveitFrames;

/// Where the origin of `frame` is in the root link's frame; the robot has the links root and head.
Result<Vec3> origin(const std::string& yaml, const std::string& frame) {
  return read_yaml(yaml, [&](const Input& input) {
    const auto state = input.find("robot_state");
    const MoveitFrames frames(
        input, state ? internal::read_moveit_state(*state) : internal::MoveitState{});
    return frames
        .pose_in_root(frame, input,
                      [](const std::string& name, const Input&) -> std::optional<Transform> {
                        if (name == "root") return Transform{};
                        if (name == "head")
                          return Transform{Eigen::Matrix3d::Identity(), Vec3(0, 0, 1)};
                        return std::nullopt;
                      })
        .translation;
  });
}

const std::string kBase =
    "robot_state: {multi_dof_joint_state: {header: {frame_id: world}, joint_names: [v], "
    "transforms: [{translation: [1, 0, 0], rotation: [0, 0, 0, 1]}]}}\n";
const std::string kCamera =
    "fixed_frame_transforms: [{header: {frame_id: camera}, child_frame_id: world, transform: "
    "{translation: [0, 5, 0], rotation: [0, 0, 0, 1]}}]\n";

TEST_SUITE("unit") {
  TEST_CASE("links are frames whatever the scene says") {
    CHECK(origin("{}", "root").value() == Vec3(0, 0, 0));
    CHECK(origin(kBase + kCamera, "head").value() == Vec3(0, 0, 1));
  }

  TEST_CASE("the planning frame is where the virtual joint poses the robot") {
    CHECK(origin(kBase, "world").value() == Vec3(-1, 0, 0));
    CHECK(origin(kBase, "").value() == Vec3(-1, 0, 0));
    CHECK(origin(kCamera, "world").value() == Vec3(0, 0, 0));
  }

  TEST_CASE("fixed frames are given in the planning frame") {
    CHECK(origin(kBase + kCamera, "camera").value() == Vec3(-1, 5, 0));
  }

  TEST_CASE("a frame that nobody knows is refused") {
    CHECK(
        origin(kBase, "table").error().message ==
        "f:1: expected a frame that is a link of the robot, the planning frame \"world\" or one of "
        "the fixed_frame_transforms, got \"table\"");
    CHECK(origin("{}", "table").error().message ==
          "f:1: expected a frame that is a link of the robot or one of the fixed_frame_transforms, "
          "got \"table\"");
    CHECK_FALSE(origin("{}", "").has_value());
    CHECK(origin(kCamera +
                     "robot_state: {multi_dof_joint_state: {header: {frame_id: moon}, joint_names: "
                     "[v], transforms: [{translation: [1, 0, 0]}]}}\n",
                 "world")
              .error()
              .message ==
          "f:1: expected the robot's pose in the planning frame \"world\", got one "
          "in \"moon\"");
  }

  TEST_CASE("fixed frames of two planning frames are refused") {
    CHECK(
        origin(
            "fixed_frame_transforms:\n"
            "  - {child_frame_id: a, header: {frame_id: a}, transform: {translation: [0, 0, 0]}}\n"
            "  - {child_frame_id: b, header: {frame_id: a}, transform: {translation: [0, 0, 0]}}",
            "root")
            .error()
            .message ==
        "f:3: key fixed_frame_transforms[1].child_frame_id: expected the planning "
        "frame \"a\" as in the entries before, got \"b\"");
  }
}

std::string ball(const std::string& name, const std::string& frame) {
  return "{id: " + name + ", header: {frame_id: " + frame +
         "}, primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [1, 0, "
         "0]}]}";
}

std::string world(const std::string& objects) {
  return "world: {collision_objects: [" + objects + "]}\n";
}

internal::MoveitScene read_planning_scene(const Input& input) {
  return internal::read_moveit_scene(input, "f");
}

Result<FramedScene> place(const std::string& yaml) {
  return parse_scene(yaml, "f.yaml").and_then([&](const Scene&) {
    return read_yaml(yaml, [](const Input& input) {
      const internal::MoveitScene scene = read_planning_scene(input);
      return internal::place_objects(scene, internal::MoveitFrames(input, scene.state));
    });
  });
}

TEST_SUITE("unit") {
  TEST_CASE("planning scenes are told from mneme's own by their keys") {
    const auto is_moveit = [](const std::string& yaml) {
      return read_yaml(yaml, internal::is_moveit_scene).value();
    };
    CHECK(is_moveit("world: {}"));
    CHECK(is_moveit("robot_state: {}"));
    CHECK_FALSE(is_moveit("obstacles: []"));
    CHECK_FALSE(is_moveit("[world]"));
  }

  TEST_CASE("what does not change the obstacles is read over") {
    const auto scene = require(read_yaml(
        "name: \"\"\nrobot_model_name: fetch\nobject_colors: [{id: a}]\nlink_padding: [{link_name: "
        "hand, padding: 0}]\nlink_scale: [{link_name: hand, scale: 1.0}]\nis_diff: true\n" +
            world(ball("a", "base")),
        read_planning_scene));
    CHECK(scene.name == "f");
    CHECK(scene.robot_name == "fetch");
    CHECK(scene.objects.size() == 1);
  }

  TEST_CASE("a box and a cylinder of MoveIt without thickness are 0.1 mm thick, with a warning") {
    const auto scene = require(parse_scene(
        world("{id: a, primitives: [{type: 1, dimensions: [1, 0, 2]}, {type: 3, dimensions: [0, "
              "0.5]}], primitive_poses: [{position: [1, 0, 0]}, {position: [1, 0, 0], orientation: "
              "[0, 0, 0, 0.5]}]}"),
        "f"));
    CHECK(std::get<Box>(scene.obstacles.at(0).shapes.at(0)).half_extents == Vec3(0.5, 0.5e-4, 1));
    const auto& plate = std::get<Cylinder>(scene.obstacles[0].shapes.at(1));
    CHECK(plate.length == 1e-4);
    CHECK(plate.radius == 0.5);
    REQUIRE(scene.warnings.size() == 2);
    CHECK(scene.warnings[0] ==
          "f:1: key world.collision_objects[0].primitives[0].dimensions[1]: a size of 0 is taken "
          "for 0.1 mm (and 1 more)");
    CHECK(contains(scene.warnings[1],
                   "primitive_poses[1].orientation: the quaternion's length is not "
                   "1"));
  }

  TEST_CASE("a cone is taken for the cylinder around it, and types may be in capitals") {
    const auto scene = require(parse_scene(
        world("{id: a, primitives: [{type: CONE, dimensions: [0.4, 0.1]}], primitive_poses: "
              "[{position: [1, 0, 0]}]}"),
        "f"));
    const auto& around = std::get<Cylinder>(scene.obstacles.at(0).shapes.at(0));
    CHECK(around.length == 0.4);
    CHECK(around.radius == 0.1);
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0].ends_with("type: a cone is taken for the cylinder around it"));
  }

  TEST_CASE("what was read over is told with a scene that has no robot") {
    const auto scene = require(parse_scene("is_diff: true\n" + world(ball("a", "base")), "f"));
    REQUIRE(scene.warnings.size() == 1);
    CHECK(
        scene.warnings[0] ==
        "f:1: key is_diff: only the difference to another scene is given; it is read as the whole "
        "scene");
  }

  TEST_CASE("links that are padded or scaled are refused by name") {
    CHECK(failure_of("link_padding: [{link_name: hand, padding: 0.02}]", read_planning_scene) ==
          "f:1: key link_padding[0]: link \"hand\" has the padding 0.02; expected 0: other values "
          "are "
          "not supported");
    CHECK(
        failure_of("link_scale: [{link_name: hand, scale: 1.1}]", read_planning_scene) ==
        "f:1: key link_scale[0]: link \"hand\" has the scale 1.1; expected 1: other values are not "
        "supported");
    CHECK(failure_of("worlds: {}", read_planning_scene)
              .find("f:1: key worlds: unknown key, expected one of ") == 0);
    CHECK(failure_of("is_diff: maybe", read_planning_scene) ==
          "f:1: key is_diff: expected true or false, got \"maybe\"");
  }

  TEST_CASE("what only a request uses of a planning scene is named in a warning") {
    const auto warnings = [](const std::string& more) {
      return require(parse_scene(world(ball("a", "base")) + "\n" + more, "f.yaml")).warnings;
    };
    CHECK(warnings("allowed_collision_matrix: {entry_names: []}\n").empty());
    const auto matrix = warnings(
        "allowed_collision_matrix: {entry_names: [a, b], entry_values: [{enabled: [true, true]}, "
        "{enabled: [true, true]}]}\n");
    REQUIRE(matrix.size() == 1);
    CHECK_MESSAGE(contains(matrix[0], "key allowed_collision_matrix: is not used"), matrix[0]);
    CHECK(warnings("robot_state: {joint_state: {name: [j], position: [1]}}\n").size() == 1);
    CHECK(warnings("").empty());
    // A root without children.
    const auto scene = require(parse_scene(
        "world: {octomap: {header: {frame_id: base}, octomap: {binary: true, id: OcTree, "
        "resolution: 0.1, data: [0, 0]}}}\n",
        "f.yaml"));
    CHECK(scene.obstacles.empty());
    REQUIRE(scene.warnings.size() == 1);
    CHECK(contains(scene.warnings[0], "no leaf is occupied, and the octomap is left out"));
  }

  TEST_CASE("without a robot all objects share a frame, which is named") {
    const FramedScene scene = place(world(ball("a", "base") + ", " + ball("b", "base"))).value();
    CHECK(scene.frame == "base");
    CHECK(scene.scene.obstacles.size() == 2);
    CHECK(contains(place(world(ball("a", "base") + ", " + ball("b", "tool"))).error().message,
                   "object \"b\" is given in frame \"tool\", others in \"base\""));
  }

  TEST_CASE("without a robot the virtual joint still says where the root link is") {
    const FramedScene scene =
        place(
            "robot_state: {multi_dof_joint_state: {header: {frame_id: world}, joint_names: [v], "
            "transforms: [{translation: [0, 0, 2]}]}}\n" +
            world(ball("a", "world")))
            .value();
    CHECK(scene.frame.empty());
    CHECK(std::get<Sphere>(scene.scene.obstacles.at(0).shapes.at(0)).center == Vec3(1, 0, -2));
  }

  TEST_CASE("planes go on below the robot, wherever they and the robot are posed") {
    const std::string planes = world(
        "{id: floor, header: {frame_id: world}, planes: [{coef: [0, 0, 1, 0]}, {coef: [0, 3, 4, "
        "10]}], plane_poses: [{position: [500, 0, 0]}, {position: [0, 0, 700]}], primitives: "
        "[{type: sphere, dimensions: [1]}], primitive_poses: [{position: [3, 0, 0]}]}");
    const auto check = [](const std::vector<Shape>& shapes, const Vec3& root) {
      REQUIRE(shapes.size() == 3);
      CHECK(std::get<Sphere>(shapes[0]).center + root == Vec3(3, 0, 0));
      const auto centre = [&](std::size_t i) { return std::get<Box>(shapes[i]).pose.translation; };
      const Vec3 normal(0, 0.6, 0.8);
      CHECK((centre(1) - Vec3(0, 0, -root.z())).norm() < 1e-9);
      CHECK((centre(2) - (normal.dot(Vec3(0, 0, 700) - root) - 2) * normal).norm() < 1e-9);
    };
    check(place(planes).value().scene.obstacles.at(0).shapes, Vec3::Zero());
    const std::string robot_away =
        "robot_state: {multi_dof_joint_state: {header: {frame_id: world}, joint_names: [v], "
        "transforms: [{translation: [-900, 40, 2]}]}}\n";
    const auto away = require(place(robot_away + planes));
    CHECK(away.frame.empty());
    check(away.scene.obstacles.at(0).shapes, Vec3(-900, 40, 2));
    const auto with_robot = require(read_yaml(robot_away + planes, [](const Input& input) {
      const internal::MoveitScene scene = read_planning_scene(input);
      return internal::place_objects(
          scene, MoveitFrames(input, scene.state),
          [](const std::string&, const Input&) { return std::optional<Transform>(); });
    }));
    check(with_robot.obstacles.at(0).shapes, Vec3(-900, 40, 2));
  }
}

}  // namespace
}  // namespace mneme::test
