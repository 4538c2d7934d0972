// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "robot/small_robots.h"

#include <numbers>

namespace mneme::test {
namespace {

/// Two joints of a group and a finger that follows the second twice as fast.
Robot hand(const std::string& first = R"(velocity="2" acceleration="3")",
           const std::string& finger = R"(velocity="1")") {
  const auto joint = [](const std::string& name, int child, const std::string& limit,
                        const std::string& more = "") {
    return "<joint name=\"" + name + "\" type=\"revolute\"><parent link=\"l" +
           std::to_string(child - 1) + "\"/><child link=\"l" + std::to_string(child) +
           "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" " + limit + "/>" + more +
           "</joint>";
  };
  return require(parse_robot(
      R"(<robot name="hand"><link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/>)" +
          joint("a", 1, first) + joint("b", 2, R"(effort="1")") +
          joint("finger", 3, finger, R"(<mimic joint="b" multiplier="-2"/>)") + "</robot>",
      "hand.urdf"));
}

RateLimits require_limits(const Robot& robot, const TrajectorySettings& settings = {},
                          const std::string& yaml = "") {
  const TemporaryDirectory directory;
  const std::string file = yaml.empty() ? "" : directory / "limits.yaml";
  if (!yaml.empty()) write_file(file, yaml);
  return require(find_rate_limits(robot, settings, file));
}

Error refusal(const Robot& robot, const TrajectorySettings& settings, const std::string& yaml) {
  const TemporaryDirectory directory;
  if (!yaml.empty()) write_file(directory / "limits.yaml", yaml);
  const auto limits =
      find_rate_limits(robot, settings, yaml.empty() ? "" : directory / "limits.yaml");
  REQUIRE_MESSAGE(!limits.has_value(), yaml);
  return limits.error();
}

using Rates = std::vector<double>;

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("limits are those of the URDF, of followers too, and else the defaults") {
    const RateLimits limits = require_limits(hand());
    CHECK(limits.velocity == Rates{2, 0.5});
    CHECK(limits.acceleration == Rates{3, 0.5});
    TrajectorySettings settings;
    settings.acceleration_limit = 7;
    CHECK(require_limits(hand(), settings).acceleration == Rates{3, 3.5});
  }

  TEST_CASE("scales multiply them") {
    TrajectorySettings settings;
    settings.velocity_scale = 0.5;
    settings.acceleration_scale = 0.1;
    const RateLimits limits = require_limits(hand(), settings);
    CHECK(limits.velocity == Rates{1, 0.25});
    CHECK(limits.acceleration[0] == doctest::Approx(0.3));
    CHECK(limits.acceleration[1] == doctest::Approx(0.05));
  }

  TEST_CASE("a file of limits in MoveIt's form goes before the URDF") {
    const RateLimits limits = require_limits(hand(), {}, R"(
default_velocity_scaling_factor: 0.1
default_acceleration_scaling_factor: 0.1
joint_limits:
  a: {has_velocity_limits: true, max_velocity: 1.5, has_acceleration_limits: false, max_acceleration: 9}
  b: {max_velocity: 4, max_acceleration: 5, has_jerk_limits: false, has_position_limits: false}
  finger: {has_velocity_limits: true, max_velocity: 6, has_acceleration_limits: true, max_acceleration: 8}
)");
    CHECK(limits.velocity == Rates{1.5, 3});
    CHECK(limits.acceleration == Rates{3, 4});
  }

  TEST_CASE("jerk is limited where a file or the settings say so") {
    CHECK(require_limits(hand()).jerk == Rates{INFINITY, INFINITY});
    TrajectorySettings settings;
    settings.jerk_limit = 8;
    settings.acceleration_scale = 0.5;
    CHECK(require_limits(hand(), settings).jerk == Rates{8, 4});
    const std::string yaml = R"(
joint_limits:
  a: {has_jerk_limits: true, max_jerk: 20}
  finger: {has_jerk_limits: false, max_jerk: 1}
)";
    CHECK(require_limits(hand(), {}, yaml).jerk == Rates{20, INFINITY});
    CHECK(require_limits(hand(), settings, yaml).jerk == Rates{20, 4});
  }

  TEST_CASE("the URDF's limits of jerk, of followers too, go before the settings") {
    const Robot robot =
        hand(R"(velocity="2" acceleration="3" jerk="30")", R"(velocity="1" jerk="4")");
    CHECK(require_limits(robot).jerk == Rates{30, 2});
    TrajectorySettings settings;
    settings.jerk_limit = 8;
    CHECK(require_limits(robot, settings).jerk == Rates{30, 2});
    CHECK(require_limits(robot, {}, "joint_limits: {a: {max_jerk: 20}}").jerk == Rates{20, 2});
  }

  TEST_CASE("a limit beyond all reason counts as none") {
    CHECK(require_limits(hand(R"(velocity="1e17")")).velocity[0] == 1e6);
  }

