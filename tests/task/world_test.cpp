// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/world.h"
#include "line/floating_body.h"
#include "problem/small_robots.h"
#include "task/small_tasks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>

namespace mneme::test {
namespace {

using internal::FloatingBody;
using internal::World;

/// The world after the first stages, all at the task's start.
World world_after(const Task& task, std::size_t stages) {
  World world = internal::first_world(task);
  for (std::size_t i = 0; i < stages; ++i) {
    world = require(internal::after_stage(world, task.stages[i], task.start));
    CHECK(CollisionChecker::make(world.robot, world.scene).has_value());
  }
  return world;
}

TEST_SUITE("unit") {
  TEST_CASE(
      "a gripper stage sets joints outside of the group, also of a robot that holds something") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    write_file(directory / "task.yaml",
               "robot: lifter.urdf\ngroup: \"world:arm\"\nstart: [0, 0]\n"
               "attached: [{name: ball, link: finger, type: sphere, position: [0.2, 0, 0], radius: "
               "0.05}]\nscene: {obstacles: []}\n"
               "stages: [{gripper: {grip: 0.03}}, {move: [0.5, 1]}]\n");
    const auto task = require(load_task(directory / "task.yaml"));
    const TaskResult result = solved(task);
    check_plan(task, result);
    Task wrong = task;
    wrong.stages[0].values["grip"] = 0.6;
    CHECK(require_error(check_task(wrong)).message ==
          "stage 'gripper 1': joint 'grip' is to be at 0.6, beyond its limits [0, 0.05]");
    Task blocked = task;
    const Vec3 place =
        task.robot.link_poses(task.start)[static_cast<std::size_t>(*task.robot.find_link("finger"))]
            .translation;
    blocked.scene.obstacles.push_back({"block", {Sphere{place, 0.3}}});
    const TaskResult in_contact = solved(blocked);
    CHECK(in_contact.status == PlanStatus::invalid_start);
    CHECK_MESSAGE(in_contact.message.starts_with("stage 'gripper 1': start is in contact: "),
                  in_contact.message);
    const auto& gripper = result.stages[0].gripper;
    REQUIRE(gripper != nullptr);
    CHECK(gripper->world->robot.joint_names() == std::vector<std::string>{"lift", "turn", "grip"});
    CHECK(gripper->path == Path{{0, 0, 0}, {0, 0, 0.03}});
    const auto limits = require(find_rate_limits(task.robot));
    const auto motion = require(time_task(task, result, {}, limits));
    REQUIRE(motion.stages[0].has_value());
    CHECK(motion.begins_s[1] == doctest::Approx(motion.stages[0]->duration_s()));
    CHECK(motion.begins_s[1] > 0.03);
    for (double time = 0; time < motion.begins_s[1]; time += 1e-3) {
      CHECK(motion.trajectory.at(time).position == task.start);
      CHECK(motion.stages[0]->at(time).velocity[2] <= 1);
    }
    write_file(directory / "limits.yaml", "joint_limits: {grip: {max_velocity: 0.01}}\n");
    const auto slow = require(time_task(task, result, {}, limits, {}, directory / "limits.yaml"));
    for (double time = 0; time < slow.begins_s[1]; time += 1e-3) {
      CHECK(std::abs(slow.stages[0]->at(time).velocity[2]) <= 0.01 * (1 + 1e-9));
    }
    const Robot& robot = result.stages[1].world->robot;
    const auto grip = std::ranges::find(robot.joints(), "grip", &Joint::name);
    CHECK(grip->fixed_value == 0.03);
    CHECK(robot.attached().size() == 1);
    CHECK(robot.self_pairs().size() == task.robot.self_pairs().size());
    const auto finger = static_cast<std::size_t>(*robot.find_link("finger"));
    const Vec3 moved = robot.link_poses(task.start)[finger].translation -
                       task.robot.link_poses(task.start)[finger].translation;
    CHECK(moved.norm() == doctest::Approx(0.03));
  }

