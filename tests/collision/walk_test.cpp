// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "collision/walking_robots.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

constexpr float kSentinel = 1234.5f;

double most_difference(std::span<const float> a, std::span<const float> b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, static_cast<double>(std::abs(a[i] - b[i])));
  }
  return most;
}

/// Checks that pulled points go by the step's length to where the next ones of the limb were.
void check_pull(const Robot& robot, const Configuration& q, OwnedStep step, double tolerance) {
  const CollisionChecker checker = require_checker(robot, {});
  const LimbFinder finder(robot);
  const auto limb = static_cast<std::size_t>(step.limb);
  const std::vector<Vec3> before = finder.points(q)[limb];
  step.length = static_cast<float>(0.01 * LimbFinder::length_of(before));
  const Configuration end = to_configuration(step.take(checker, to_row(q)));
  const std::vector<Vec3> after = finder.points(end)[limb];
  for (int i = 0; i < step.pulled_points; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 aim = before[k] + step.length * (before[k + 1] - before[k]).normalized();
    CHECK((after[k] - aim).norm() < tolerance * step.length);
  }
}

/// `rows` with continuous joints turned to where they are closest to `like`.
std::vector<float> unwrapped(const Robot& robot, std::vector<float> rows,
                             const std::vector<float>& like) {
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (robot.group_joint(static_cast<int>(i % joints)).type != JointType::continuous) continue;
    rows[i] = like[i] + static_cast<float>(std::remainder(rows[i] - like[i], 2 * kPi));
  }
  return rows;
}

/// True if rounding decides where a step leads: which ball is deepest, which face is closest.
bool hinges_on_rounding(const CollisionChecker& checker, const OwnedStep& step,
                        const std::vector<float>& from) {
  const std::vector<float> expected = step.take(checker, from);
  Rng rng(99);
  for (int i = 0; i < 20; ++i) {
    std::vector<float> near = from;
    for (float& value : near) value += static_cast<float>(rng.uniform(-1e-6, 1e-6));
    const std::vector<float> rows = unwrapped(checker.robot(), step.take(checker, near), expected);
    if (most_difference(rows, expected) > 2e-4) return true;
  }
  return false;
}

/// Checks that a candidate is within the limits, whatever the step.
void check_within_limits(const Robot& robot, std::span<const float> candidate) {
  for (int j = 0; j < robot.joint_count(); ++j) {
    const Joint& joint = robot.group_joint(j);
    const double value = candidate[static_cast<std::size_t>(j)];
    const double slack = joint.type == JointType::continuous ? 1e-6 : 0;
    REQUIRE(value >= joint.lower - slack);
    REQUIRE(value <= joint.upper + slack);
  }
}

/// A random configuration, some of whose joints are at a limit.
std::vector<float> random_start(const CollisionChecker& checker, Rng& rng) {
  const Robot& robot = checker.robot();
  std::vector<float> q = random_states(robot, 1, rng);
  for (int j = 0; j < robot.joint_count(); ++j) {
    const Joint& joint = robot.group_joint(j);
    const std::uint32_t kind = rng.index(6);
    if (kind > 1) continue;
    const double limit = kind == 0 ? joint.lower : joint.upper;
    // Rounded to the inside, as planners do.
    auto& value = q[static_cast<std::size_t>(j)];
    value = static_cast<float>(limit);
    if (value < joint.lower || value > joint.upper) value = std::nextafter(value, 0.0f);
  }
  return q;
}

OwnedStep random_step(const CollisionChecker& checker, int candidates, Rng& rng) {
  const std::vector<LimbInfo> limbs = checker.limbs();
  OwnedStep step(checker.robot(), candidates);
  step.limb = static_cast<int>(rng.index(static_cast<std::uint32_t>(limbs.size())));
  const LimbInfo& limb = limbs[static_cast<std::size_t>(step.limb)];
  step.pulled_points = 1 + static_cast<int>(rng.index(static_cast<std::uint32_t>(limb.points)));
  step.length = static_cast<float>(rng.uniform(0.01, 0.05) * limb.length);
  step.clearance = static_cast<float>(0.01 * limb.length);
  for (float& value : step.drift) value = static_cast<float>(rng.uniform(-5, 5) / limb.length);
  step.randomise_jitter(rng, 0.6);
  return step;
}

