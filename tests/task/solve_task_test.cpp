// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/goal.h"

#include "task/small_tasks.h"
#include "geometry/parts.h"
#include "task/look_ahead.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

namespace mneme::test {
namespace {

TEST_SUITE("flow") {
  TEST_CASE("a cup is taken, carried and put down, and every stage is free by exact distances") {
    const Task task = make_task(kCell + kPickAndPlace);
    const TaskResult result = solved(task);
    check_plan(task, result);
    CHECK(result.stages[1].alternatives == 30);
    CHECK(result.stages[1].alternative >= 0);
    CHECK(result.stages[5].alternatives == 12);
    // The cup stands at the chosen place.
    const Scene& scene = result.stages.back().world->scene;
    const auto& cup = *std::get_if<Cylinder>(&scene.find("cup")->shapes.front());
    const Vec3 place = task.stages[5]
                           .poses.poses[static_cast<std::size_t>(result.stages[5].alternative)]
                           .translation;
    CHECK((cup.pose.translation - place).norm() < 3e-4);
    // It moves with the hand in between.
    CHECK(result.stages[4].world->robot.attached().size() == 1);
    CHECK(result.stages[4].world->scene.find("cup") == nullptr);
  }

  TEST_CASE("the hand stays on its line within a millimetre") {
    const Task task = make_task(kCell + kPickAndPlace);
    const TaskResult result = solved(task);
    REQUIRE(result.is_solved());
    const auto link = static_cast<std::size_t>(*task.robot.find_link("panda_hand"));
    for (const std::size_t i : {1u, 3u, 5u, 7u}) {
      const StageResult& stage = result.stages[i];
      INFO(stage.name);
      const Robot& robot = stage.world->robot;
      const Vec3 from = robot.link_poses(stage.path.front())[link].translation;
      const Vec3 to = robot.link_poses(stage.path.back())[link].translation;
      CHECK((to - from).norm() == doctest::Approx(i == 3 ? 0.1 : 0.08).epsilon(0.01));
      for (const Configuration& q : stage.path) {
        const Vec3 at = robot.link_poses(q)[link].translation - from;
        CHECK((at - at.dot((to - from).normalized()) * (to - from).normalized()).norm() < 1e-3);
      }
    }
  }

  TEST_CASE("the same seed gives the same plan") {
    const Task task = make_task(kCell + kPickAndPlace);
    const TaskResult first = solved(task), second = solved(task);
    REQUIRE(first.is_solved());
    REQUIRE(first.stages.size() == second.stages.size());
    CHECK(first.states_checked == second.states_checked);
    for (std::size_t i = 0; i < first.stages.size(); ++i) {
      CHECK(first.stages[i].path == second.stages[i].path);
      CHECK(first.stages[i].alternative == second.stages[i].alternative);
    }
  }

  TEST_CASE("without time, and once cancelled, there is no plan") {
    const Task task = make_task(kCell + kPickAndPlace);
    TaskSettings settings;
    settings.solve.plan.timeout_s = 0;
    const TaskResult late = solved(task, nullptr, settings);
    CHECK(late.status == PlanStatus::timeout);
    CHECK(late.preparation_time_s > 0);
    CHECK(late.total_time_s >= late.preparation_time_s);
    const std::atomic<bool> cancel = true;
    settings = {};
    settings.solve.plan.cancel = &cancel;
    CHECK(solved(task, nullptr, settings).status == PlanStatus::cancelled);
  }

  TEST_CASE("improvement of the moves means that of the task") {
    const Task task = make_task(kCell + kPickAndPlace);
    TaskSettings own, moves;
    own.solve.plan.timeout_s = moves.solve.plan.timeout_s = 1000;
    own.improve = moves.solve.plan.improve = 1000;
    own.improve_plans = 3;
    moves.solve.plan.improve_rounds = 3;
    const TaskResult expected = solved(task, nullptr, own), result = solved(task, nullptr, moves);
    CHECK(result.plans == expected.plans);
    CHECK(result.plans > 1);
    CHECK(result.path_time_s == expected.path_time_s);
    moves.solve.plan.improve = 0;
    CHECK_FALSE(solve_task(task, nullptr, moves).has_value());
  }

  TEST_CASE("improvement returns a plan that takes no longer than the first") {
    const Task task = make_task(kCell + kPickAndPlace);
    TaskSettings settings;
    settings.improve = 1000;
    settings.solve.plan.timeout_s = 3;
    settings.improve_plans = 3;
    const TaskResult result = solved(task, nullptr, settings);
    check_plan(task, result);
    CHECK(result.path_time_s <= result.first_path_time_s);
  }

  std::string dropped_of(const TaskResult& result, const std::string& stage) {
    std::string text;
    for (const StageResult& each : result.stages) {
      if (each.name != stage) continue;
      for (const Dropped& dropped : each.dropped) {
        text += std::to_string(dropped.count) + " " + std::string(to_string(dropped.reason)) + " " +
                dropped.what + ";";
      }
    }
    return text;
  }

  TEST_CASE("places in an obstacle are refused with its name before any path is planned") {
    const std::string block =
        "    - {name: block, type: box, position: [0.45, 0.2, 0.3], size: [0.5, 0.4, 0.18]}\n";
    const Task task = make_task(kCell + block + kPickAndPlace);
    const TaskResult result = solved(task);
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(contains(result.message, "stage 'approach'"));
    CHECK(contains(result.message, "'cup' with 'block'"));
    CHECK(contains(dropped_of(result, "approach"), "at each pose of 'lower'"));
    CHECK(result.states_checked < 1000);
  }

  TEST_CASE("places of the next move are tested only for the hand that takes the object there") {
    const auto is_tested = [](const std::string& grasp) {
      const std::string old = "  - {name: grasp, attach: cup}\n";
      const Task task = make_task(kCell + replaced(kPickAndPlace, old, grasp + "\n"));
      const TaskSettings settings;
      internal::TaskRun run{task, settings, task.robot.link_poses(task.start)};
      const auto groups = require(internal::make_groups(task));
      return internal::LookAhead::make(run, groups.at(0), groups.at(1), internal::first_world(task),
                                       "panda_hand")
          .has_value();
    };
    const std::string attach = "  - {name: grasp, attach: cup}";
    CHECK(is_tested(attach));
    CHECK(is_tested(attach + "\n  - {line: {direction: [0, 0, 1], distance: 0.01}}"));
    CHECK_FALSE(is_tested("  - {line: {direction: [0, 0, 1], distance: 0.01}}\n" + attach));
    CHECK_FALSE(is_tested("  - {allow: [[panda_link5, cup]]}\n" + attach));
    CHECK_FALSE(is_tested("  - {name: grasp, attach: {object: cup, link: panda_link7}}"));
  }

  TEST_CASE("a line along another link begins where this link is after the move") {
    // At the start, this link's z axis points down: a line that began there would meet the lid.
    const std::string lid =
        "    - {name: lid, type: box, position: [0.5, -0.1, 0.345], size: [0.2, 0.2, 0.02]}\n";
    const std::string grasp = kPickAndPlace.substr(0, kPickAndPlace.find("  - {name: lift"));
    const Task task =
        make_task(kCell + lid + replaced(grasp, "along: panda_hand", "along: panda_link7"));
    check_plan(task, solved(task));
  }

  TEST_CASE("a cup out of reach is refused with the number of grasps") {
    const Task task =
        make_task(replaced(kCell, "[0.5, -0.1, 0.2505]", "[2.5, -0.1, 0.2505]") + kPickAndPlace);
    const TaskResult result = solved(task);
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(result.message ==
          "stage 'approach' of 30 alternatives: 30 times out of reach (link 'panda_hand')");
  }

  TEST_CASE("a goal beyond the limits is dropped with the reason where there are others") {
    const std::string far = "[0, 3, 0, -2.356, 0, 1.571, 0.785]",
                      free = "[0.3, -0.785, 0, -2.356, 0, 1.571, 0.785]";
    const Task task = make_task(kCell + "stages: [{name: go, move: {any: [" + far + ", " + free +
                                ", " + far + "]}}]\n");
    const TaskResult result = solved(task);
    check_plan(task, result);
    CHECK(result.stages[0].alternative == 1);
    CHECK(result.stages[0].alternatives == 3);
    const std::string dropped = dropped_of(result, "go");
    CHECK_MESSAGE(contains(dropped, "2 out of reach its goal: joint 'panda_joint2'"), dropped);
  }

  TEST_CASE("a pose is out of reach, or wrong in its rotation, as for inverse kinematics alone") {
    const TemporaryDirectory directory;
    // The tip cannot come nearer to the first joint than 0.5 m.
    write_file(directory / "two.urdf", R"(<robot name="two"><link name="base"/><link name="upper"/>
      <link name="fore"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
      <link name="tip"/>
      <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
      <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
      <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
      <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
      <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/>
      <origin xyz="0.5 0 0"/></joint></robot>)");
    for (const auto& [x, reason] :
         {std::pair("0.3", DropReason::reach), std::pair("1.2", DropReason::kinematics)}) {
      write_file(directory / "task.yaml",
                 std::string("robot: two.urdf\nstart: [0.3, 0.3]\nscene: {obstacles: []}\n") +
                     "stages: [{move: {link: tip, to: {position: [" + x + ", 0, 0]}}}]\n");
      const Task task = require(load_task(directory / "task.yaml"));
      const TaskResult result = solved(task);
      CHECK(result.status == PlanStatus::invalid_goal);
      INFO(result.message);
      REQUIRE(result.stages.size() == 1);
      REQUIRE(result.stages[0].dropped.size() == 1);
      CHECK(result.stages[0].dropped[0].reason == reason);
      CHECK(result.stages[0].dropped[0].what == "link 'tip'");
      const auto checker = require(CollisionChecker::make(task.robot, task.scene));
      PoseGoal goal;
      goal.link = "tip";
      goal.pose = task.stages[0].poses.poses[0];
      auto source = require(PoseGoalSource::make(checker, {&goal, 1}, task.start, {}, 0));
      CHECK(source.find_all().empty());
      CHECK(contains(source.describe_failure(), "out of reach") == (reason == DropReason::reach));
    }
  }

  TEST_CASE("grasps that are all in contact are refused with the bodies") {
    const std::string box =
        "    - {name: box, type: box, position: [0.5, -0.1, 0.3], size: [0.26, 0.3, 0.2]}\n";
    const TaskResult result = solved(make_task(kCell + box + kPickAndPlace));
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(contains(result.message, "30 times contact"));
    CHECK(contains(result.message, "with 'box'"));
  }

  TEST_CASE("links in touch may not slide along the object before they take it") {
    // From above, 16 mm and more beside a cup that is 5 mm too wide for the fingers on either side.
    const std::string wide = replaced(kCell, "radius: 0.035", "radius: 0.063");
    std::string stages = replaced(
        kPickAndPlace, "attach: cup",
        "attach: {object: cup, link: panda_hand, touch: [panda_leftfinger, panda_rightfinger]}");
    stages = replaced(stages, "[-0.115, 0, 0]", "[0, 0, 0.14]");
    stages = replaced(stages, "[0, 0.70710678, 0, 0.70710678]", "[1, 0, 0, 0]");
    stages = replaced(stages, "to: 0.03, count: 3", "to: 0.01, count: 3");
    const TaskResult result = solved(make_task(wide + stages));
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(contains(result.message, "stage 'approach'"));
  }

  TEST_CASE("what is held at the start may touch the hand no longer once it has left") {
    const std::string attached =
        "attached: [{name: ball, link: panda_hand, type: sphere, position: [0, 0, 0.115], radius: "
        "0.03, touch: [panda_link6]}]\n";
    const Task task = make_task(kCell + attached +
                                "stages: [{detach: ball}, {line: {direction: [0, 0, -1], along: "
                                "panda_hand, distance: 0.1}}, {move: [0.5, -0.785, 0, -2.356, 0, "
                                "1.571, 0.785]}]\n");
    const TaskResult result = solved(task);
    check_plan(task, result);
    const Scene& scene = result.stages[2].world->scene;
    REQUIRE(scene.find("ball") != nullptr);
    CHECK(scene.find("ball")->may_touch.empty());
    CHECK(scene.end_contacts.empty());
  }

  TEST_CASE("contact that a stage allows is allowed from then on") {
    const Task task = make_task(
        kCell +
        "stages: [{allow: [[panda_leftfinger, table]]}, {move: [0.5, -0.785, 0, -2.356, 0, "
        "1.571, 0.785]}]\n");
    const TaskResult result = solved(task);
    check_plan(task, result);
    CHECK(result.stages[0].world->scene.find("table")->may_touch.empty());
    CHECK(result.stages[1].world->scene.find("table")->may_touch ==
          std::vector<std::string>{"panda_leftfinger"});
  }

  TEST_CASE("a line ends at the first choice from which the stages after it are possible") {
    // From 15 cm above the start, the hand cannot go up by 35 cm more.
    const Task task = make_task(
        kCell +
        "stages: [{line: {link: panda_hand, to: {frame: panda_hand, poses: [{position: [0, 0, "
        "-0.15]}, {position: [0, 0, 0.1]}]}}}, {allow: [[panda_hand, table]]}, {line: {link: "
        "panda_hand, direction: [0, 0, 1], distance: 0.35}}]\n");
    const TaskResult result = solved(task);
    check_plan(task, result);
    CHECK(result.stages[0].alternative == 1);
  }

  TEST_CASE("a task whose start breaks a cone is refused before any search") {
    Task task = make_task(kCell + kPickAndPlace);
    OrientationConstraint upright;
    upright.link = "panda_hand";
    upright.axis = Vec3::UnitX();
    upright.up = Vec3::UnitZ();
    upright.angle = 0.2;
    task.constraints = {upright};
    TaskSettings settings;
    settings.solve.plan.timeout_s = 1000;
    const TaskResult result = solved(task, nullptr, settings);
    CHECK(result.status == PlanStatus::invalid_start);
    CHECK_MESSAGE(contains(result.message, "start: panda_hand is tilted by"), result.message);
    CHECK(result.states_checked < 5000);
  }

  TEST_CASE("a task refused by a move before its last group says why") {
    const std::string bent = "[0.8, -0.785, 0, -2.356, 0, 1.571, 0.785]";
    const TaskResult result = solved(make_task(
        kCell +
        "stages: [{name: turn, move: [0, -0.785, 0, -2.356, 0, 2.8, 0.785]}, {name: carry, "
        "move: " +
        bent +
        ", constraints: [{link: panda_hand, axis: [0, 0, -1], angle: 0.2}]}, {name: home, "
        "move: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]}]\n"));
    CHECK_FALSE(result.is_solved());
    CHECK_MESSAGE(
        result.message.find("stage 'carry': no path (start: panda_hand is tilted by") == 0,
        result.message);
  }

  TEST_CASE("a start that is invalid is told as such, whatever the first stage is") {
    const auto refused = [](const std::string& start, const std::string& first) {
      const TaskResult result = solved(make_task(
          replaced(kCell, "start: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]", "start: " + start) +
          "stages: [" + first + "{move: [0.1, -0.785, 0, -2.356, 0, 1.571, 0.785]}]\n"));
      CHECK_MESSAGE(result.status == PlanStatus::invalid_start, result.message);
      CHECK(result.stages.empty());
      return result.message;
    };
    const std::string in_table = "[0, 0.9, 0, -1.9, 0, 2.8, 0.785]";
    for (const std::string first : {"", "{line: {direction: [0, 0, 1], distance: 0.01}}, "}) {
      CAPTURE(first);
      const std::string message = refused(in_table, first);
      CHECK_MESSAGE(contains(message, "1': start is in contact: "), message);
      CHECK_MESSAGE(contains(message, "'table'"), message);
    }
    CHECK(refused("[0, -0.785, 0, -2.356, 0, 1.571, 9]", "").find("start: joint") == 0);
    CHECK(refused("[0, -0.785]", "").find("start: there are 2 values") == 0);
  }

  TEST_CASE("a start barely beyond a limit is led inside by a move, and by no other stage") {
    const std::string move = "{name: go, move: [0.5, -0.785, 0, -2.356, 0, 1.571, 0.785]}";
    const std::string line =
        "{name: up, line: {direction: [0, 0, 1], distance: 0.05, link: panda_hand}}";
    const auto task_of = [&](const std::string& first, const std::string& second) {
      return make_task(replaced(kCell, "1.571, 0.785]", "1.571, 2.9676]") + "stages:\n  - " +
                       first + "\n  - " + second + "\n");
    };
    const Task task = task_of(move, line);
    const TaskResult result = solved(task);
    check_plan(task, result);
    CHECK(result.stages.front().path.front() == task.start);
    CHECK_FALSE(task.robot.describe_violation(result.stages.front().path[1], ""));
    REQUIRE_FALSE(result.notes.empty());
    CHECK(result.notes[0].find("stage 'go': start: joint 'panda_joint7' is 0.000") == 0);
    const auto motion = time_task(task, result, {}, find_rate_limits(task.robot).value());
    REQUIRE_MESSAGE(motion.has_value(), (motion ? "" : motion.error().message));
    CHECK(motion->trajectory.at(0).position == task.start);

    const TaskResult refused = solved(task_of(line, move));
    CHECK(refused.status == PlanStatus::invalid_start);
    CHECK(refused.message.find("start: joint 'panda_joint7'") == 0);
    CHECK(refused.message.find("where the first stage is a move") != std::string::npos);
    TaskSettings strict;
    strict.solve.start_tolerance = 0;
    CHECK(solved(task, nullptr, strict).status == PlanStatus::invalid_start);
  }

  TEST_CASE("drops count the alternatives that the task has, not their configurations") {
    // No grasp can be lifted: a lid is 6 cm above the cup.
    const std::string lid =
        "    - {name: lid, type: box, position: [0.5, -0.1, 0.37], size: [0.1, 0.1, 0.02]}\n";
    const TaskResult result = solved(make_task(kCell + lid + kPickAndPlace));
    REQUIRE(result.status == PlanStatus::invalid_goal);
    for (const StageResult& stage : result.stages) {
      INFO(stage.name);
      for (const Dropped& dropped : stage.dropped) CHECK(dropped.count <= 30);
    }
    CHECK_MESSAGE(contains(result.message, "stage 'lift' after 30 alternatives of 'approach'"),
                  result.message);
  }

  TEST_CASE("an object may rest above its support, or a few millimetres in it with a note") {
    const auto lowered = [](double z) {
      return solved(
          make_task(kCell + replaced(kPickAndPlace, "position: [0.45, 0.2, 0.2505]",
                                     fmt::format("position: [0.45, 0.2, {}]", 0.25 + z))));
    };
    for (const double above : {0.008, 0.0005}) {
      const TaskResult result = lowered(above);
      INFO(result.message);
      CHECK(result.is_solved());
      CHECK(std::ranges::none_of(result.notes, [](const std::string& note) {
        return contains(note, "'cup' touches obstacle 'table'");
      }));
    }
    const TaskResult inside = lowered(-0.002);
    REQUIRE_MESSAGE(inside.is_solved(), inside.message);
    const std::string note = "stage 'lower' ends in contact: 'cup' touches obstacle 'table'";
    CHECK(std::ranges::count(inside.notes, note) == 1);
    CHECK_FALSE(lowered(-0.02).is_solved());
  }

  TEST_CASE("an object is lifted out between walls that are 0.4 mm away, and 0.1 mm is too near") {
    // The spheres around the box stick out farther than that.
    const auto tray = [](double z, double gap) {
      const double y = 0.04 + gap;
      return fmt::format(fmt::runtime(kTray), z, -0.1 - y, -0.1 + y);
    };
    for (const double z : {0.2505, 0.25}) {
      const Task task = make_task(tray(z, 4e-4) + kLiftBox);
      check_plan(task, solved(task));
    }
    const TaskResult refused = solved(make_task(tray(0.2505, 1e-4) + kLiftBox));
    CHECK_FALSE(refused.is_solved());
    CHECK_MESSAGE(
        contains(refused.message, "0.1 mm apart: a line needs 0.25 mm, or a stage `allow`"),
        refused.message);
    const Task allowed = make_task(
        tray(0.2505, 1e-4) +
        replaced(kLiftBox, "  - {name: lift,",
                 "  - {allow: [[box, left], [box, right], [box, table]]}\n  - {name: lift,"));
    // Spheres touch before the stage that allows it.
    CHECK(solved(allowed).is_solved());
  }

  TEST_CASE("preparation makes the tree of a large mesh for all stages") {
    constexpr double kHalf = 20, kDown = -0.2;  // metres
    const Vec3 a(-kHalf, -kHalf, kDown), b(kHalf, -kHalf, kDown), c(kHalf, kHalf, kDown),
        d(-kHalf, kHalf, kDown);
    const std::vector<Triangle> triangles = {{a, b, c}, {a, c, d}};
    const Mesh ground{{}, std::make_shared<Parts<Triangle>>(triangles)};
    Task task = make_task(kCell + kPickAndPlace);
    REQUIRE(task.scene.add({"ground", {ground}}));
    // A kept tree is returned where it covers the box.
    const auto kept = [&] {
      return internal::share_grid(*ground.parts, {Vec3(0, 0, kDown), Vec3(0.1, 0.1, kDown)});
    };
    TaskSettings settings;
    settings.solve.plan.timeout_s = 0;
    CHECK(solved(task, nullptr, settings).status == PlanStatus::timeout);
    const auto prepared = kept();
    // Single precision is that of the arm's surroundings.
    CHECK(prepared->region.high[0] < 5);
    check_plan(task, solved(task));
    CHECK(kept() == prepared);
  }

  TEST_CASE("an object that is not near is not attached") {
    const TaskResult result = solved(make_task(kCell + "stages: [{attach: cup}]\n"));
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(result.message.find("stage 'attach 1': not at the object (object 'cup' is ") == 0);
    CHECK(contains(result.message, "move there first"));
  }

  TEST_CASE("a line that leaves the reach of the arm says where it ends") {
    const TaskResult result = solved(make_task(
        kCell + "stages: [{line: {link: panda_hand, direction: [1, 0, 0], distance: 2}}]\n"));
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(result.message.find("stage 'line 1': no straight line (") == 0);
  }

  TEST_CASE("lines keep the task's constraints") {
    // The line tilts the hand by 0.4 rad about y.
    const std::string tilt =
        "stages: [{line: {link: panda_hand, to: {position: [0.4, 0, 0.5], quat_xyzw: [0.98006658, "
        "0, "
        "-0.19866933, 0]}}}]\n";
    CHECK(solved(make_task(kCell + tilt)).is_solved());
    const auto constrained = [&](double angle) {
      return solved(make_task(kCell + "constraints: [{link: panda_hand, axis: [0, 0, -1], angle: " +
                              std::to_string(angle) + "}]\n" + tilt));
    };
    CHECK(constrained(0.5).is_solved());
    const TaskResult result = constrained(0.2);
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK_MESSAGE(
        contains(result.message, "link 'panda_hand' leans more than the 0.2 rad of its constraint"),
        result.message);
  }

  TEST_CASE("the goal that was reached is counted in the order of the file") {
    const std::string pose = "{link: panda_hand, position: [0.4, 0, 0.5], quat_xyzw: [1, 0, 0, 0]}",
                      beyond = "[0, 3, 0, -2, 0, 1, 0]";
    for (const int reached : {0, 1}) {
      const std::string goals = reached == 0 ? pose + ", " + beyond : beyond + ", " + pose;
      const TaskResult result =
          solved(make_task(kCell + "stages: [{move: {any: [" + goals + "]}}]\n"));
      REQUIRE_MESSAGE(result.is_solved(), result.message);
      CHECK(result.stages[0].alternatives == 2);
      CHECK(result.stages[0].alternative == reached);
    }
  }
}

}  // namespace
}  // namespace mneme::test
