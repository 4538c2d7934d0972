// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "collision/collision_kernels.h"
#include "tables/make_tables.h"
#include "collision/random_worlds.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

int lanes_of(Isa isa) { return internal::collision_kernels(isa).lanes; }

/// One link with a ball of radius 1 mm at 1 m from a continuous joint about z: it draws a circle.
Robot pointer(JointType type = JointType::continuous) {
  Robot::Parts parts;
  parts.name = "pointer";
  parts.links = {{.name = "base"}, {.name = "tip", .spheres = {{{1, 0, 0}, 1e-3}}}};
  Joint joint;
  joint.name = "turn";
  joint.type = type;
  joint.parent_link = 0;
  joint.child_link = 1;
  joint.axis = type == JointType::prismatic ? Vec3::UnitX() : Vec3::UnitZ();
  joint.lower = -kPi;
  joint.upper = kPi;
  parts.joints.push_back(joint);
  return require(make_robot(parts));
}

/// A grain on the circle of the pointer.
Scene grain_at(double angle) {
  return make_circle_scene("grain", {{std::cos(angle), std::sin(angle), 1e-4}});
}

/// n of the documentation: the least multiple of `lanes`, at least one, that is not below `wanted`.
int state_count(double wanted, int lanes) {
  return std::max(1, static_cast<int>(std::ceil(wanted / lanes))) * lanes;
}

bool is_free_motion(const CollisionChecker& checker, double from, double to,
                    const MotionDetail& detail = {}) {
  const std::array a = {from}, b = {to};
  return checker.is_motion_valid(std::span<const double>(a), b, detail);
}

/// The answer of checking the documented states one by one, and how close any of them is to
/// contact.
struct OneByOne {
  bool is_valid = true;
  double nearest = kInfinity;
};
OneByOne check_one_by_one(const CollisionChecker& checker, std::span<const float> from,
                          std::span<const float> to, const MotionDetail& detail) {
  const Robot& robot = checker.robot();
  const Configuration a(from.begin(), from.end()), b(to.begin(), to.end());
  const Configuration delta = robot.difference(a, b);
  const double wanted = robot.distance(a, b) * detail.refinement / checker.resolution();
  const int n = state_count(wanted, lanes_of(checker.isa()));
  OneByOne result;
  for (int k = 1; k <= n; ++k) {
    Configuration q = a;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * k / n;
    const double gap = clearance(robot, checker.scene(), q, detail.margin);
    result.is_valid = result.is_valid && gap >= 0;
    result.nearest = std::min(result.nearest, std::abs(gap));
  }
  return result;
}

/// One cube; its frame stands where it is near the scene's origin.
Octree cube_at(const Vec3& p) {
  return {{Eigen::Matrix3d::Identity(), Vec3(1, 1, 0) - p},
          std::make_shared<Parts<Cube>>(std::vector<Cube>{{p, 0.1}}),
          0};
}

Octree octree_of(std::vector<Cube> cubes) {
  return {{}, std::make_shared<Parts<Cube>>(std::move(cubes)), 0};
}

PointCloud point_at(float x) {
  return {{Eigen::Matrix3d::Identity(), Vec3(1 - x, 1, 0)},
          std::make_shared<Parts<CloudPoint>>(std::vector<CloudPoint>{{x, 0, 0}}),
          0.1};
}

Obstacle named(const std::string& name, const Shape& shape) { return {name, {shape}}; }

/// The state at a point of a chain of motions.
std::vector<float> state_at(const Robot& robot, const std::vector<float>& rows, PathPoint point) {
  const auto row_of = [&](std::size_t i) {
    const std::span<const float> q = row(rows, i, robot);
    return Configuration(q.begin(), q.end());
  };
  const auto motion = static_cast<std::size_t>(point.motion);
  const Configuration from = row_of(motion), delta = robot.difference(from, row_of(motion + 1));
  std::vector<float> q;
  for (std::size_t j = 0; j < from.size(); ++j) {
    q.push_back(static_cast<float>(from[j] + point.fraction * delta[j]));
  }
  return q;
}

