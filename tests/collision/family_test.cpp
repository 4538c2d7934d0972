// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/random_worlds.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace mneme::test {
namespace {

/// A random family of bending motions, evaluated in double precision.
struct RandomFamily {
  GoalShift shift;
  std::vector<float> from, to;
  float first_share = 0, last_share = 0;

  RandomFamily(const Robot& robot, int parameters, double bend, Rng& rng) {
    const int joints = robot.joint_count();
    const auto row = [&](int count, double size) {
      std::vector<float> values;
      for (int i = 0; i < count * joints; ++i) {
        values.push_back(static_cast<float>(rng.uniform(-size, size)));
      }
      return values;
    };
    shift.parameters = parameters;
    shift.constant = row(1, bend);
    shift.slopes = row(parameters, bend);
    shift.curvatures = row(parameters * parameters, 0.3 * bend);
    for (int k = 0; k < parameters; ++k) {
      for (int l = 0; l < k; ++l) {
        for (int j = 0; j < joints; ++j) curvature(k, l, j) = curvature(l, k, j);
      }
    }
    for (const float value : row(1, 0.02 * bend)) shift.rest.push_back(std::abs(value));
    from = random_states(robot, 1, rng, 0.5);
    to = from;
    for (float& value : to) value += static_cast<float>(rng.uniform(-0.4, 0.4));
    first_share = static_cast<float>(rng.index(3)) * 0.4f;
    last_share = static_cast<float>(rng.index(3)) * 0.4f;
  }

  [[nodiscard]] float& curvature(int k, int l, int j) {
    const auto joints = shift.constant.size();
    return shift.curvatures[static_cast<std::size_t>(k * shift.parameters + l) * joints +
                            static_cast<std::size_t>(j)];
  }
  [[nodiscard]] FamilyMotion motion() const { return {&shift, from, to, first_share, last_share}; }

  /// The state at a time and parameters, with a share in [-1, 1] of each joint's rest.
  [[nodiscard]] Configuration at(double time, const std::array<double, kMostParameters>& u,
                                 const std::vector<double>& rest) const {
    Configuration q;
    const double share = first_share + time * (double{last_share} - first_share);
    const auto joints = from.size(), parameters = static_cast<std::size_t>(shift.parameters);
    for (std::size_t j = 0; j < joints; ++j) {
      double bent = shift.constant[j] + rest[j] * shift.rest[j];
      for (std::size_t k = 0; k < parameters; ++k) {
        bent += shift.slopes[k * joints + j] * u[k];
        for (std::size_t l = 0; l < parameters; ++l) {
          bent += 0.5 * shift.curvatures[(k * parameters + l) * joints + j] * u[k] * u[l];
        }
      }
      q.push_back(from[j] + time * (double{to[j]} - from[j]) + share * bent);
    }
    return q;
  }
};

FamilyBox random_box(int parameters, double size, Rng& rng) {
  FamilyBox box;
  const auto half = [&] { return static_cast<float>(size * rng.uniform()); };
  box.half_time = half();
  box.time = static_cast<float>(rng.uniform(box.half_time, 1 - box.half_time));
  for (std::size_t k = 0; k < static_cast<std::size_t>(parameters); ++k) {
    box.half[k] = half();
    box.at[k] = static_cast<float>(rng.uniform(box.half[k] - 1, 1 - box.half[k]));
  }
  return box;
}

/// Least distance of a moving link from obstacles.
double clearance_from(const Scene& scene, const Robot& robot, const Configuration& q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_moving[i]) continue;
    const auto shapes = capsules_of(robot.links()[i], poses[i]);
    for (const Obstacle& obstacle : scene.obstacles) {
      least = std::min(least, gap_between(shapes, obstacle));
    }
  }
  return least;
}

/// Least distances over states of a box.
struct Clearances {
  double obstacles = std::numeric_limits<double>::infinity();
  double links = obstacles;  ///< within the limits only
};

