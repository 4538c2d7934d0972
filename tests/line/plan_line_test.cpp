// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/line.h"

#include "goal/posed_robots.h"
#include "line/line_oracle.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <atomic>
#include <limits>
#include <string>
#include <utility>

namespace mneme::test {
namespace {

CollisionChecker require_checker(const Robot& robot, const Scene& scene = {}) {
  return require(CollisionChecker::make(robot, scene));
}

LineResult require_line(const CollisionChecker& checker, const Line& line, const Configuration& q,
                        const LineSettings& settings = {}) {
  return require(plan_line(checker, line, q, settings));
}

Line random_line(const std::string& link, Rng& rng) {
  Line line;
  line.link = link;
  line.displacement =
      rng.uniform(0.1, 0.4) * Vec3(rng.normal(), rng.normal(), rng.normal()).normalized();
  return line;
}

Line line_by(const std::string& link, const Vec3& displacement) {
  Line line;
  line.link = link;
  line.displacement = displacement;
  return line;
}

/// The link stays within the bounds, and these within the tolerances.
void check_deviation(const Robot& robot, const Line& line, const LineResult& result) {
  const LineDeviation off = measure_deviation(robot, line.link, result, 100, line.free_axis);
  CHECK(off.position <= result.line.position_deviation + 1e-9);
  CHECK(off.rotation <= result.line.rotation_deviation + 1e-7);
  CHECK(result.line.position_deviation <= line.position_tolerance);
  CHECK(result.line.rotation_deviation <= line.rotation_tolerance);
}

const std::pair<const char*, const char*> kArms[] = {
    {"panda", "panda_hand"}, {"fetch", "gripper_link"}, {"ur5", "tool0"}};

TEST_SUITE("law") {
  TEST_CASE("lines from random configurations are free and stay within their bounds") {
    for (const auto& arm : kArms) {
      const std::string name = arm.first, link = arm.second;
      CAPTURE(name);
      const Robot robot = shipped_robot(name);
      const CollisionChecker checker = require_checker(robot);
      Rng rng(3);
      int whole = 0;
      for (int i = 0; i < 40; ++i) {
        const Configuration q = random_configuration(robot, rng);
        const Line line = random_line(link, rng);
        const LineResult result = require_line(checker, line, q);
        CHECK(result.is_whole() == result.reason.empty());
        CHECK(result.line.path.empty() == !checker.is_valid(std::span<const double>(q)));
        check_deviation(robot, line, result);
        if (!result.is_whole()) continue;
        ++whole;
        CHECK(result.line.path.front() == q);
        CHECK(is_path_free(robot, {}, result.line.path, 0.005));
      }
      CHECK(whole >= 6);
    }
  }

  TEST_CASE("a line keeps the rotation, or turns to that of its target at even speed") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = require_checker(robot);
    Line line;
    line.link = kHand;
    line.target = pose_at(robot, kHand, kReady).pose;
    line.target->translation += Vec3(0.05, 0.1, -0.1);
    line.target->rotation = line.target->rotation * rotation_about(Vec3::UnitZ(), 0.7);
    const LineResult turning = require_line(checker, line, kReady);
    CHECK_MESSAGE(turning.is_whole(), turning.reason);
    check_deviation(robot, line, turning);
    CHECK(angle_between(pose_at(robot, kHand, turning.line.path.back()).pose.rotation,
                        line.target->rotation) < 1e-4);
    line.keeps_rotation = true;
    const LineResult kept = require_line(checker, line, kReady);
    CHECK_MESSAGE(kept.is_whole(), kept.reason);
    const Transform end = pose_at(robot, kHand, kept.line.path.back()).pose;
    CHECK((end.translation - line.target->translation).norm() < 1e-5);
    CHECK(angle_between(end.rotation, kept.begin.rotation) < 1e-4);
  }

  TEST_CASE("the same arguments give the same path") {
    const Robot robot = shipped_robot("fetch");
    const CollisionChecker checker = require_checker(robot);
    Rng rng(8);
    for (int i = 0; i < 5; ++i) {
      const Configuration q = random_configuration(robot, rng);
      const Line line = random_line("gripper_link", rng);
      CHECK(require_line(checker, line, q).line.path == require_line(checker, line, q).line.path);
    }
  }