TEST_SUITE("unit") {
  TEST_CASE("an obstacle that the kernels cannot check is an error that names it") {
    const Transform here;
    const std::vector<Obstacle> wrong = {
        {"mug", {}},
        named("mug", Cylinder{here, 0.1, kNaN}),
        named("mug", Cylinder{here, 1e9, 0.1}),
        named("mug", Sphere{{kNaN, 0, 0}, 0.1}),
        named("mug", Sphere{{0, 0, 0}, kNaN}),
        named("mug", Sphere{{0, kInfinity, 0}, 0.1}),
        named("mug", Sphere{{0, 0, 0}, 1e9}),
        named("mug", Sphere{{1e9, 0, 0}, 0.1}),
        named("mug", Capsule{{0, 0, kNaN}, {0, 0, 0}, 0.1}),
        named("mug", Capsule{{0, 0, kInfinity}, {0, 0, -kInfinity}, 0.1}),
        named("mug", Capsule{{0, 0, 0}, {1e9, 0, 0}, 0.1}),
        named("mug", Box{{Eigen::Matrix3d::Identity(), {0, kNaN, 0}}, {1, 1, 1}}),
        named("mug", Box{here, {1, kNaN, 1}}),
        named("mug", Box{here, {1, 1, kInfinity}}),
        {"mug", {Sphere{{3, 0, 0}, 0.1}, Sphere{{kNaN, 0, 0}, 0.1}}},
        named("mug", PointCloud{here, nullptr, 0.1}),
        named("mug", Mesh{}),
        named("mug", Octree{}),
        named("mug", octree_of({})),
        named("mug", octree_of({{{0, 0, 0}, -0.1}})),
        named("mug", octree_of({{{0, 0, 0}, 0.5}, {{0, 0, 0}, -0.1}, {{1, 0, 0}, 0.5}})),
        named("mug", octree_of({{{0, 0, 0}, 0.5}, {{0, kNaN, 0}, 0.1}, {{1, 0, 0}, 0.5}})),
    };
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      const Scene scene{"kitchen", {named("plate", Sphere{{5, 0, 0}, 0.1}), wrong[i]}};
      const Error error = require_error(CollisionChecker::make(pointer(), scene));
      CAPTURE(i);
      CHECK(contains(error.message, "'mug'"));
      CHECK(error.code == ErrorCode::invalid);
    }
  }

  TEST_CASE("parts too far out in their own frame, and too many points, are errors") {
    const auto message = [](const Shape& shape) {
      const auto checker = CollisionChecker::make(pointer(), {"", {named("map", shape)}});
      return checker ? "" : checker.error().message;
    };
    CHECK(message(cube_at({9e6, 0, -9e6})).empty());
    CHECK(message(point_at(9e3f)).empty());
    CHECK(message(cube_at({1.1e7, 0, 0})) ==
          "obstacle 'map': its octree has parts beyond 10000 km in their own frame");
    CHECK(message(point_at(1.1e4f)) ==
          "obstacle 'map': its cloud has points beyond 10 km in their own frame");
    const auto many = std::make_shared<Parts<CloudPoint>>(std::vector<CloudPoint>(4'000'001));
    CHECK(message(PointCloud{{}, many, 0.1}) ==
          "obstacle 'map': expected at most 4000000 points, got 4000001");
  }

  TEST_CASE("a margin that the tables of a compound shape cannot keep makes nothing valid") {
    const Robot robot = pointer();
    const std::vector<float> a = {1.5f}, b = {1.6f};
    const auto are_valid = [&](const Shape& shape, double margin) {
      const auto checker = require_checker(robot, {"", {named("far", shape)}});
      CheckCounters counters;
      const std::vector<float> both = {1.5f, 1.6f};
      return std::array{checker.is_motion_valid(a, b, counters, {1, margin}),
                        checker.is_chain_valid(both, counters, {1, margin}),
                        checker.is_sweep_valid(a, b, counters, {margin})};
    };
    const Shape cube = transformed({Eigen::Matrix3d::Identity(), {50, 0, 0}}, cube_at({1, 1, 0}));
    CHECK(are_valid(cube, 0.25) == std::array{true, true, true});
    CHECK(are_valid(cube, 0.26) == std::array{false, false, false});
    CHECK(are_valid(Sphere{{50, 0, 0}, 0.1}, 0.26) == std::array{true, true, true});
  }

  TEST_CASE("settings that make no sense are errors") {
    for (const CheckerSettings& settings :
         {CheckerSettings{.resolution = -1}, CheckerSettings{.resolution = kNaN},
          CheckerSettings{.resolution = 1e-5}, CheckerSettings{.resolution = kInfinity},
          CheckerSettings{.margin = -0.1}, CheckerSettings{.margin = kNaN},
          CheckerSettings{.margin = kInfinity}}) {
      CHECK(require_error(CollisionChecker::make(pointer(), {}, settings)).code ==
            ErrorCode::invalid);
    }
  }

  TEST_CASE("an instruction set is used if the machine has it and refused otherwise") {
    for (const Isa isa : {Isa::scalar, Isa::sse, Isa::avx2, Isa::avx512, Isa::neon, Isa::wasm}) {
      const auto checker = CollisionChecker::make(pointer(), {}, {.isa = isa});
      REQUIRE(checker.has_value() == is_available(isa));
      if (checker) {
        CHECK(checker->isa() == isa);
      } else {
        CHECK(checker.error().code == ErrorCode::unsupported);
        CHECK(contains(checker.error().message, to_string(isa)));
      }
    }
    CHECK(require_checker(pointer(), {}).isa() == default_isa());
  }

  TEST_CASE("the resolution is the one that is asked for, or the robot's default") {
    CHECK(require_checker(planar8(), {}).resolution() == 0.02);
    CHECK(require_checker(pointer(JointType::prismatic), {}).resolution() == 1.0 / 32);
    CHECK(require_checker(planar8(), {}, {.resolution = 0.5}).resolution() == 0.5);
  }

  TEST_CASE("nothing is in the way in an empty scene") {
    const CollisionChecker checker = require_checker(pointer(), {});
    Rng rng(301);
    for (const std::uint8_t is_valid :
         check_all(checker, random_states(checker.robot(), 99, rng))) {
      CHECK(is_valid == 1);
    }
    CHECK(is_free_motion(checker, -3, 3));
    CHECK(checker.robot().name() == "pointer");
    CHECK(checker.scene().obstacles.empty());
  }

  TEST_CASE("a link that never moves blocks nothing, but what it touches is told") {
    Robot::Parts parts;
    parts.name = "stand";
    parts.links = {{.name = "floor"},
                   {.name = "post", .capsules = {{{0, 0, 0}, {0, 0, 1}, 0.1}}},
                   {.name = "flap", .spheres = {{{1, 0, 0}, 0.1}}},
                   {.name = "arm", .spheres = {{{5, 0, 0}, 0.1}}}};
    for (int i = 0; i < 3; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = i == 0 ? JointType::fixed : JointType::revolute;
      joint.parent_link = i == 2 ? 0 : i;
      joint.child_link = i + 1;
      joint.axis = Vec3::UnitZ();
      joint.lower = -2;
      joint.upper = 2;
      joint.origin.translation = Vec3(0, 0, i == 0 ? 2 : 0);
      parts.joints.push_back(joint);
    }
    const auto robot =
        make_robot(parts, {.joints = {"joint2"}, .fixed_values = {{"joint1", kPi / 2}}});
    REQUIRE(robot.has_value());
    const auto fixed_link_at = [&](const Vec3& center, double margin = 0) {
      const Scene scene{"s", {named("ball", Sphere{center, 0.2})}};
      const auto checker = require_checker(*robot, scene, {.margin = margin});
      CHECK(checker.is_valid(std::array{1.0}));
      CHECK(is_free_motion(checker, 0, 1));
      CHECK(checker.contacts(std::array{1.0}).empty());
      const auto contacts = checker.fixed_contacts();
      return contacts.empty() ? "" : contacts[0].link;
    };
    CHECK(fixed_link_at({0, 0.25, 2.5}) == "post");
    CHECK(fixed_link_at({0, 0.25, 2.5}, 0.1) == "post");
    CHECK(fixed_link_at({0, 0.35, 2.5}, 0.1) == "");
    // The flap stands still at 90 degrees, outside the group.
    CHECK(fixed_link_at({0, 1, 2}) == "flap");
    CHECK(fixed_link_at({1, 0, 2}) == "");
  }

  TEST_CASE("the margin inflates the robot against obstacles but not against itself") {
    Robot::Parts parts;
    parts.name = "scissors";
    parts.links = {{.name = "base"},
                   {.name = "left", .capsules = {{{0.8, 0, 0}, {1, 0, 0}, 0.1}}},
                   {.name = "right", .spheres = {{{1, 0, 0.201}, 0.1}}}};
    for (int i = 0; i < 2; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = JointType::continuous;
      joint.parent_link = 0;
      joint.child_link = i + 1;
      joint.axis = Vec3::UnitZ();
      parts.joints.push_back(joint);
    }
    const auto robot = require(make_robot(parts));
    REQUIRE(robot.self_pairs().size() == 1);
    const Configuration q = {0, 0};
    const Scene scene{"s", {named("ball", Sphere{{1.5, 0, 0}, 0.2})}};  // 0.2 from the left ball
    for (const Isa isa : available_isas()) {
      CHECK(require_checker(robot, {}, {.margin = 5, .isa = isa}).is_valid(q));
      CHECK(require_checker(robot, scene, {.margin = 0.199, .isa = isa}).is_valid(q));
      CHECK(!require_checker(robot, scene, {.margin = 0.201, .isa = isa}).is_valid(q));
      const auto checker = require_checker(robot, scene, {.margin = 0.1, .isa = isa});
      CHECK(checker.is_motion_valid(q, q, {.margin = 0.099}));
      CHECK(!checker.is_motion_valid(q, q, {.margin = 0.101}));
    }
  }

  TEST_CASE("a motion looks at exactly the documented states") {
    for (const Isa isa : available_isas()) {
      const CheckerSettings settings{.resolution = 0.1, .isa = isa};
      for (const double length : {0.05, 1.0, 1.61, 3.05}) {
        const double from = -1.2;
        const int n = state_count(length / 0.1, lanes_of(isa));
        const auto is_free_with_grain = [&](double k) {
          return is_free_motion(
              require_checker(pointer(), grain_at(from + k * length / n), settings), from,
              from + length);
        };
        INFO(to_string(isa) << ", length " << length << ", " << n << " states");
        CHECK(is_free_with_grain(0));
        for (int k = 1; k <= n; ++k) REQUIRE(!is_free_with_grain(k));
        for (int k = 0; k <= n && length > 1; ++k) REQUIRE(is_free_with_grain(k + 0.5));
      }
    }
  }

  TEST_CASE("refinement divides the distance between the states of a motion") {
    for (const Isa isa : available_isas()) {
      const CheckerSettings settings{.resolution = 0.1, .isa = isa};
      const int n = state_count(3.0 / 0.1 * 10, lanes_of(isa));
      for (int k = 1; k <= n; k += 7) {
        const auto checker = require_checker(pointer(), grain_at(-1.2 + 3.0 * k / n), settings);
        REQUIRE(!is_free_motion(checker, -1.2, 1.8, {.refinement = 10}));
      }
    }
  }

  TEST_CASE("a motion of length zero looks at its end") {
    for (const Isa isa : available_isas()) {
      const auto checker = require_checker(pointer(), grain_at(0.5), {.isa = isa});
      CHECK(!is_free_motion(checker, 0.5, 0.5));
      CHECK(is_free_motion(checker, 0.6, 0.6));
    }
  }

  TEST_CASE("continuous joints take the shorter way round and others do not") {
    for (const Isa isa : available_isas()) {
      const CheckerSettings settings{.margin = 0.05, .isa = isa};
      const auto is_free = [&](JointType type, double grain, double from, double to) {
        return is_free_motion(require_checker(pointer(type), grain_at(grain), settings), from, to);
      };
      CHECK(!is_free(JointType::continuous, kPi, 3, -3));
      CHECK(!is_free(JointType::continuous, kPi, -3, 3));
      CHECK(is_free(JointType::continuous, 0, 3, -3));
      CHECK(is_free(JointType::continuous, 1.5, 3, 3 + 4 * kPi));
      CHECK(is_free(JointType::revolute, kPi, 3, -3));
      CHECK(!is_free(JointType::revolute, 0, 3, -3));
      CHECK(!is_free(JointType::revolute, 1.5, -3, 3));
    }
  }

  TEST_CASE("a prismatic joint moves along its axis") {
    const Scene scene{"s",
                      {named("wall", Box{{Eigen::Matrix3d::Identity(), {2, 0, 0}}, {0.1, 1, 1}})}};
    for (const Isa isa : available_isas()) {
      const auto checker = require_checker(pointer(JointType::prismatic), scene, {.isa = isa});
      CHECK(is_free_motion(checker, -2, 0.89));
      CHECK(!is_free_motion(checker, 0, 0.91));
      CHECK(!is_free_motion(checker, 0.5, 1.5));
    }
  }

  TEST_CASE("counters count motions, and states by the vector") {
    for (const Isa isa : available_isas()) {
      const auto lanes = static_cast<std::uint64_t>(lanes_of(isa));
      const auto checker = require_checker(pointer(), grain_at(2), {.resolution = 0.1, .isa = isa});
      CheckCounters counters;
      const auto is_free = [&](float from, float to) {
        return checker.is_motion_valid(std::array{from}, std::array{to}, counters);
      };
      REQUIRE(is_free(0, 1.55f));
      std::uint64_t expected = static_cast<std::uint64_t>(state_count(15.5, lanes_of(isa)));
      CHECK(counters.states == expected);
      CHECK(counters.motions == 1);
      REQUIRE(is_free(1, 1));
      CHECK(counters.states == expected + lanes);
      CHECK(counters.motions == 2);
      // The end is among the states that are checked first.
      REQUIRE(!is_free(-0.5f, 2));
      CHECK(counters.states == expected + 2 * lanes);
      CHECK(counters.motions == 3);
    }
  }

  TEST_CASE("values that are not finite, or too large for single precision, are not valid") {
    const Scene scene{"s", {named("shell", Sphere{{0, 0, 5}, 4.5})}};
    for (const JointType type : {JointType::continuous, JointType::prismatic}) {
      for (const Isa isa : available_isas()) {
        const CollisionChecker checker = require_checker(pointer(type), scene, {.isa = isa});
        CHECK(checker.is_valid(std::array{1e4}));
        for (const double value : {1.1e4, -1e9, 1e30, -1e300, kInfinity, kNaN}) {
          INFO(to_string(isa), ", ", value);
          CHECK(!checker.is_valid(std::array{value}));
          CHECK(!is_free_motion(checker, value, value));
          CHECK(!is_free_motion(checker, 0, value));
          CHECK(!is_free_motion(checker, value, 0));
        }
      }
    }
  }

  TEST_CASE("copies of a checker answer like the original") {
    const CollisionChecker copy = [] { return require_checker(pointer(), grain_at(1)); }();
    CHECK(!copy.is_valid(std::array{1.0}));
    CHECK(copy.is_valid(std::array{1.1}));
    CHECK(copy.is_valid(std::array{1.1f}));
  }
}

