// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "goal/posed_robots.h"
#include "support/planar_memory.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace mneme::test {
namespace {

/// Checks that all solutions are what they should be.
void check_solutions(const Robot& robot, const PoseGoal& goal, const Configuration& near,
                     const IkResult& result, const IkSettings& settings = {}) {
  double latest = 0;
  for (const Configuration& q : result.solutions) {
    CHECK(!robot.describe_violation(q, "solution"));
    const PoseError error = pose_error(robot, goal, q);
    CHECK(error.position <= settings.position_tolerance);
    CHECK(error.rotation <= settings.rotation_tolerance);
    const double distance = robot.distance(near, q);
    CHECK(distance >= latest);
    latest = distance;
  }
  for (std::size_t i = 0; i < result.solutions.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      CHECK(robot.distance(result.solutions[i], result.solutions[k]) >= settings.apart);
    }
  }
}

/// Returns how many of `poses` poses of random configurations are reached.
int count_reached(const Robot& robot, const std::string& link, int poses, Isa isa) {
  const InverseKinematics kinematics = require(InverseKinematics::make(robot, link, isa));
  Rng rng(5);
  int reached = 0;
  for (int i = 0; i < poses; ++i) {
    const PoseGoal goal = pose_at(robot, link, random_configuration(robot, rng));
    const Configuration near = random_configuration(robot, rng);
    const IkResult result = kinematics.solve(goal, near);
    reached += !result.solutions.empty();
    check_solutions(robot, goal, near, result);
  }
  return reached;
}