  TEST_CASE("CSV has the fingers' motions: where they are before, while and after they move") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    write_file(directory / "task.yaml",
               "robot: lifter.urdf\ngroup: \"world:arm\"\nstart: [0, 0]\nscene: {obstacles: []}\n"
               "stages: [{move: [0.5, 1]}, {gripper: {grip: 0.03}}, {move: [0, 0]}, "
               "{gripper: {grip: 0.01}}]\n");
    const Task task = load_task(directory / "task.yaml").value();
    const TaskResult result = solved(task);
    const TaskMotion motion =
        time_task(task, result, {}, find_rate_limits(task.robot).value()).value();
    const auto points = motion.trajectory.sample(0.01).value();
    std::istringstream text(to_csv(task.robot, points, stage_begins(result, motion)));
    std::string line;
    std::getline(text, line);
    CHECK(line.ends_with(",turn.acceleration,grip.position,grip.velocity,grip.acceleration,stage"));
    double last = 0, most = 0;
    int moving = 0;
    for (const auto& point : points) {
      REQUIRE(std::getline(text, line));
      std::vector<std::string> cells;
      for (std::istringstream row(line); std::getline(row, line, ',');) cells.push_back(line);
      REQUIRE(cells.size() == 1 + 3 * 2 + 3 + 1);
      last = std::stod(cells[7]);
      most = std::max(most, last);
      const std::string& stage = cells.back();
      if (point.time_s < motion.begins_s[1]) CHECK(last == 0);
      if (stage == "move 3") CHECK(last == 0.03);
      if (std::stod(cells[8]) == 0) continue;
      ++moving;
      CHECK(stage.starts_with("gripper"));
      CHECK(std::abs(std::stod(cells[8])) <= 1);
    }
    CHECK(moving >= 10);
    CHECK(most == 0.03);
    CHECK(last == doctest::Approx(0.01));
  }