/// `robot` in a scene of `count` obstacles around it.
CollisionChecker cluttered(const Robot& robot, int count, Rng& rng,
                           const CheckerSettings& settings = {}) {
  return require_checker(robot, random_scene(robot, count, rng, small_shape), settings);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the tip goes by the length of the step towards the next point of its limb") {
    for (const auto& [kind, robot, bent] : walking_robots()) {
      const auto& name = kind;
      const auto count = require_checker(robot, {}).limbs().size();
      for (std::size_t limb = 0; limb < count; ++limb) {
        INFO(name, ", limb ", limb);
        OwnedStep step(robot, 1);
        step.limb = static_cast<int>(limb);
        check_pull(robot, bent, step, 0.02);
      }
    }
  }

  TEST_CASE("points on a straight line are pulled along it together") {
    const Robot robot = planar8();
    for (const int pulled : {1, 2, 3}) {
      INFO(pulled, " points");
      OwnedStep step(robot, 1);
      step.pulled_points = pulled;
      check_pull(robot, {0.4, 0.9, -1.1, 0.5, 0.7, -0.6, 0, 0}, step, 0.05);
    }
  }

  TEST_CASE("a jitter is added to the direction of the pull, which stays a unit vector") {
    const Robot robot = planar8();
    const Configuration q = {0.4, 0.9, -1.1, 0.5, 0.7, -0.6, 1, -0.8};
    const CollisionChecker checker = require_checker(robot, {});
    const LimbFinder finder(robot);
    const std::vector<Vec3> before = finder.points(q)[0];
    OwnedStep step(robot, 3);
    step.length = 0.05f;
    step.jitter = {0.5f, -0.25f, 0, -0.75f, 0.5f, 0, 0, 2, 0};
    const std::vector<float> rows = step.take(checker, to_row(q));
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 jitter(step.jitter[3 * i], step.jitter[3 * i + 1], 0);
      const Vec3 direction = ((before[1] - before[0]).normalized() + jitter).normalized();
      const Vec3 tip = finder.points(to_configuration(row(rows, i, robot)))[0][0];
      CHECK((tip - before[0] - step.length * direction).norm() < 0.02 * step.length);
    }
  }

  TEST_CASE("a step of length 0 away from obstacles stays where it is") {
    for (const auto& [kind, robot, bent] : walking_robots()) {
      const auto& name = kind;
      INFO(name);
      OwnedStep step(robot, 2);
      step.clearance = 0.1f;
      const std::vector<float> from = to_row(bent);
      const std::vector<float> rows = step.take(require_checker(robot, {}), from);
      CHECK(most_difference(row(rows, 0, robot), from) < 1e-5);
      CHECK(most_difference(row(rows, 1, robot), from) < 1e-5);
    }
  }

  TEST_CASE("drift moves joints that nothing pulls, by as much as it says") {
    const Robot robot = two_arms();
    const CollisionChecker checker = require_checker(robot, {});
    REQUIRE(checker.limbs().size() == 2);
    const std::vector<float> from = to_row(Configuration{0.3, 0.2, -0.5, 1.2, -0.3, -0.4, 1.1});
    OwnedStep step(robot, 1);
    step.length = 0.02f;
    step.drift = {0, 1, 2, -3, 4, -5, 1.5f};
    // The limb of the latest link comes first: the right arm, of the last three joints.
    for (const auto& [limb, free] : {std::pair(0, 1), std::pair(1, 4)}) {
      step.limb = limb;
      const std::vector<float> end = step.take(checker, from);
      for (int j = free; j < free + 3; ++j) {
        const auto i = static_cast<std::size_t>(j);
        CHECK(end[i] == doctest::Approx(from[i] + step.drift[i] * step.length).epsilon(1e-5));
      }
    }
  }

  TEST_CASE("drift of joints that are pulled leaves the tip where it is pulled to") {
    const Robot robot = planar8();
    OwnedStep step(robot, 1), still(robot, 1);
    for (std::size_t j = 0; j < step.drift.size(); ++j) step.drift[j] = j % 3 == 0 ? 0.4f : -0.3f;
    const Configuration q = {0.4, 0.9, -1.1, 0.5, 0.7, -0.6, 1, -0.8};
    check_pull(robot, q, step, 0.05);
    step.length = still.length = 0.1f;
    const CollisionChecker checker = require_checker(robot, {});
    CHECK(most_difference(step.take(checker, to_row(q)), still.take(checker, to_row(q))) > 0.01);
  }

  TEST_CASE("a continuous joint goes on beyond half a turn and is wrapped, another one stops") {
    const Robot robot = two_arms();
    const Robot arm = ball_arm();
    OwnedStep step(arm, 1);
    step.length = 0.01f;
    step.jitter = {0, -3, 0};
    // Folded back towards -x at half a turn of the column: a pull towards -y turns it on.
    const std::vector<float> from = to_row(Configuration{3.14, -0.8, -1.2, 0});
    const std::vector<float> end = step.take(require_checker(arm, {}), from);
    CHECK(end[0] < -3);
    check_within_limits(arm, end);

    OwnedStep drifting(robot, 1);
    drifting.length = 0.1f;
    drifting.drift[1] = 50;
    const std::vector<float> stopped =
        drifting.take(require_checker(robot, {}), to_row(Configuration{0, 1.9, 0, 1, 0, 0, 1}));
    CHECK(stopped[1] == 2);
  }

  TEST_CASE("any number of candidates is written, each that of its jitter, and nothing else") {
    Rng rng(7);
    const Robot robot = ball_arm();
    for (const Isa isa : available_isas()) {
      const CollisionChecker checker = cluttered(robot, 30, rng, {.isa = isa});
      const OwnedStep all = random_step(checker, 37, rng);
      const std::vector<float> from = random_start(checker, rng);
      const std::vector<float> expected = all.take(checker, from);
      for (std::size_t count = 0; count <= 37; ++count) {
        INFO(to_string(isa), ", ", count, " candidates");
        OwnedStep some = all;
        some.jitter.resize(3 * count);
        some.jitter.shrink_to_fit();
        const std::vector<float> rows = some.take(checker, from);
        CHECK(std::equal(rows.begin(), rows.end(), expected.begin()));
      }
    }
  }

  TEST_CASE("no more is written than there are jitters") {
    const Robot robot = ball_arm();
    for (const Isa isa : available_isas()) {
      const CollisionChecker checker = require_checker(robot, {}, {.isa = isa});
      OwnedStep step(robot, 5);
      const std::vector<float> from = to_row(Configuration{1, -0.8, -1.2, 0.9});
      std::vector<float> room(6 * from.size(), kSentinel);
      WalkStep request{0, 1, 0.01f, 0, step.drift, step.jitter};
      CheckCounters counters;
      checker.walk(from, request, std::span(room).first(5 * from.size()), counters);
      CHECK(std::count(room.begin(), room.end(), kSentinel) == std::ssize(from));
      CHECK(std::count(room.end() - std::ssize(from), room.end(), kSentinel) == std::ssize(from));
    }
  }

  TEST_CASE("each candidate may begin at a configuration of its own, and need not be pulled") {
    Rng rng(11);
    const Robot robot = ball_arm();
    for (const Isa isa : available_isas()) {
      const CollisionChecker checker = cluttered(robot, 30, rng, {.isa = isa});
      OwnedStep step(robot, 1);
      const WalkStep one{0, 0, 0, 0.05f, step.drift, step.jitter};
      std::vector<float> starts, expected;
      CheckCounters counters;
      for (int i = 0; i < 19; ++i) {
        const std::vector<float> from = random_start(checker, rng);
        std::vector<float> to(from.size());
        checker.walk(from, one, to, counters);
        starts.insert(starts.end(), from.begin(), from.end());
        expected.insert(expected.end(), to.begin(), to.end());
      }
      OwnedStep steps(robot, 19);
      const WalkStep all{0, 0, 0, 0.05f, steps.drift, steps.jitter};
      std::vector<float> rows(starts.size());
      checker.walk(starts, all, rows, counters);
      CHECK(rows != starts);
      for (std::size_t i = 0; i < rows.size(); ++i)
        CHECK(rows[i] == doctest::Approx(expected[i]).epsilon(1e-4));
    }
  }

  TEST_CASE("limbs lead from each tip to the first joint that turns") {
    const auto limbs_of = [](const Robot& robot) { return require_checker(robot, {}).limbs(); };
    const std::vector<LimbInfo> planar = limbs_of(planar_arm({1, 0.8, 0.6}));
    REQUIRE(planar.size() == 1);
    CHECK(planar[0].points == 3);
    CHECK(planar[0].length == doctest::Approx(2.4));
    const std::vector<LimbInfo> arms = limbs_of(two_arms());
    REQUIRE(arms.size() == 2);
    for (const LimbInfo& arm : arms) {
      CHECK(arm.points == 4);
      CHECK(arm.length == doctest::Approx(0.4 + 0.45 + 0.1 + std::hypot(0.3, 0.2)));
    }
    const std::vector<LimbInfo> following = limbs_of(following_arm());
    REQUIRE(following.size() == 1);
    CHECK(following[0].points == 4);
    CHECK(following[0].length == doctest::Approx(0.45 + 0.5 + 0.5 + 0.1));
    const std::vector<LimbInfo> hand = limbs_of(sliding_hand(false));
    REQUIRE(hand.size() == 1);
    CHECK(hand[0].points == 2);
    CHECK(hand[0].length == doctest::Approx(0.75));
  }

  TEST_CASE("robots without turning joints have no limb, nor have those of too many joints") {
    Robot::Parts parts = parts_named("slides");
    for (const int axis : {0, 1, 2}) {
      hang_next(parts, JointType::prismatic, Vec3(0.1, 0, 0), Vec3::Unit(axis), 2,
                {{Vec3(0.1, 0, 0), 0.05}});
    }
    CHECK(require_checker(robot_of(parts), {}).limbs().empty());
    CHECK(require_checker(long_chain(33), {}).limbs().empty());
    const Robot longest = long_chain(32);
    const std::vector<LimbInfo> limbs = require_checker(longest, {}).limbs();
    REQUIRE(limbs.size() == 1);
    CHECK(limbs[0].points == 32);
    OwnedStep step(longest, 3);
    step.pulled_points = 32;
    step.length = 0.01f;
    for (const float value :
         step.take(require_checker(longest, {}), std::vector<float>(32, 0.1f))) {
      CHECK(std::isfinite(value));
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("candidates lie within the limits, wherever a step begins") {
    for (const auto& [kind, robot, bent] : walking_robots()) {
      const auto& name = kind;
      INFO(name);
      Rng rng(11);
      const CollisionChecker checker = cluttered(robot, 20, rng);
      for (int i = 0; i < rounds(200); ++i) {
        const OwnedStep step = random_step(checker, 5, rng);
        const std::vector<float> rows = step.take(checker, random_start(checker, rng));
        for (std::size_t k = 0; k < 5; ++k) check_within_limits(robot, row(rows, k, robot));
      }
    }
  }

  TEST_CASE("the margin of a checker adds to the clearance") {
    Rng rng(12);
    const Robot robot = ball_arm();
    const Scene scene = random_scene(robot, 30, rng, small_shape);
    const CollisionChecker wide = require_checker(robot, scene, {.margin = 0.03125});
    const CollisionChecker plain = require_checker(robot, scene);
    int different = 0;
    for (int i = 0; i < 50; ++i) {
      OwnedStep step = random_step(plain, 3, rng);
      step.clearance = 0.0625f;
      const std::vector<float> from = random_start(plain, rng);
      const std::vector<float> narrow = step.take(plain, from), widened = step.take(wide, from);
      step.clearance += 0.03125f;
      CHECK(step.take(plain, from) == widened);
      different += narrow != widened ? 1 : 0;
    }
    CHECK(different > 10);
  }

  TEST_CASE("a robot and its scene may turn together") {
    const Robot robot = ball_arm();
    Rng rng(13);
    for (int i = 0; i < rounds(60); ++i) {
      INFO("round ", i);
      const double angle = rng.uniform(-1.5, 1.5);
      Scene scene{"", {}};
      for (int k = 0; k < 12; ++k) {
        // Half of the boxes stand upright, so that they give the scene its axes.
        Shape shape = small_shape(rng);
        const Vec3 place = Vec3{rng.uniform(0.3, 1), rng.uniform(-1, 1), rng.uniform(-0.2, 1)};
        const Transform pose = k % 2 == 0 ? Transform{Eigen::Matrix3d::Identity(), place}
                                          : Transform{random_pose(rng, 1).rotation, place};
        if (k % 2 == 0) shape = small_box(rng);
        scene.obstacles.push_back({"o" + std::to_string(k), {transformed(pose, shape)}});
      }
      const Scene turned = moved_scene({rotation_about(Vec3::UnitZ(), angle), Vec3::Zero()}, scene);
      const CollisionChecker checker = require_checker(robot, scene);
      const CollisionChecker other = require_checker(robot, turned);
      OwnedStep step = random_step(checker, 1, rng);
      step.jitter = {0, 0, 0};
      std::vector<float> from = random_states(robot, 1, rng);
      from[0] = static_cast<float>(rng.uniform(-1.5, 1.5));
      if (hinges_on_rounding(checker, step, from)) continue;
      const std::vector<float> here = step.take(checker, from);
      from[0] += static_cast<float>(angle);
      std::vector<float> there = step.take(other, from);
      there[0] -= static_cast<float>(angle);
      CHECK(most_difference(here, unwrapped(robot, there, here)) < 1e-3);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("all instruction sets take the same steps") {
    Rng rng(14);
    int compared = 0;
    for (int round = 0; round < rounds(100); ++round) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 20, rng, small_shape);
      std::vector<CollisionChecker> checkers;
      for (const Isa isa : available_isas()) {
        checkers.push_back(require_checker(robot, scene, {.isa = isa}));
      }
      if (checkers[0].limbs().empty()) continue;
      const OwnedStep step = random_step(checkers[0], 7, rng);
      const std::vector<float> from = random_start(checkers[0], rng);
      if (hinges_on_rounding(checkers[0], step, from)) continue;
      ++compared;
      const std::vector<float> expected = step.take(checkers[0], from);
      for (const CollisionChecker& checker : checkers) {
        INFO("round ", round, ", ", to_string(checker.isa()));
        CHECK(most_difference(unwrapped(robot, step.take(checker, from), expected), expected) <
              1e-3);
      }
    }
    CHECK(compared >= 80);
  }

  TEST_CASE("limbs are those that the robot's own kinematics have") {
    Rng rng(15);
    for (int round = 0; round < rounds(200); ++round) {
      INFO("round ", round);
      const Robot robot = random_robot(rng);
      const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
      const auto points = LimbFinder(robot).points(zero);
      const std::vector<LimbInfo> limbs = require_checker(robot, {}).limbs();
      REQUIRE(limbs.size() == points.size());
      for (std::size_t i = 0; i < limbs.size(); ++i) {
        CHECK(limbs[i].points == std::ssize(points[i]) - 1);
        CHECK(limbs[i].length == doctest::Approx(LimbFinder::length_of(points[i])));
      }
    }
  }
}

}  // namespace mneme::test