TEST_SUITE("law") {
  TEST_CASE("poses that a configuration has are reached, with every instruction set") {
    for (const auto& [name, link] :
         {std::pair("panda", "panda_hand"), std::pair("fetch", "gripper_link"),
          std::pair("ur5", "tool0")}) {
      const Robot robot = shipped_robot(name);
      for (const Isa isa : available_isas()) {
        CAPTURE(robot.name());
        CAPTURE(to_string(isa));
        CHECK(count_reached(robot, link, 200, isa) >= 199);
      }
    }
  }

  TEST_CASE("an arm of ten metres reaches what it has reached, also almost stretched") {
    const Robot arm = shipped_robot("planar8");
    const PoseGoal stretched = pose_at(arm, "link_8", {-0.5, 0, 0, 0, 0, 0, 0, 0.5});
    for (const Isa isa : available_isas()) {
      CAPTURE(to_string(isa));
      CHECK(count_reached(arm, "link_8", 100, isa) >= 99);
      const InverseKinematics kinematics = require(InverseKinematics::make(arm, "link_8", isa));
      const Configuration near = {0.5, 0, 0, 0, 0, 0, 0, -0.5};
      const IkResult result = kinematics.solve(stretched, near);
      CHECK_FALSE(result.solutions.empty());
      check_solutions(arm, stretched, near, result);
    }
  }

  TEST_CASE("prismatic, continuous and mimic joints count") {
    CHECK(count_reached(odd_arm(), kOddHand, 200, Isa::automatic) >= 199);
  }

  TEST_CASE("solutions are at the turn of the configuration that the search begins at") {
    const Robot arm = odd_arm();  // its second joint is continuous
    const InverseKinematics kinematics =
        require(InverseKinematics::make(arm, kOddHand, Isa::automatic));
    Rng rng(3);
    for (int i = 0; i < 50; ++i) {
      Configuration near = random_configuration(arm, rng);
      const PoseGoal goal = pose_at(arm, kOddHand, random_configuration(arm, rng));
      const IkResult once = kinematics.solve(goal, near);
      near[1] += 6 * kPi;
      const IkResult result = kinematics.solve(goal, near);
      REQUIRE(result.solutions.size() == once.solutions.size());
      for (const Configuration& q : result.solutions) CHECK(std::abs(q[1] - near[1]) <= kPi + 1e-9);
      check_solutions(arm, goal, near, result);
    }
  }

  TEST_CASE("poses of what a link carries are reached") {
    const auto robot = require(attach(odd_arm(), {{"cup", kOddHand, {Sphere{{0, 0, 0.1}, 0.02}}},
                                                  {"lid", kOddHand, {Sphere{{0, 0, 0.2}, 0.02}}}}));
    CHECK(count_reached(robot, "lid", 50, Isa::automatic) >= 49);
  }

  TEST_CASE("solutions are in regions of poses, and use what these leave free") {
    const Robot robot = odd_arm();
    const InverseKinematics kinematics = require(InverseKinematics::make(robot, kOddHand));
    Rng rng(6);
    int exact = 0, reached = 0;
    for (int i = 0; i < 100; ++i) {
      PoseGoal goal = pose_at(robot, kOddHand, random_configuration(robot, rng));
      goal.axis = static_cast<Axis>(i % 3);
      goal.cone = rng.uniform(0, 0.5);
      goal.turn = i % 2 == 0 ? kPi : rng.uniform(0, 1);
      goal.position_tolerance = Vec3(0, rng.uniform(0, 0.2), 0.05);
      const Configuration near = random_configuration(robot, rng);
      const IkResult result = kinematics.solve(goal, near);
      check_solutions(robot, goal, near, result);
      reached += !result.solutions.empty();
      PoseGoal pose = goal;
      pose.cone = pose.turn = 0;
      pose.position_tolerance.setZero();
      for (const Configuration& q : result.solutions) {
        const PoseError error = pose_error(robot, pose, q);
        exact += error.position < 1e-3 && error.rotation < 1e-2;
      }
    }
    CHECK(reached == 100);
    CHECK(exact < 20);
  }

  TEST_CASE("what is half a turn away is not there yet") {
    const Robot robot = shipped_robot("panda");
    for (const Isa isa : available_isas()) {
      const InverseKinematics kinematics = require(InverseKinematics::make(robot, kHand, isa));
      for (int i = 0; i < 36; ++i) {
        CAPTURE(to_string(isa));
        CAPTURE(i);
        PoseGoal goal = pose_at(robot, kHand, kReady);
        const Vec3 axis = Vec3::Unit(i % 3);
        goal.pose.rotation = goal.pose.rotation * Eigen::AngleAxisd(kPi, axis).toRotationMatrix();
        goal.axis = static_cast<Axis>(i / 3 % 3);
        goal.cone = i / 9 % 2 * 0.1;
        goal.turn = i / 18 * 0.1;
        const IkResult result = kinematics.solve(goal, kReady);
        CHECK(!result.solutions.empty());
        check_solutions(robot, goal, kReady, result);
      }
    }
  }

  TEST_CASE("solutions are within regions of wide angles, and within a wide tolerance") {
    const Robot robot = shipped_robot("panda");
    struct Wide {
      Vec3 axis;  ///< of half a turn from where the search begins
      double cone, turn, tolerance;
    };
    for (const Isa isa : available_isas()) {
      const InverseKinematics kinematics = require(InverseKinematics::make(robot, kHand, isa));
      for (const Wide& wide :
           {Wide{Vec3::UnitZ(), 0.3, 3.0, 1e-3}, Wide{Vec3::UnitX(), 2.5, 0.3, 1e-3},
            Wide{Vec3::UnitX(), 3.1, kPi, 1e-3}, Wide{Vec3::UnitX(), 0, 0, 1}}) {
        CAPTURE(to_string(isa));
        CAPTURE(wide.cone);
        PoseGoal goal = pose_at(robot, kHand, kReady);
        goal.pose.rotation =
            goal.pose.rotation * Eigen::AngleAxisd(kPi, wide.axis).toRotationMatrix();
        goal.cone = wide.cone;
        goal.turn = wide.turn;
        IkSettings settings;
        settings.rotation_tolerance = wide.tolerance;
        const IkResult result = kinematics.solve(goal, kReady, settings);
        CHECK(!result.solutions.empty());
        check_solutions(robot, goal, kReady, result, settings);
        if (wide.cone == 0) continue;
        for (const Configuration& q : result.solutions) {
          CHECK(pose_error(robot, goal, q).rotation == 0);
        }
      }
    }
  }

  TEST_CASE("a position with any rotation is reached") {
    const Robot robot = shipped_robot("panda");
    const InverseKinematics kinematics = require(InverseKinematics::make(robot, "panda_hand"));
    PoseGoal goal = pose_at(robot, "panda_hand", robot.normalized(Configuration(7, 0.4)));
    goal.cone = goal.turn = kPi;
    const Configuration near = robot.normalized(Configuration(7, 0.0));
    const IkResult result = kinematics.solve(goal, near);
    CHECK(result.solutions.size() >= 8);
    check_solutions(robot, goal, near, result);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("joints that do not move the link stay where they are") {
    const Robot robot = odd_arm();
    Rng rng(7);
    Configuration near = random_configuration(robot, rng);
    near.back() = 0.777;
    const IkResult result =
        require(InverseKinematics::make(robot, kOddHand))
            .solve(pose_at(robot, kOddHand, random_configuration(robot, rng)), near);
    REQUIRE(!result.solutions.empty());
    for (const Configuration& q : result.solutions) CHECK(q.back() == doctest::Approx(0.777));
  }

  TEST_CASE("where the search begins is a solution if it is one, and the first") {
    const Robot robot = shipped_robot("ur5");
    Rng rng(8);
    const Configuration near = random_configuration(robot, rng);
    const IkResult result =
        require(InverseKinematics::make(robot, "tool0")).solve(pose_at(robot, "tool0", near), near);
    REQUIRE(!result.solutions.empty());
    CHECK(robot.distance(result.solutions.front(), near) < 1e-2);
  }

  TEST_CASE("joints that have more than one way round go the shorter one") {
    const Robot robot = odd_arm();
    constexpr std::size_t kLast = 6;
    Configuration near(8, 0.3);
    near[kLast] = 5.5;
    Configuration q(8, 0.4);
    q[kLast] = -0.6;
    const IkResult result =
        require(InverseKinematics::make(robot, kOddHand)).solve(pose_at(robot, kOddHand, q), near);
    REQUIRE(!result.solutions.empty());
    for (const Configuration& solution : result.solutions) {
      for (const double other : {solution[kLast] - 2 * kPi, solution[kLast] + 2 * kPi}) {
        if (std::abs(other) > 2 * kPi) continue;
        CHECK(std::abs(other - near[kLast]) >= std::abs(solution[kLast] - near[kLast]));
      }
    }
  }

  TEST_CASE("only what is free counts, and what is not is told") {
    const Robot robot = shipped_robot("panda");
    const Configuration q = {0.3, 0.2, 0.1, -1.8, 0, 2, 0.5};
    const PoseGoal goal = pose_at(robot, "panda_hand", q);
    Scene scene;
    scene.obstacles.push_back({"ball", {Sphere{Vec3(0.3, -0.35, 0.5), 0.25}}});
    const auto checker = require(CollisionChecker::make(robot, scene));
    IkSettings settings;
    settings.solutions = 200;
    const InverseKinematics kinematics = require(InverseKinematics::make(robot, "panda_hand"));
    const IkResult all = kinematics.solve(goal, q, settings);
    const IkResult free = kinematics.solve(goal, q, settings, &checker, 1e-4);
    const auto is_valid = [&](const Configuration& state) {
      return checker.is_valid(std::span<const double>(state));
    };
    CHECK(std::ranges::all_of(free.solutions, is_valid));
    CHECK(!free.solutions.empty());
    CHECK(!std::ranges::all_of(all.solutions, is_valid));
    CHECK(!free.blocked.empty());
    CHECK(std::ranges::none_of(free.blocked, is_valid));
  }

  TEST_CASE("what is out of reach is told by how far") {
    const Robot robot = planar8();
    const std::string tip = robot.links().back().name;
    PoseGoal goal = pose_at(robot, tip, Configuration(8, 0.0));
    const double reach = goal.pose.translation.norm();
    goal.pose.translation = Vec3(0.6, 0.8, 0) * (reach + 0.5);
    goal.cone = goal.turn = kPi;
    const IkResult result =
        require(InverseKinematics::make(robot, tip)).solve(goal, Configuration(8, 0.1));
    CHECK(result.solutions.empty());
    CHECK(result.seeds == IkSettings().seeds);
    CHECK(result.closest.position == doctest::Approx(0.5).epsilon(0.02));
  }

  TEST_CASE("how far the closest result is rotated is told as an angle beyond the region") {
    const Robot robot = planar8();
    const std::string tip = robot.links().back().name;
    PoseGoal goal = pose_at(robot, tip, Configuration(8, 0.2));
    goal.pose.rotation =
        goal.pose.rotation * Eigen::AngleAxisd(kPi, Vec3::UnitX()).toRotationMatrix();
    goal.turn = kPi;
    const InverseKinematics kinematics = require(InverseKinematics::make(robot, tip));
    for (const double cone : {0.0, 2.0}) {
      goal.cone = cone;
      const IkResult result = kinematics.solve(goal, Configuration(8, 0.1));
      CHECK(result.solutions.empty());
      CHECK(result.closest.rotation == doctest::Approx(kPi - cone));
    }
  }

  TEST_CASE(
      "the same arguments give the same solutions, and no more seeds are tried than allowed") {
    const Robot robot = odd_arm();
    const InverseKinematics kinematics = require(InverseKinematics::make(robot, kOddHand));
    const PoseGoal goal = pose_at(robot, kOddHand, Configuration(8, 0.3));
    const Configuration near(8, 0.0);
    IkSettings settings;
    settings.seeds = 20;
    settings.solutions = 1000;
    const IkResult first = kinematics.solve(goal, near, settings);
    CHECK(first.seeds <= 20);
    CHECK(first.solutions == kinematics.solve(goal, near, settings).solutions);
    settings.seed = 2;
    CHECK(first.solutions != kinematics.solve(goal, near, settings).solutions);
  }

  TEST_CASE("links that cannot be moved to a pose are refused") {
    const Robot robot = odd_arm();
    const auto message = [&](const Robot& of, const std::string& link) {
      const auto made = InverseKinematics::make(of, link);
      return made ? "" : made.error().message;
    };
    CHECK(message(robot, "nose") == "expected a link of robot odd, got \"nose\"");
    CHECK(message(robot, "base") ==
          "0 joints of the group of robot odd move link \"base\"; inverse kinematics handles "
          "1 to 32");
    const Robot long_arm = planar_arm(std::vector<double>(33, 0.1), 0.01);
    CHECK(message(long_arm, long_arm.links().back().name)
              .starts_with("33 joints of the group of robot"));
  }

  TEST_CASE("tips are what the last joints carry") {
    CHECK(find_tips(shipped_robot("panda")) == std::vector<std::string>{"panda_hand"});
    CHECK(find_tips(shipped_robot("ur5")) == std::vector<std::string>{"wrist_3_link"});
    CHECK(find_tips(shipped_robot("fetch")) == std::vector<std::string>{"gripper_link"});
    // A palm that carries two fingers and a tool point.
    Robot::Parts parts;
    parts.name = "hand";
    parts.links.push_back({.name = "base"});
    const auto hang = [&](int parent, JointType type) {
      hang_link(parts, parent, joint_at(type, Vec3(0, 0, 0.1), Vec3::UnitZ(), -1, 1), {}, {});
    };
    hang(0, JointType::revolute);
    for (int i = 0; i < 3; ++i) hang(1, JointType::fixed);
    const auto tips_of = [&](const std::string& group) {
      RobotOptions options;
      options.group = group;
      return find_tips(require(make_robot(parts, options)));
    };
    const std::string base = parts.links[0].name, palm = parts.links[1].name,
                      tool = parts.links[4].name;
    CHECK(tips_of("") == std::vector{palm});
    CHECK(tips_of(base + ":" + palm) == std::vector{palm});
    CHECK(tips_of(base + ":" + tool) == std::vector{tool});
    CHECK(find_tips(odd_arm()) == std::vector<std::string>{"link_8", "link_9"});
  }
}

}  // namespace
}  // namespace mneme::test