  TEST_CASE("a gripper stage may name a state of the SRDF that leaves the group alone") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    const auto try_with = [&](const std::string& states, const std::string& name) {
      write_file(directory / "lifter.srdf", "<robot name=\"lifter\">" + states + "</robot>");
      write_file(directory / "task.yaml",
                 "robot: lifter.urdf\nsrdf: lifter.srdf\ngroup: \"world:arm\"\nstart: [0, 0]\n"
                 "scene: {obstacles: []}\nstages: [{gripper: " +
                     name + "}]\n");
      return load_task(directory / "task.yaml");
    };
    const auto state = [](const std::string& name, const std::string& group,
                          const std::string& values) {
      std::string text = "<group_state name=\"" + name + "\" group=\"" + group + "\">";
      return text + values + "</group_state>";
    };
    const std::string grip = R"(<joint name="grip" value="0.03"/>)";
    const std::string groups =
        R"(<group name="hand"><joint name="grip"/></group>
           <group name="all"><joint name="turn"/><joint name="grip"/></group>)";
    const std::string states = groups + state("open", "hand", grip) +
                               state("home", "all", grip + R"(<joint name="turn" value="1"/>)");
    const auto task = require(try_with(states, "open"));
    CHECK(task.stages[0].values == std::map<std::string, double>{{"grip", 0.03}});
    check_plan(task, solved(task));
    for (const char* name : {"home", "opne"}) {
      const std::string message = require_error(try_with(states, name)).message;
      CHECK_MESSAGE(contains(message, "for joints outside of the planning group (open), got \"" +
                                          std::string(name) + "\""),
                    message);
    }
    const std::string twice = states + state("open", "all", R"(<joint name="grip" value="0"/>)");
    const std::string message = require_error(try_with(twice, "open")).message;
    CHECK_MESSAGE(contains(message, "the groups hand and all have a state \"open\" each"), message);
  }

  TEST_CASE("fingers that are free at both ends may not pass through what is in between") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    const std::string before =
        "robot: lifter.urdf\ngroup: \"world:arm\"\nstart: [0, 0]\n"
        "attached: [{name: ball, link: finger, type: sphere, position: [0.3, 0, 0], radius: "
        "0.004}]\n";
    const auto solved_with = [&](double away) {
      // The finger moves along y.
      write_file(directory / "task.yaml",
                 before +
                     fmt::format("scene: {{obstacles: [{{name: pin, type: sphere, position: "
                                 "[{}, 0.325, 0.5], radius: 0.004}}]}}\n",
                                 away) +
                     "stages: [{name: open, gripper: {grip: 0.05}}]\n");
      return solved(require(load_task(directory / "task.yaml")));
    };
    CHECK(solved_with(0.02).is_solved());
    const TaskResult blocked = solved_with(0);
    CHECK(blocked.status == PlanStatus::invalid_goal);
    CHECK(blocked.message == "stage 'open': contact ('ball' with 'pin' while the gripper moves)");
  }

  TEST_CASE("fingers may close until they touch, but not pass through each other") {
    const std::string fingers = R"(<robot name="gripper"><link name="base"/>
      <link name="palm"/>
      <link name="left">
        <collision><geometry><sphere radius="0.02"/></geometry></collision>
        <collision><origin xyz="0 0 0.15"/><geometry><sphere radius="0.02"/></geometry></collision>
      </link>
      <link name="right"><collision><geometry><sphere radius="0.02"/></geometry></collision></link>
      <link name="rod"><collision><origin xyz="0 0 0.15"/>
        <geometry><sphere radius="0.09"/></geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="palm"/>
        <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
      <joint name="close_left" type="prismatic"><parent link="palm"/><child link="left"/>
        <origin xyz="0 -0.05 0"/><axis xyz="0 1 0"/>
        <limit lower="0" upper="0.2" effort="1" velocity="1"/></joint>
      <joint name="close_right" type="prismatic"><parent link="palm"/><child link="right"/>
        <origin xyz="0 0.05 0"/><axis xyz="0 -1 0"/>
        <limit lower="0" upper="0.2" effort="1" velocity="1"/></joint>
      <joint name="follow" type="prismatic"><parent link="palm"/><child link="rod"/>
        <origin xyz="0 -0.05 0"/><axis xyz="0 1 0"/><mimic joint="close_left" multiplier="0.5"/>
        <limit lower="0" upper="0.1" effort="1" velocity="1"/></joint></robot>)";
    const TemporaryDirectory directory;
    write_file(directory / "gripper.urdf", fingers);
    const auto result_of = [&](double left, double right, const std::string& more = "") {
      write_file(directory / "task.yaml",
                 fmt::format("robot: gripper.urdf\ngroup: \"base:palm\"\nstart: [0]\n{}"
                             "stages: [{{name: close, gripper: {{close_left: {}, close_right: "
                             "{}}}}}]\n",
                             more.empty() ? "scene: {obstacles: []}\n" : more, left, right));
      return solved(require(load_task(directory / "task.yaml")));
    };
    const TaskResult open = result_of(0.02, 0.02), closed = result_of(0.03, 0.031);
    REQUIRE(open.is_solved());
    CHECK(closed.is_solved());
    // The rod touches the left finger at any value of their joint.
    const auto pairs = open.stages[0].gripper->world->robot.self_pairs();
    CHECK(pairs.size() == 2);
    const TaskResult crossed = result_of(0.1, 0.1);
    CHECK_FALSE(crossed.is_solved());
    CHECK(crossed.message ==
          "stage 'close': contact ('left' with 'right' while the gripper moves)");
    const auto holding = [](double x, double gap) {
      return fmt::format(
          "attached: [{{name: ball, link: palm, type: sphere, position: [{0}, 0, 0], radius: "
          "0.02}}]\n"
          "scene: {{obstacles: [{{name: shelf, type: sphere, position: [{0}, {1}, 0], radius: "
          "0.02}}]}}\n",
          x, 0.04 + gap);
    };
    for (const double overlap : {1e-6, 1e-4, 3e-3}) {
      CAPTURE(overlap);
      CHECK(result_of(0.02, 0.02, holding(0.3, -overlap)).is_solved());
    }
    // Between the fingers, which it does not expect to touch it.
    CHECK(result_of(0.013, 0, holding(0, 0.5)).is_solved());
    const TaskResult pressed = result_of(0.02, 0, holding(0, 0.5));
    CHECK_FALSE(pressed.is_solved());
    CHECK_MESSAGE(contains(pressed.message, "contact ('left' with 'ball'"), pressed.message);
  }

  TEST_CASE("an object goes with the hand and stays where it is detached") {
    const Task task = make_task(kCell + kPickAndPlace);
    World world = internal::first_world(task);
    Configuration q = task.start;
    const auto hand = static_cast<std::size_t>(*task.robot.find_link("panda_hand"));
    const Transform X_WH = task.robot.link_poses(q)[hand];
    // Between the fingers.
    Transform shift;
    shift.translation = X_WH * Vec3(0, 0, 0.115) - Vec3(0.5, -0.1, 0.2505);
    REQUIRE(world.scene.move("cup", shift));
    world.poses["cup"] = shift * world.poses["cup"];
    const auto held = require(internal::after_stage(world, task.stages[2], q));
    CHECK(held.scene.find("cup") == nullptr);
    q[0] += 0.3;
    const auto left = require(internal::after_stage(held, task.stages[6], q));
    CHECK(left.robot.attached().empty());
    const Transform turn{rotation_about(Vec3::UnitZ(), 0.3), Vec3::Zero()};
    const Transform expected = turn * world.poses["cup"];
    CHECK((left.poses.at("cup").translation - expected.translation).norm() < 1e-9);
    const auto& cup = *std::get_if<Cylinder>(&left.scene.find("cup")->shapes.front());
    CHECK((cup.pose.translation - expected.translation).norm() < 1e-9);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("contact that is allowed with an obstacle stays allowed once it is held") {
    const Task task = make_task(kCell + "stages: [{allow: [[panda_link5, cup]]}, {attach: cup}]\n");
    const World world = internal::first_world(task);
    const auto allowed = require(internal::after_stage(world, task.stages[0], task.start));
    const auto held = require(internal::after_stage(allowed, task.stages[1], task.start));
    CHECK(held.robot.attached()[0].object.may_touch == std::vector<std::string>{"panda_link5"});
  }

  TEST_CASE("contact that a stage allows stays allowed when an object is taken again") {
    const std::string lid =
        "    - {name: lid, type: box, position: [0.5, 0.2, 0.31], size: [0.1, 0.1, 0.02]}\n";
    const Task task = make_task(kCell + lid +
                                "stages: [{attach: cup}, {allow: [[cup, table], [lid, cup]]}, "
                                "{attach: lid}, {detach: cup}, {detach: lid}, {attach: cup}]\n");
    const std::vector<std::string> cup = {"cup"}, none;
    const World both = world_after(task, 3);
    CHECK(both.robot.attached()[1].object.may_touch == cup);
    CHECK(both.scene.find("table")->may_touch == cup);
    const World left = world_after(task, 4);
    CHECK(left.scene.find("table")->may_touch == none);
    CHECK(left.scene.find("cup")->may_touch == std::vector<std::string>{"lid"});
    CHECK(world_after(task, 5).scene.find("lid")->may_touch == none);
    const World again = world_after(task, 6);
    CHECK(again.scene.find("table")->may_touch == cup);
    CHECK(again.scene.find("lid")->may_touch == cup);
  }

  TEST_CASE("contact of an obstacle at ends stays allowed once it is held") {
    const Task task = make_task(kCell +
                                "allow: [{pair: [panda_link5, cup], at_ends: 0.01}]\n"
                                "stages: [{attach: cup}, {detach: cup}]\n");
    for (const std::size_t stages : {1u, 2u}) {
      CHECK(world_after(task, stages).scene.end_contacts == task.scene.end_contacts);
    }
  }

  TEST_CASE("a thin object is free where it rests on something, held or not") {
    const std::string rod = "type: capsule, a: [-0.05, 0, 0.12], b: [0.05, 0, 0.12], radius: 0.008";
    const Task task = make_task(kCell + "    - {name: bar, " + rod +
                                "}\nattached: [{name: rod, link: panda_hand, " + rod +
                                "}]\nstages: [{detach: rod}]\n");
    const World world = internal::first_world(task);
    const auto lying = [](double z) {
      return Transform{rotation_about(Vec3::UnitY(), 0.5 * std::numbers::pi),
                       Vec3(0.45, 0.2, 0.2 + z)};
    };
    const std::vector<Transform> poses = {lying(0.0085), lying(0.006), lying(-0.002)};
    const auto held = require(
        FloatingBody::of_object(world.robot, world.scene, "rod", world.held.at("rod").X_LO, {}));
    const auto bar = require(
        FloatingBody::of_obstacle(world.robot, world.scene, "bar", world.poses.at("bar"), {}));
    // Not with its axis in the table.
    const std::vector<std::uint8_t> expected = {1, 1, 0};
    CHECK(held.find_free(poses) == expected);
    CHECK(bar.find_free(poses) == expected);
    // A thick one may be 2 cm deep, and no more.
    const auto cup = require(
        FloatingBody::of_obstacle(world.robot, world.scene, "cup", world.poses.at("cup"), {}));
    const auto standing = [](double z) {
      return Transform{Eigen::Matrix3d::Identity(), Vec3(0.45, 0.2, 0.25 + z)};
    };
    CHECK(cup.find_free({standing(0), standing(-0.06)}) == std::vector<std::uint8_t>{1, 0});
  }

  TEST_CASE("an object of a mesh file is an obstacle with this surface once it is detached") {
    const TemporaryDirectory directory;
    std::string cube;
    for (int i = 0; i < 8; ++i) {
      const auto side = [i](int bit) { return (i >> bit & 1) != 0 ? 0.02 : -0.02; };
      cube += fmt::format("v {} {} {}\n", side(0), side(1), side(2));
    }
    write_file(directory / "cube.obj",
               cube + "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n");
    const std::string file = "type: mesh, file: cube.obj, position: [0, 0, 0.07]";
    for (const std::string& shapes :
         {file, "shapes: [{type: sphere, position: [0, 0, 0.07], radius: 0.01}, {" + file + "}]"}) {
      CAPTURE(shapes);
      write_file(directory / "task.yaml", kCell + "attached: [{name: cube, link: panda_hand, " +
                                              shapes + "}]\nstages: [{detach: cube}]\n");
      const Task task = require(load_task(directory / "task.yaml"));
      const World held = internal::first_world(task), left = world_after(task, 1);
      const auto hand = static_cast<std::size_t>(*task.robot.find_link("panda_hand"));
      const Vec3 middle = task.robot.link_poses(task.start)[hand] * Vec3(0, 0, 0.07);
      CHECK((left.poses.at("cube").translation - middle).norm() < 1e-9);
      const Shape& last = left.scene.find("cube")->shapes.back();
      REQUIRE(std::holds_alternative<Mesh>(last));
      const Sphere bound = bounding_sphere(last);
      CHECK((bound.center - middle).norm() < 1e-3);
      CHECK(bound.radius == doctest::Approx(0.02 * std::sqrt(3)).epsilon(0.1));
      // A side is in the hand, which now touches it.
      const auto is_free = [&](const World& world) {
        return require(CollisionChecker::make(world.robot, world.scene)).is_valid(task.start);
      };
      CHECK(is_free(held));
      CHECK_FALSE(is_free(left));
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("a floating hand touches what the hand of the arm touches") {
    const Task task = make_task(kCell + kPickAndPlace);
    const World world = internal::first_world(task);
    const auto body = require(FloatingBody::of_link(world.robot, world.scene, "panda_hand", {}));
    const auto checker = require(CollisionChecker::make(task.robot, task.scene));
    const auto hand = static_cast<std::size_t>(*task.robot.find_link("panda_hand"));
    Rng rng(5);
    int touching = 0;
    for (int i = 0; i < rounds(400); ++i) {
      const Configuration q = random_configuration(task.robot, rng);
      const bool is_touching = std::ranges::any_of(checker.contacts(q), [](const Contact& contact) {
        const bool is_of_hand = contact.link == "panda_hand" || contact.link == "panda_link7" ||
                                contact.link.ends_with("finger");
        return !contact.is_self && is_of_hand;
      });
      touching += is_touching ? 1 : 0;
      const auto is_free = body.find_free({task.robot.link_poses(q)[hand]});
      CHECK((is_free.front() == 0) == is_touching);
    }
    CHECK(touching > 10);
  }
}

}  // namespace
}  // namespace mneme::test