  TEST_CASE("a joint and a list without values limit nothing") {
    const RateLimits own = require_limits(hand());
    CHECK(require_limits(hand(), {}, "joint_limits:\n").velocity == own.velocity);
    CHECK(require_limits(hand(), {}, "joint_limits:\n  a:\n").velocity == own.velocity);
  }

  TEST_CASE("files that cannot be used exactly are refused at their line") {
    struct Case {
      std::string yaml, part;
      ErrorCode code = ErrorCode::parse;
    };
    for (const Case& c : std::vector<Case>{
             {"joint_limits:\n  a: {max_velocity: -1}", ":2: key joint_limits.a.max_velocity"},
             {"joint_limits:\n  a: {max_velocity: 0}", "expected a number above 0, got 0"},
             {"joint_limits:\n  a: {max_velocity: .nan}", "expected a finite number"},
             {"joint_limits:\n  a: {max_velocity: 1e-7}", "a limit of at least 1e-06"},
             {"joint_limits:\n  a: {max_acceleration: fast}", "expected a number, got \"fast\""},
             {"joint_limits:\n  a: {has_velocity_limits: true}", "the key max_velocity"},
             {"limits: {}", "the key joint_limits"},
             {"a: 1", "the key joint_limits"},
             {"default_velocity_scaling_factor: 1", "the key joint_limits"},
             {"joint_limits: {a: {has_jerk_limits: true}}", "the key max_jerk"},
             {"joint_limits: {a: {max_jerk: 0}}", "expected a number above 0, got 0"}}) {
      const Error error = refusal(hand(), {}, c.yaml);
      CHECK_MESSAGE(contains(error.message, c.part), error.message);
      CHECK(contains(error.message, "limits.yaml"));
      CHECK(error.code == c.code);
    }
    const Error missing = require_error(find_rate_limits(hand(), {}, "/nowhere/limits.yaml"));
    CHECK(missing.code == ErrorCode::io);
  }

  TEST_CASE("limits of torque that a file switches off are none") {
    const std::string yaml =
        "joint_limits: {a: {max_velocity: 1.5, has_effort_limits: false, max_effort: 9}}";
    CHECK(require_limits(hand(), {}, yaml).velocity[0] == 1.5);
    CHECK(require_limits(hand(), {}, yaml).warnings.empty());
  }

  TEST_CASE("limits of position narrow those of the robot, and do not widen them") {
    const TemporaryDirectory directory;
    const std::string file = directory / "limits.yaml";
    const Robot own = hand();
    const auto narrowed = [&](const std::string& a, const Robot& robot) {
      write_file(file, "joint_limits:\n  a: {max_velocity: 1.5, " + a + "}\n  other: {}\n");
      const auto result = narrow_positions(robot, file);
      REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
      const auto limits = find_rate_limits(*result, {}, file, false);
      CHECK(limits->velocity[0] == 1.5);
      CHECK(limits->warnings.size() == 1);
      CHECK(!contains(limits->warnings[0], "position"));
      return *result;
    };
    const auto range = [](const Robot& robot) {
      return std::pair(robot.group_joint(0).lower, robot.group_joint(0).upper);
    };
    CHECK(range(narrowed("min_position: -0.5, max_position: 0.25", own)) == std::pair(-0.5, 0.25));
    CHECK(range(narrowed("max_position: !degrees 45", own)).second ==
          doctest::Approx(std::numbers::pi / 4));
    const Robot half = narrowed("has_position_limits: true, min_position: -0.5", own);
    CHECK(range(half) == std::pair(-0.5, 1.0));
    CHECK(range(narrowed("min_position: -2, max_position: 0.5", half)) == std::pair(-0.5, 0.5));
    CHECK(half.joint_names() == own.joint_names());
    CHECK(half.self_pairs().size() == own.self_pairs().size());
    for (const char* same : {"min_position: -2, max_position: 1", "has_position_limits: true",
                             "has_position_limits: false, min_position: 0.5"}) {
      CHECK_FALSE(narrowed(same, own).identity().owner_before(own.identity()));
      CHECK_FALSE(own.identity().owner_before(narrowed(same, own).identity()));
    }
    for (const char* none : {"min_position: 2", "min_position: 0.5, max_position: 0.4"}) {
      write_file(file, "joint_limits: {a: {" + std::string(none) + "}}");
      const auto refused = narrow_positions(own, file);
      REQUIRE_FALSE(refused.has_value());
      CHECK(contains(refused.error().message, "limits.yaml:1: key joint_limits.a: expected "));
    }
  }