/// Least clearances of `samples` states of a box, half of them at its corners.
Clearances least_clearances(const Robot& robot, const Scene& scene, const RandomFamily& family,
                            const FamilyBox& box, int samples, Rng& rng) {
  Clearances least;
  for (int i = 0; i < samples; ++i) {
    const auto share = [&] {
      const double value = rng.uniform(-1, 1);
      return i % 2 == 0 ? std::copysign(1.0, value) : value;
    };
    std::array<double, kMostParameters> u = {};
    for (std::size_t k = 0; k < u.size(); ++k) u[k] = box.at[k] + share() * box.half[k];
    std::vector<double> rest;
    for (std::size_t j = 0; j < family.from.size(); ++j) rest.push_back(share());
    const Configuration q = family.at(box.time + share() * box.half_time, u, rest);
    least.obstacles = std::min(least.obstacles, clearance_from(scene, robot, q));
    if (robot.describe_violation(q, "state")) continue;
    least.links = std::min(least.links, clearance(robot, Scene(), q));
  }
  return least;
}

bool is_free(const CollisionChecker& checker, const RandomFamily& family, const FamilyBox& box,
             float margin) {
  FamilyVerdict verdict;
  CheckCounters counters;
  checker.check_family(family.motion(), {&box, 1}, margin, {&verdict, 1}, counters);
  return verdict.is_free;
}

/// The largest margin with which the box is free, to within 1 %; 0 if there is none.
float widest_margin(const CollisionChecker& checker, const RandomFamily& family,
                    const FamilyBox& box) {
  float least = 1e-4f, most = 3.0f;
  if (!is_free(checker, family, box, least)) return 0;
  while (most > 1.01f * least) {
    const float middle = std::sqrt(least * most);
    (is_free(checker, family, box, middle) ? least : most) = middle;
  }
  return least;
}

constexpr double kRounding = 2e-5;