  TEST_CASE("tighter tolerances give more waypoints and smaller bounds") {
    const Robot robot = shipped_robot("ur5");
    const CollisionChecker checker = require_checker(robot);
    Line line = line_by("tool0", Vec3(0, 0.2, -0.1));
    const Configuration q = {0.3, -1.5, 1.6, -1.6, -1.5, 0};
    const LineResult usual = require_line(checker, line, q);
    line.position_tolerance = 1e-6;
    const LineResult tight = require_line(checker, line, q);
    CHECK_MESSAGE(usual.is_whole(), usual.reason);
    CHECK_MESSAGE(tight.is_whole(), tight.reason);
    check_deviation(robot, line, tight);
    CHECK(tight.line.path.size() > 5 * usual.line.path.size());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("directions are in the named frame at the start") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = require_checker(robot);
    const Transform begin = pose_at(robot, kHand, kReady).pose;
    for (const std::string frame : {"", "world", "panda_link0", "panda_hand", "panda_link5"}) {
      CAPTURE(frame);
      Line line = line_by(kHand, Vec3(0.02, 0, 0.05));
      line.frame = frame;
      const LineResult result = require_line(checker, line, kReady);
      REQUIRE_MESSAGE(result.is_whole(), result.reason);
      const bool is_root = frame.empty() || frame == "world";
      const Eigen::Matrix3d axes = is_root ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                           : pose_at(robot, frame, kReady).pose.rotation;
      const Vec3 end = begin.translation + axes * line.displacement;
      CHECK((pose_at(robot, kHand, result.line.path.back()).pose.translation - end).norm() < 1e-5);
    }
  }

  TEST_CASE("from a pose, a frame is known if it is fixed to the base or to the link") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = require_checker(robot);
    for (const std::string frame : {"panda_link0", "panda_link8"}) {
      CAPTURE(frame);
      Line line = line_by(kHand, Vec3(0.02, 0, 0.05));
      line.frame = frame;
      line.start = pose_at(robot, kHand, kReady).pose;
      Configuration elsewhere = kReady;
      elsewhere[0] += 0.5;
      const LineResult result = require_line(checker, line, elsewhere);
      const Eigen::Matrix3d axes = pose_at(robot, frame, kReady).pose.rotation;
      CHECK((result.end.translation - line.start->translation - axes * line.displacement).norm() <
            1e-9);
    }
  }

  TEST_CASE("the only tip of the group is the default link") {
    const Robot robot = shipped_robot("ur5");
    const LineResult result = require_line(require_checker(robot), line_by("", Vec3(0, 0.05, 0)),
                                           {0.3, -1.5, 1.6, -1.6, -1.5, 0});
    CHECK((result.begin.translation -
           pose_at(robot, find_tips(robot).front(), result.line.path.front()).pose.translation)
              .norm() < 1e-9);
  }

  TEST_CASE("from a pose all branches of inverse kinematics are tried") {
    const Robot robot = shipped_robot("ur5");
    const CollisionChecker checker = require_checker(robot);
    const Configuration near = {0.3, -1.5, 1.6, -1.6, -1.5, 0};
    Line line = line_by("tool0", Vec3(0, 0, -0.05));
    line.start = pose_at(robot, "tool0", near).pose;
    LineSettings settings;
    settings.line_paths = 3;
    const LineResult result = require_line(checker, line, near, settings);
    REQUIRE_MESSAGE(result.is_whole(), result.reason);
    CHECK(result.branches >= 4);
    REQUIRE(result.others.size() == 2);
    CHECK(robot.distance(result.line.path.front(), near) < 1e-3);
    for (const LinePath& other : result.others) {
      CHECK(other.fraction() == 1);
      CHECK(robot.distance(other.path.front(), result.line.path.front()) > 0.1);
      CHECK((pose_at(robot, "tool0", other.path.back()).pose.translation - result.end.translation)
                .norm() < 1e-5);
    }
  }