  TEST_CASE("limits of position of a joint that follows narrow the one it follows") {
    const TemporaryDirectory directory;
    const std::string file = directory / "limits.yaml";
    const auto narrowed = [&](const std::string& limits) {
      write_file(file, "joint_limits: {" + limits + "}");
      const Robot robot = require(narrow_positions(hand(), file));
      CHECK(require(find_rate_limits(robot, {}, file)).warnings.empty());
      return std::pair(robot.group_joint(1).lower, robot.group_joint(1).upper);
    };
    // The finger is at -2 b.
    CHECK(narrowed("finger: {min_position: -0.5, max_position: 1}") == std::pair(-0.5, 0.25));
    CHECK(narrowed("b: {min_position: -0.2}, finger: {min_position: -0.5, max_position: 1}") ==
          std::pair(-0.2, 0.25));
    write_file(file, "joint_limits: {finger: {min_position: 3}}");
    CHECK(contains(narrow_positions(hand(), file).error().message,
                   "joint_limits.finger: expected positions that the limits [-1, 1] of joint 'b'"));
  }

  TEST_CASE("other keys and joints of a file are ignored with one warning, or refused if strict") {
    const test::TemporaryDirectory directory;
    const std::string file = directory / "limits.yaml";
    const auto read = [&](const std::string& yaml, bool strict = false) {
      test::write_file(file, yaml);
      return find_rate_limits(hand(), {}, file, strict);
    };
    const std::string yaml = R"(
robot_description_planning:
  default_velocity_scaling_factor: 0.1
  joint_limits:
    a: {has_jerk: false, max_velocity: 1.5, has_position_limits: true, min_position: -0.5, max_power: 9}
    elbow: {max_velocity: 1}
)";
    const auto limits = require(read(yaml));
    CHECK(limits.velocity[0] == 1.5);
    const std::string key = "robot_description_planning.joint_limits.";
    CHECK(limits.warnings ==
          std::vector<std::string>{file + ": ignored 5 keys (an error if strict): " +
                                   "robot_description_planning.default_velocity_scaling_factor, " +
                                   key + "a.has_jerk, " + key + "a.max_power, " + key +
                                   "a (the robot's limits of position are wider), " + key +
                                   "elbow (no such joint)"});
    CHECK(contains(read(yaml, true).error().message, "scaling_factor: unknown key"));
    CHECK(contains(read("joint_limits: {a: {has_jerk: false}}", true).error().message,
                   "a.has_jerk: unknown key"));
    CHECK(contains(read("joint_limits: {elbow: {max_velocity: 1}}", true).error().message,
                   "robot 'hand' has no such joint"));
    for (const std::string& ignored :
         std::vector<std::string>{"max_effort (limits of torque are not kept)",
                                  "max_torque (limits of torque are not kept)"}) {
      const std::string name = ignored.substr(0, ignored.find(' '));
      const std::string one =
          "joint_limits: {a: {has_torque_limits: true, max_velocity: 1.5, " + name + ": 9}}";
      CAPTURE(one);
      const auto kept = require(read(one));
      CHECK(kept.velocity[0] == 1.5);
      REQUIRE(kept.warnings.size() == 1);
      CHECK(contains(kept.warnings[0], "joint_limits.a." + ignored));
      CHECK(read(one, true).error().code == ErrorCode::unsupported);
    }
    CHECK(read("joint_limits: {a: {max_velocity: .inf}}")->velocity[0] == 1e6);
    CHECK(read("joint_limits: {a: {max_position: 0.5}}", true).error().code ==
          ErrorCode::unsupported);
  }

  TEST_CASE("a deceleration bounds the acceleration, with either sign") {
    const auto acceleration = [](const std::string& joint) {
      return require_limits(hand(), {}, "joint_limits: {a: {" + joint + "}}").acceleration[0];
    };
    CHECK(acceleration("max_acceleration: 2, max_deceleration: -1.5") == 1.5);
    CHECK(acceleration("max_acceleration: 1, max_deceleration: 1.5") == 1);
    CHECK(acceleration("has_deceleration_limits: false, max_deceleration: -1.5") ==
          acceleration("max_velocity: 1"));
  }

  TEST_CASE("a joint that may not move at all is named") {
    const Error still = refusal(hand(R"(velocity="0")"), {}, "");
    CHECK(contains(still.message, "joint 'a': its limit of velocity is 0"));
    CHECK(contains(refusal(hand("", R"(velocity="0")"), {}, "").message, "joint 'b'"));
    CHECK(contains(refusal(hand(R"(velocity="1" acceleration="0")"), {}, "").message,
                   "joint 'a': its limit of acceleration is 0"));
    CHECK(require_limits(hand(R"(velocity="0")"), {}, "joint_limits: {a: {max_velocity: 1}}")
              .velocity[0] == 1);
  }

  TEST_CASE("scales out of range are refused") {
    for (const double bad : {0.0, -1.0, 1.5, std::nan("")}) {
      TrajectorySettings slow, lazy;
      slow.velocity_scale = bad;
      lazy.acceleration_scale = bad;
      CHECK(contains(refusal(hand(), slow, "").message, "'velocity-scale'"));
      CHECK(contains(refusal(hand(), lazy, "").message, "'acceleration-scale'"));
    }
  }
}

}  // namespace mneme::test