TEST_SUITE("law") {
  TEST_CASE("a motion is valid if its documented states are, one by one") {
    Rng rng(302);
    int valid_count = 0, invalid_count = 0;
    for (int i = 0; i < 24; ++i) {
      const bool is_planar = i % 3 == 0;
      const Robot robot = is_planar ? planar8() : random_robot(rng);
      const Scene scene =
          is_planar ? random_circles(3, rng) : random_scene(robot, 4, rng, small_shape);
      const auto starts = random_states(robot, 20, rng, 0.5),
                 ends = random_states(robot, 20, rng, 0.5);
      MotionDetail detail;
      if (i % 4 == 1) detail = {.refinement = 2.5, .margin = 0.01};
      for (const Isa isa : available_isas()) {
        const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
        for (std::size_t k = 0; k < 20; ++k) {
          // Short motions are free now and then; long ones hardly ever.
          const auto from = row(starts, k, robot), far = row(ends, k, robot);
          std::vector<float> to(from.begin(), from.end());
          for (std::size_t j = 0; j < to.size(); ++j) {
            to[j] += (far[j] - from[j]) * (k % 2 == 0 ? 0.05f : 0.4f);
          }
          CheckCounters counters;
          const bool is_valid = checker.is_motion_valid(from, to, counters, detail);
          const OneByOne expected = check_one_by_one(checker, from, to, detail);
          ++(expected.is_valid ? valid_count : invalid_count);
          INFO("seed 302, world " << i << ", motion " << k << ", " << to_string(isa)
                                  << ", nearest to contact " << expected.nearest);
          REQUIRE((is_valid == expected.is_valid || expected.nearest < 1e-5));
        }
      }
    }
    CHECK(valid_count > 200);
    CHECK(invalid_count > 200);
  }

  TEST_CASE("a chain of motions is valid if states of it at the resolution are, one by one") {
    Rng rng(304);
    int valid_count = 0, invalid_count = 0;
    for (int i = 0; i < 60; ++i) {
      const Robot robot = i % 3 == 0 ? planar8() : random_robot(rng);
      const Scene scene =
          i % 3 == 0 ? random_circles(3, rng) : random_scene(robot, 4, rng, small_shape);
      const auto joints = static_cast<std::size_t>(robot.joint_count());
      const std::size_t count = 2 + rng.index(24);
      std::vector<float> rows = random_states(robot, 1, rng, 0.5);
      while (rows.size() < count * joints) {
        const float last = rows[rows.size() - joints];
        rows.push_back(last + 0.05f * static_cast<float>(rng.normal()));
      }
      for (const Isa isa : available_isas()) {
        const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
        const auto are_states_free = [&](double margin) {
          CheckCounters counters;
          for (std::size_t k = 0; k + 1 < count; ++k) {
            const std::span<const float> from(&rows[k * joints], joints);
            const std::span<const float> to(&rows[(k + 1) * joints], joints);
            const Configuration a(from.begin(), from.end()), b(to.begin(), to.end());
            const Configuration delta = robot.difference(a, b);
            const int states =
                std::max(1, static_cast<int>(std::ceil(robot.distance(a, b) / checker.resolution() *
                                                       (1 - 1e-5))));
            for (int state = 1; state <= states; ++state) {
              std::vector<float> q(joints);
              for (std::size_t j = 0; j < joints; ++j) {
                q[j] = static_cast<float>(a[j] + delta[j] * state / states);
              }
              if (!checker.is_motion_valid(q, q, counters, {1, margin})) return false;
            }
          }
          return true;
        };
        CheckCounters counters;
        INFO("seed 304, world " << i << ", " << to_string(isa));
        std::optional<PathPoint> contact;
        const bool is_valid = checker.is_chain_valid(rows, counters, {}, &contact);
        ++(is_valid ? valid_count : invalid_count);
        CHECK(contact.has_value() == !is_valid);
        if (contact) {
          const std::vector<float> q = state_at(robot, rows, *contact);
          CheckCounters others;
          CHECK(!checker.is_motion_valid(q, q, others, {1, 1e-5}));
        }
        CHECK(counters.motions <= count - 1);
        if (is_valid) {
          // Self-contact has no margin: a state that only rounding decides is rare enough.
          CHECK(are_states_free(0));
          CHECK(checker.is_chain_valid({rows.data(), joints}, counters));
        } else {
          CHECK(!are_states_free(1e-5));
        }
      }
    }
    CHECK(valid_count > 20);
    CHECK(invalid_count > 20);
  }

  TEST_CASE("a larger margin never makes a state valid") {
    const Robot robot = planar8();
    Rng rng(303);
    const Scene scene = random_circles(5, rng);
    const auto rows = random_states(robot, 5000, rng, 0.4);
    auto smaller = check_all(require_checker(robot, scene), rows);
    for (const double margin : {0.03, 0.2, 1.0}) {
      const auto larger = check_all(require_checker(robot, scene, {.margin = margin}), rows);
      for (std::size_t i = 0; i < larger.size(); ++i) REQUIRE(larger[i] <= smaller[i]);
      CHECK(larger != smaller);
      smaller = larger;
    }
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("copies of a robot share their tables, other robots do not, even equal ones") {
    const Robot robot = planar8();
    const Robot copy = robot;  // NOLINT(performance-unnecessary-copy-initialization)
    const auto own = require(internal::share_checked_robot(robot));
    const auto of_copy = require(internal::share_checked_robot(copy));
    const auto of_other = require(internal::share_checked_robot(planar8()));
    CHECK(own == of_copy);
    CHECK(own != of_other);
    CHECK(own->tables.joint_count == 8);
  }

  TEST_CASE("tables are let go with the last copy of their robot") {
    std::weak_ptr<const internal::CheckedRobot> tables;
    {
      const Robot robot = planar8();
      tables = *internal::share_checked_robot(robot);
      CHECK(!tables.expired());
    }
    // The next robot clears the place of those that are gone.
    CHECK(internal::share_checked_robot(planar8()).has_value());
    CHECK(tables.expired());
  }

  TEST_CASE("a robot with too many joints is refused each time") {
    Robot::Parts parts;
    parts.name = "snake";
    parts.links.push_back({.name = "link0"});
    for (int i = 1; i <= 80; ++i) {
      parts.links.push_back({.name = "link" + std::to_string(i)});
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = JointType::continuous;
      joint.parent_link = i - 1;
      joint.child_link = i;
      parts.joints.push_back(joint);
    }
    const auto robot = require(make_robot(parts));
    for (int i = 0; i < 2; ++i) {
      CHECK(require_error(internal::share_checked_robot(robot)).code == ErrorCode::unsupported);
    }
  }
}

}  // namespace mneme::test