  TEST_CASE("a free axis lets the link turn where the rotation stops it") {
    const Robot robot = shipped_robot("ur5");
    const CollisionChecker checker = require_checker(robot);
    const Configuration q = {0.3, -1.5, 1.6, -1.6, -1.5, 3.1};
    // Turning the tool by a right angle takes its last joint beyond the limit.
    Line line;
    line.link = "tool0";
    line.target = pose_at(robot, "tool0", q).pose;
    line.target->translation += Vec3(0, 0.05, 0);
    line.target->rotation = line.target->rotation * rotation_about(Vec3::UnitZ(), kPi / 2);
    const LineResult stopped = require_line(checker, line, q);
    CHECK(!stopped.is_whole());
    CHECK(contains(stopped.reason, "joint 'wrist_3_joint' at its upper limit of 3.142 rad"));
    line.free_axis = Axis::z;
    const LineResult free = require_line(checker, line, q);
    CHECK_MESSAGE(free.is_whole(), free.reason);
    check_deviation(robot, line, free);
    // The same grasp turned by half a turn, about an axis that is free.
    line.target->rotation = line.target->rotation * rotation_about(Vec3::UnitZ(), kPi / 2);
    const LineResult half = require_line(checker, line, q);
    CHECK_MESSAGE(half.is_whole(), half.reason);
    check_deviation(robot, line, half);
  }

  TEST_CASE("a planar arm follows lines in its plane") {
    const Robot robot = planar8();
    const CollisionChecker checker = require_checker(robot);
    const Configuration q = {0.1, 0.4, 0.4, 0.4, -0.3, -0.4, -0.4, 0.2};
    const std::string tip = find_tips(robot).front();
    Line line = line_by(tip, Vec3(-0.2, 0.3, 0));
    const LineResult result = require_line(checker, line, q);
    CHECK_MESSAGE(result.is_whole(), result.reason);
    check_deviation(robot, line, result);
    const LineResult none = require_line(checker, line_by(tip, Vec3(0, 0, 0.1)), q);
    CHECK(none.line.fraction() < 0.01);
  }