/// A ball of 0.1 m on a slide along x.
Robot sliding_ball() {
  return require_parsed(R"(<robot name="slide"><link name="base"/>
    <link name="ball"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="x" type="prismatic"><parent link="base"/><child link="ball"/>
      <axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>)");
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("no state of a box comes closer than the widest margin that proves it free") {
    // Tables leave out pairs of links that stay a millimetre apart within the limits.
    constexpr float kLeastApart = 1e-3f;
    constexpr int kStates = 40, kUsual = 30000;
    int proven = 0;
    std::uint64_t pairs = 0;
    const auto most = static_cast<std::uint64_t>(rounds(kUsual));
    for (std::uint64_t seed = 1; pairs < most; ++seed) {
      CAPTURE(seed);
      Rng rng(seed);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, static_cast<int>(rng.index(5)), rng, small_shape);
      const CollisionChecker checker = require_checker(robot, scene);
      for (int i = 0; i < 12; ++i) {
        const int parameters = static_cast<int>(rng.index(kMostParameters + 1));
        const RandomFamily family(robot, parameters, 0.5, rng);
        const FamilyBox box = random_box(parameters, std::pow(0.1, 1 + 2 * rng.uniform()), rng);
        const float margin = widest_margin(checker, family, box);
        if (margin == 0) continue;
        ++proven;
        pairs += kStates;
        const Clearances least = least_clearances(robot, scene, family, box, kStates, rng);
        CHECK(least.obstacles >= margin - kRounding);
        CHECK(least.links >= std::min(margin, kLeastApart) - kRounding);
      }
    }
    CHECK(proven >= static_cast<int>(most / kStates));
    if (most > kUsual) MESSAGE(pairs << " states of " << proven << " boxes");
  }

  TEST_CASE("small boxes lose little to the bounds") {
    double lost = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      Rng rng(seed);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 4, rng, small_shape);
      const CollisionChecker checker = require_checker(robot, scene);
      RandomFamily family(robot, 2, 0.5, rng);
      std::ranges::fill(family.shift.rest, 0.0f);
      const FamilyBox box = random_box(2, 1e-3, rng);
      const float margin = widest_margin(checker, family, box);
      if (margin < 0.01f) continue;
      const Clearances least = least_clearances(robot, scene, family, box, 40, rng);
      lost += std::min(least.obstacles, least.links) / margin - 1;
      ++count;
    }
    CHECK(count > 15);
    CHECK(lost / count < 0.15);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("instruction sets agree on boxes but those at the edge of proof") {
    int differing = 0, decided = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Rng rng(seed);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 4, rng, small_shape);
      const RandomFamily family(robot, 3, 0.5, rng);
      std::vector<FamilyBox> boxes;
      for (int i = 0; i < 37; ++i) boxes.push_back(random_box(3, 0.05, rng));
      std::vector<std::vector<FamilyVerdict>> verdicts;
      for (const Isa isa : available_isas()) {
        const auto checker = require_checker(robot, scene, {.isa = isa});
        CheckCounters counters;
        verdicts.emplace_back(boxes.size());
        checker.check_family(family.motion(), boxes, 1e-3f, verdicts.back(), counters);
        CHECK(counters.states == boxes.size());
      }
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (const auto& other : verdicts) {
          ++decided;
          differing += other[i].is_free != verdicts.front()[i].is_free ? 1 : 0;
        }
      }
    }
    CHECK(differing <= decided / 1000);
  }

  TEST_CASE("values that are not finite are never free") {
    Rng rng(3);
    const Robot robot = random_robot(rng);
    const CollisionChecker checker = require_checker(robot, Scene{});
    RandomFamily family(robot, 2, 0.1, rng);
    FamilyBox box;
    box.time = 0.5;
    const auto with_nothing_else = [&](float margin) {
      return is_free(checker, family, box, margin);
    };
    box.half[1] = std::numeric_limits<float>::quiet_NaN();
    CHECK_FALSE(with_nothing_else(1e-4f));
    box.half[1] = 0;
    CHECK_FALSE(with_nothing_else(0));
    family.shift.slopes[0] = std::numeric_limits<float>::infinity();
    CHECK_FALSE(with_nothing_else(1e-4f));
  }

  TEST_CASE("points count, as far as a body moves less than the tables reach") {
    const std::vector<CloudPoint> points = {{1, 0, 0}};
    const PointCloud cloud{{}, std::make_shared<const Parts<CloudPoint>>(points), 0.05};
    const CollisionChecker checker =
        require_checker(sliding_ball(), Scene{"", {{"cloud", {cloud}}}});
    const GoalShift shift{1, {0}, {0.5f}, {0}, {0}};
    const auto is_free_around = [&](float middle, float half) {
      const std::vector<float> at = {middle};
      const FamilyMotion motion{&shift, at, at, 1, 1};
      const FamilyBox box{0.5f, 0, {0}, {half}};
      FamilyVerdict verdict;
      CheckCounters counters;
      checker.check_family(motion, {&box, 1}, 1e-3f, {&verdict, 1}, counters);
      return verdict.is_free;
    };
    CHECK(is_free_around(0.6f, 0.4f));        // up to 0.8 + 0.1 of 0.95
    CHECK_FALSE(is_free_around(0.7f, 0.4f));  // up to 0.9 + 0.1
    CHECK_FALSE(is_free_around(0, 1));        // free, but too wide to tell
  }

  TEST_CASE("a blocked box says how far what blocks it moves along each direction") {
    const Robot robot = sliding_ball();
    const Scene scene{"", {{"pea", {Sphere{Vec3(1, 0, 0), 0.1}}}}};
    const CollisionChecker checker = require_checker(robot, scene);
    const GoalShift shift{1, {0}, {0.5f}, {0}, {0.01f}};
    const std::vector<float> from = {0}, to = {0.2f};
    const FamilyMotion motion{&shift, from, to, 1, 1};
    const FamilyBox box{0.5f, 0.5f, {0}, {1}};  // x: 0.1 +- 0.1 +- 0.5 +- 0.01
    FamilyVerdict verdict;
    CheckCounters counters;
    const auto check = [&](float margin) {
      checker.check_family(motion, {&box, 1}, margin, {&verdict, 1}, counters);
    };
    check(0.085f);  // 1 - 0.71 - 0.2 is 0.09
    CHECK(verdict.is_free);
    check(0.095f);
    CHECK_FALSE(verdict.is_free);
    CHECK(verdict.displacements[0] == doctest::Approx(0.1));
    CHECK(verdict.displacements[1] == doctest::Approx(0.5));
    CHECK(verdict.bent == doctest::Approx(0.01));
    CHECK(verdict.displacement() == doctest::Approx(0.61));
  }

  TEST_CASE("of motion past another link only the part towards it counts") {
    // The ball slides over another, 0.05 m above it, and by 0.61 m to either side.
    const auto check = [](double offset) {
      const Robot robot = require_parsed(
          R"(<robot name="pass"><link name="base">
        <collision><origin xyz="0 0 -0.25"/><geometry><sphere radius="0.1"/></geometry></collision>
        </link><link name="between"/>
        <link name="ball"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="z" type="prismatic"><parent link="base"/><child link="between"/>
          <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        <joint name="x" type="prismatic"><parent link="between"/><child link="ball"/>
          <axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
        </robot>)");
      const CollisionChecker checker = require_checker(robot, Scene{});
      const GoalShift shift{1, {0, static_cast<float>(offset)}, {0, 0.5f}, {0, 0}, {0, 0.01f}};
      const std::vector<float> from = {0, -0.1f}, to = {0, 0.1f};
      const FamilyBox box{0.5f, 0.5f, {0}, {1}};
      FamilyVerdict verdict;
      CheckCounters counters;
      checker.check_family({&shift, from, to, 1, 1}, {&box, 1}, 1e-3f, {&verdict, 1}, counters);
      return verdict;
    };
    CHECK(check(0).is_free);
    // Beside the middle the plane is tilted by atan(offset / 0.25).
    const FamilyVerdict steep = check(0.1);
    CHECK_FALSE(steep.is_free);
    CHECK_FALSE(steep.is_in_contact);
    CHECK(steep.displacements[1] == doctest::Approx(0.5));
    CHECK(steep.towards[1] == doctest::Approx(0.5 * std::sin(std::atan(0.4))).epsilon(1e-3));
  }

  TEST_CASE("of motion along a board only the part towards it counts") {
    // The ball is 0.05 m above the board; x moves by 0.6 m to either side, the tilt by little.
    const Robot robot = sliding_ball();
    const auto check = [&](double turn, double above) {
      const Eigen::Matrix3d tilted = Eigen::AngleAxisd(turn, Vec3::UnitY()).toRotationMatrix();
      const Box board{{tilted, tilted * Vec3(0, 0, -0.1 - above - 0.02)}, {3, 3, 0.02}};
      const CollisionChecker checker = require_checker(robot, Scene{"", {{"board", {board}}}});
      const GoalShift shift{1, {0}, {0.5f}, {0}, {0.01f}};
      const std::vector<float> from = {-0.1f}, to = {0.1f};
      const FamilyBox box{0.5f, 0.5f, {0}, {1}};
      FamilyVerdict verdict;
      CheckCounters counters;
      checker.check_family({&shift, from, to, 1, 1}, {&box, 1}, 1e-3f, {&verdict, 1}, counters);
      return verdict;
    };
    CHECK(check(0, 0.05).is_free);
    CHECK(check(0.05, 0.05).is_free);  // 0.61 sin 0.05 is 0.0305
    const FamilyVerdict steep = check(0.1, 0.05);
    CHECK_FALSE(steep.is_free);
    CHECK_FALSE(steep.is_in_contact);
    CHECK(steep.displacements[1] == doctest::Approx(0.5));
    CHECK(steep.towards[0] == doctest::Approx(0.1 * std::sin(0.1)).epsilon(1e-3));
    CHECK(steep.towards[1] == doctest::Approx(0.5 * std::sin(0.1)).epsilon(1e-3));
    CHECK(check(0, -0.01).is_in_contact);
  }
}

}  // namespace mneme::test