  TEST_CASE("a line that leaves the reach returns its longest part and says why") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = require_checker(robot);
    const Line line = line_by(kHand, Vec3(2, 0, 0));
    const LineResult result = require_line(checker, line, kReady);
    CHECK(!result.is_whole());
    CHECK(result.line.fraction() > 0.1);
    CHECK(result.line.fraction() < 0.5);
    CHECK_MESSAGE(result.reason.starts_with("branch ends after "), result.reason);
    check_deviation(robot, line, result);
  }

  TEST_CASE("a line into an obstacle ends before it and names the contact") {
    const Robot robot = shipped_robot("panda");
    const Transform begin = pose_at(robot, kHand, kReady).pose;
    Scene scene;
    const Vec3 below = begin.translation - Vec3(0, 0, 0.3);
    REQUIRE(
        scene.add({"shelf", {Box{{Eigen::Matrix3d::Identity(), below}, Vec3(0.15, 0.15, 0.05)}}}));
    const CollisionChecker checker = require_checker(robot, scene);
    const Line line = line_by(kHand, Vec3(0, 0, -0.25));
    const LineResult result = require_line(checker, line, kReady);
    CHECK(!result.is_whole());
    CHECK(result.line.fraction() > 0.2);
    CHECK_MESSAGE(contains(result.reason, "contact of link 'panda_"), result.reason);
    CHECK_MESSAGE(contains(result.reason, "with obstacle 'shelf'"), result.reason);
    CHECK(is_path_free(robot, scene, result.line.path, 0.005));
  }

  TEST_CASE("a start pose without a configuration is told") {
    const Robot robot = shipped_robot("panda");
    Line line = line_by(kHand, Vec3(0, 0, 0.1));
    line.start = pose_at(robot, kHand, kReady).pose;
    line.start->translation.x() += 3;
    const LineResult result = require_line(require_checker(robot), line, kReady);
    CHECK(result.line.path.empty());
    CHECK(result.branches == 0);
    CHECK_MESSAGE(contains(result.reason, "out of reach"), result.reason);
  }

  TEST_CASE("a start in contact is told") {
    const Robot robot = shipped_robot("panda");
    Scene scene;
    const Vec3 hand = pose_at(robot, kHand, kReady).pose.translation;
    REQUIRE(scene.add({"ball", {Sphere{hand, 0.05}}}));
    const LineResult result =
        require_line(require_checker(robot, scene), line_by(kHand, Vec3(0, 0, 0.1)), kReady);
    CHECK(result.line.path.empty());
    CHECK(result.steps == 0);
    CHECK_MESSAGE(result.reason.find("the line cannot start: contact of link") == 0, result.reason);
    CHECK_MESSAGE(contains(result.reason, "'ball'"), result.reason);
  }

  TEST_CASE("a line whose start a held object cannot leave names the way out") {
    AttachedObject part{
        "part", kHand, {Sphere{{0, 0, 0.2}, 0.05}}, {}, {"panda_leftfinger", "panda_rightfinger"}};
    const Robot robot = attach(shipped_robot("panda"), {part}).value();
    const Transform hand = pose_at(robot, kHand, kReady).pose;
    const Vec3 below = hand * Vec3(0, 0, 0.3);
    const Scene scene{"cell", {{"table", {Sphere{below, 0.06}}}}};
    const LineResult result =
        require_line(require_checker(robot, scene), line_by(kHand, Vec3(0, 0, 0.1)), kReady);
    CHECK_FALSE(result.is_whole());
    CHECK_MESSAGE(
        result.reason.find("contact of link 'part' with obstacle 'table'; a line of a task") !=
            std::string::npos,
        result.reason);
    CHECK_MESSAGE(result.reason.find("['part', 'table']") != std::string::npos, result.reason);
  }

  TEST_CASE("a start at which spheres alone touch is checked by exact geometry") {
    const Box plate{{Eigen::Matrix3d::Identity(), {0, 0, 0.2}}, {0.1, 0.1, 0.01}};
    const auto robot = require(attach(shipped_robot("panda"), {{"plate", kHand, {plate}}}));
    const Transform begin = pose_at(robot, kHand, kReady).pose;
    Scene scene;
    const auto add_tray = [&](double gap) {
      scene.obstacles.clear();
      const Transform under{begin.rotation, begin * Vec3(0, 0, 0.21 + gap + 0.02)};
      REQUIRE(scene.add({"tray", {Box{under, {0.05, 0.05, 0.02}}}}));
    };
    add_tray(0.003);
    const CollisionChecker checker = require_checker(robot, scene);
    REQUIRE_FALSE(checker.is_valid(std::span<const double>(kReady)));
    Line line = line_by(kHand, Vec3(0, 0, 0.1));
    for (const bool is_from_pose : {false, true}) {
      if (is_from_pose) line.start = begin;
      const LineResult result = require_line(checker, line, kReady);
      CHECK_MESSAGE(result.is_whole(), result.reason);
      REQUIRE(result.notes.size() >= 1);
      CHECK(contains(result.notes.front(), "touches obstacle 'tray' only with its spheres"));
      REQUIRE(result.scene.has_value());
      CHECK(is_path_free(robot, *result.scene, result.line.path, 0.005));
      check_deviation(robot, line, result);
    }
    add_tray(-0.001);
    line.start.reset();
    const LineResult touching = require_line(require_checker(robot, scene), line, kReady);
    CHECK(touching.line.path.empty());
    CHECK(contains(touching.reason, "contact of link 'plate' with obstacle 'tray'"));
  }

  TEST_CASE("limits and cancellation end the search") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = require_checker(robot);
    const Line line = line_by(kHand, Vec3(0, 0.3, 0));
    LineSettings settings;
    settings.line_steps = 3;
    const LineResult few = require_line(checker, line, kReady, settings);
    CHECK(!few.is_whole());
    CHECK(few.steps < 12);
    CHECK_MESSAGE(contains(few.reason, "the search was ended by its limits"), few.reason);
    const std::atomic<bool> cancel = true;
    settings = {};
    settings.cancel = &cancel;
    CHECK(require_line(checker, line, kReady, settings).is_cancelled);
  }

  TEST_CASE("wrong lines are refused with a message") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = require_checker(robot);
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const auto check = [&](auto change, const std::string& expected) {
      Line line = line_by(kHand, Vec3(0, 0, 0.1));
      LineSettings settings;
      change(line, settings);
      const auto result = plan_line(checker, line, kReady, settings);
      REQUIRE_MESSAGE(!result.has_value(), expected);
      CHECK_MESSAGE(contains(result.error().message, expected), result.error().message);
    };
    check([](Line& line, auto&) { line.link = "panda_hnd"; },
          "the line's link \"panda_hnd\" is no link of robot panda; did you mean 'panda_hand'?");
    check([](Line& line, auto&) { line.frame = "table"; },
          "the line's frame \"table\" is no link of robot panda");
    check(
        [](Line& line, auto&) {
          line.frame = "panda_link5";
          line.start = Transform{};
        },
        "the line's frame \"panda_link5\" moves with the joints");
    check([](Line& line, auto&) { line.displacement.setZero(); }, "has no length");
    check([&](Line& line, auto&) { line.target = pose_at(robot, kHand, kReady).pose; },
          "has no length");
    check([](Line& line, auto&) { line.displacement.x() = kNan; }, "as the line's displacement");
    check(
        [](Line& line, auto&) {
          line.target = Transform{};
          line.target->translation.y() = std::numeric_limits<double>::infinity();
        },
        "as the line's target");
    check(
        [](Line& line, auto&) {
          line.start = Transform{};
          line.start->rotation(0, 0) = 2;
        },
        "as the line's start");
    check(
        [&](Line& line, auto&) {
          line.target = pose_at(robot, kHand, kReady).pose;
          line.target->rotation = rotation_about(Vec3::UnitX(), kPi) * line.target->rotation;
        },
        "by half a turn");
    check([](Line& line, auto&) { line.position_tolerance = 0; }, "position tolerance is 0 m");
    check([](Line& line, auto&) { line.rotation_tolerance = kNan; }, "rotation tolerance is nan");
    check([](Line&, LineSettings& settings) { settings.line_steps = 0; }, "setting 'line-steps'");
    check([](Line& line, auto&) { line.link = "panda_link3"; }, "need at least 6");
  }

  TEST_CASE("a start that is no configuration begins no line, and the reason says why") {
    const CollisionChecker checker = require_checker(shipped_robot("panda"));
    const auto reason_of = [&](const Configuration& start) {
      const auto result = require(plan_line(checker, line_by(kHand, Vec3(0, 0, 0.1)), start));
      CHECK_FALSE(result.is_whole());
      CHECK(result.branches == 0);
      CHECK(result.line.path.empty());
      return result.reason;
    };
    CHECK(reason_of({0, -0.785, 0, 3, 0, 1.571, 0.785}).starts_with("start: joint 'panda_joint4'"));
    CHECK(reason_of({0, 0}).starts_with("start: there are 2 values"));
    const std::string barely = reason_of({0, -0.785, 0, -2.356, 0, 1.571, 2.9676});
    CHECK(barely.starts_with("start: joint 'panda_joint7'"));
    CHECK(barely.ends_with("plan a motion there first"));
  }

  TEST_CASE("constraints are refused") {
    const Robot robot = shipped_robot("panda");
    const auto checker = require(CollisionChecker::make(
        robot, {}, {.constraints = {{kHand, Vec3(0, 0, -1), Vec3::UnitZ(), 0.5}}}));
    const Error error = require_error(plan_line(checker, line_by(kHand, Vec3(0, 0, 0.1)), kReady));
    CHECK(contains(error.message, "without orientation constraints"));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("lines that an exhaustive search over branches finds are found") {
    for (const auto& arm : {std::pair("panda", "panda_hand"), std::pair("ur5", "tool0")}) {
      const std::string name = arm.first, link = arm.second;
      CAPTURE(name);
      const Robot robot = shipped_robot(name);
      Scene scene;
      REQUIRE(scene.add(
          {"box", {Box{{Eigen::Matrix3d::Identity(), Vec3(0.5, 0, 0.2)}, Vec3(0.1, 0.3, 0.2)}}}));
      const CollisionChecker checker = require_checker(robot, scene);
      const LineOracle oracle(checker, link, 0.01, 0.15);
      Rng rng(11);
      int possible = 0, whole = 0;
      for (int i = 0; i < 30; ++i) {
        const Configuration q = random_configuration(robot, rng);
        if (!checker.is_valid(std::span<const double>(q))) continue;
        const Line line = random_line(link, rng);
        const LineResult result = require_line(checker, line, q);
        whole += result.is_whole();
        possible += result.is_whole() || oracle.is_possible(result, {q});
      }
      CHECK(possible >= 5);
      CHECK(whole >= possible - 1);
    }
  }
}

}  // namespace
}  // namespace mneme::test
