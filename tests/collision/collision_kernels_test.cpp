// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/collision_kernels.h"
#include "collision/random_worlds.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

constexpr double kKernelTolerance = 1e-5;

int lane_count_of(Isa isa) { return internal::collision_kernels(isa).lanes; }

/// An arm of `links` capsules 1 m long and 2 cm in radius that bends about z, y, z, ...
Robot folding_arm(int links) {
  Robot::Parts parts;
  parts.name = "folding";
  parts.links.push_back({.name = "base"});
  for (int i = 1; i <= links; ++i) {
    parts.links.push_back(
        {.name = "link" + std::to_string(i), .capsules = {{{0, 0, 0}, {1, 0, 0}, 0.02}}});
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.type = JointType::revolute;
    joint.parent_link = i - 1;
    joint.child_link = i;
    joint.origin.translation = Vec3(i == 1 ? 0 : 1, 0, 0);
    joint.axis = i % 2 == 1 ? Vec3::UnitZ() : Vec3::UnitY();
    joint.lower = -4;
    joint.upper = 4;
    parts.joints.push_back(joint);
  }
  return require(make_robot(parts));
}

/// Joints that are straight or folded back, up to a bend of 1e-6 to `largest` radians.
std::vector<float> folded_states(const Robot& robot, int count, double largest, Rng& rng) {
  std::vector<float> rows;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < robot.joint_count(); ++j) {
      const double bend = std::pow(10.0, rng.uniform(-6.0, std::log10(largest)));
      const double sign = rng.index(2) == 0 ? 1 : -1;
      const bool is_folded = j > 0 && rng.index(5) == 0;
      rows.push_back(static_cast<float>(sign * (is_folded ? kPi - bend : bend)));
    }
  }
  return rows;
}

/// Every instruction set judges every row as the exact distances do, except within `tolerance` of
/// contact. Returns the number of free rows.
int check_against_exact(const Robot& robot, const Scene& scene, const std::vector<float>& rows,
                        double tolerance) {
  std::vector<double> exact;
  int free_count = 0;
  for (std::size_t i = 0; i < rows.size() / static_cast<std::size_t>(robot.joint_count()); ++i) {
    exact.push_back(clearance(robot, scene, row(rows, i, robot)));
    free_count += exact.back() >= 0 ? 1 : 0;
  }
  for (const Isa isa : available_isas()) {
    const auto is_valid = check_all(require_checker(robot, scene, {.isa = isa}), rows);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      if ((is_valid[i] != 0) == (exact[i] >= 0)) continue;
      INFO(to_string(isa) << ", state " << i << ": clearance " << exact[i]);
      REQUIRE(std::abs(exact[i]) < tolerance);
    }
  }
  return free_count;
}

/// A state of `checker`'s robot that is within `nearness` metres of contact, between a free state
/// and one that is not.
Configuration near_contact(const Robot& robot, const Scene& scene, Configuration free,
                           Configuration hit, double nearness) {
  while (true) {
    Configuration middle(free.size());
    for (std::size_t j = 0; j < free.size(); ++j) middle[j] = (free[j] + hit[j]) / 2;
    const double gap = clearance(robot, scene, middle);
    if (std::abs(gap) < nearness || middle == free || middle == hit) return middle;
    (gap >= 0 ? free : hit) = middle;
  }
}

TEST_SUITE("unit") {
  TEST_CASE("each instruction set has its own number of lanes") {
    const std::map<Isa, int> lanes = {{Isa::scalar, 1},  {Isa::sse, 4},  {Isa::avx2, 8},
                                      {Isa::avx512, 16}, {Isa::neon, 4}, {Isa::wasm, 4}};
    for (const Isa isa : available_isas()) CHECK(lane_count_of(isa) == lanes.at(isa));
  }

  TEST_CASE("links that cross in a plane touch, however thin they are") {
    const Robot robot = planar8();
    // A square with sides 1.6, 1.4, 1.8, 1.2 whose fifth link crosses the first.
    const std::vector<float> crossing = {0, kPi / 2, kPi / 2, kPi / 2, 1.0f, 0, 0, 0};
    REQUIRE(clearance(robot, {}, row(crossing, 0, robot)) == doctest::Approx(-0.001));
    for (const Isa isa : available_isas()) {
      CHECK(!require_checker(robot, {}, {.isa = isa}).is_valid(row(crossing, 0, robot)));
    }
  }
}

/// Compares all instruction sets with the scalar one, and counts.
struct Agreement {
  int states = 0, free = 0, differences = 0;

  void compare(const Robot& robot, const Scene& scene, const std::vector<float>& rows) {
    const auto expected = check_all(require_checker(robot, scene, {.isa = Isa::scalar}), rows);
    states += static_cast<int>(expected.size());
    for (const std::uint8_t is_valid : expected) free += is_valid;
    for (const Isa isa : available_isas()) {
      const auto is_valid = check_all(require_checker(robot, scene, {.isa = isa}), rows);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        if (is_valid[k] == expected[k]) continue;
        ++differences;
        INFO("state " << k << ", " << to_string(isa));
        REQUIRE(std::abs(clearance(robot, scene, row(rows, k, robot))) < kKernelTolerance);
      }
    }
  }
  void check(int most_differences) const {
    CHECK(free > states / 20);
    CHECK(free < states / 20 * 19);
    CHECK(differences < most_differences);
  }
};

TEST_SUITE("law") {
  TEST_CASE("wide and scalar kernels agree on a million planar states") {
    const Robot robot = planar8();
    Rng rng(101);
    Agreement agreement;
    for (int i = 0; i < 50; ++i) {
      INFO("seed 101, scene " << i);
      const Scene scene = random_circles(1 + i % 8, rng);
      agreement.compare(robot, scene, random_states(robot, 20000, rng, i % 2 == 0 ? 1.0 : 0.3));
    }
    agreement.check(100);
  }

  TEST_CASE("wide and scalar kernels agree on a million states in space") {
    Rng rng(110);
    Agreement agreement;
    for (int i = 0; i < 100; ++i) {
      INFO("seed 110, world " << i);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 1 + i % 40, rng, small_shape);
      agreement.compare(robot, scene, random_states(robot, 10000, rng));
    }
    agreement.check(500);
  }

  TEST_CASE("the batch of any size gives the answers of single states, and no more of them") {
    const Robot robot = planar8();
    Rng rng(102);
    const Scene scene = random_circles(4, rng);
    const auto rows = random_states(robot, 100, rng, 0.4);
    for (const Isa isa : available_isas()) {
      const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
      const int lanes = lane_count_of(isa);
      for (const int count : {0, 1, lanes - 1, lanes, lanes + 1, 2 * lanes + 1, 100}) {
        std::vector<std::uint8_t> is_valid(static_cast<std::size_t>(count) + 1, 7);
        checker.check_states(rows, {is_valid.data(), static_cast<std::size_t>(count)});
        INFO(to_string(isa) << ", count " << count);
        CHECK(is_valid.back() == 7);
        is_valid.pop_back();
        for (std::size_t i = 0; i < is_valid.size(); ++i) {
          REQUIRE(is_valid[i] == (checker.is_valid(row(rows, i, robot)) ? 1 : 0));
        }
      }
    }
  }

  TEST_CASE("a state's answer does not depend on its neighbours in the batch") {
    Rng rng(103);
    const Robot robot = random_robot(rng);
    const Scene scene = random_scene(robot, 6, rng, small_shape);
    const auto rows = random_states(robot, 400, rng);
    const auto joints = static_cast<std::ptrdiff_t>(robot.joint_count());
    for (const Isa isa : available_isas()) {
      const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
      const auto all = check_all(checker, rows);
      for (std::ptrdiff_t shift = 1; shift < 20; shift += 3) {
        const auto tail = check_all(checker, {rows.begin() + shift * joints, rows.end()});
        REQUIRE(std::equal(tail.begin(), tail.end(), all.begin() + shift));
      }
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("a cylinder is exact: neither its rim nor its flat end is rounded") {
    Rng rng(109);
    for (int i = 0; i < 40; ++i) {
      const bool has_capsules = i % 2 == 0;
      Robot::Parts parts;
      parts.name = "probe";
      Link tip;
      tip.name = "tip";
      if (has_capsules) {
        tip.capsules.push_back({{0, 0, 0}, random_vector(rng, 1.0), 0.05});
      } else {
        tip.spheres.push_back({{0, 0, 0}, 0.05});
      }
      parts.links = {{.name = "base"}, {.name = "x"}, tip};
      for (int k = 0; k < 2; ++k) {
        Joint joint;
        joint.name = "slide" + std::to_string(k);
        joint.type = JointType::prismatic;
        joint.parent_link = k;
        joint.child_link = k + 1;
        joint.axis = k == 0 ? Vec3::UnitX() : Vec3::UnitZ();
        joint.lower = -2;
        joint.upper = 2;
        parts.joints.push_back(joint);
      }
      const auto robot = require(make_robot(parts));
      const bool is_upright = i % 4 < 2;
      const Cylinder can{is_upright ? Transform{} : random_pose(rng, 0.2), rng.uniform(0.002, 0.8),
                         rng.uniform(0.002, 2.0)};
      INFO("seed 109, cylinder " << i);
      check_against_exact(robot, {"s", {{"can", {can}}}}, random_states(robot, 3000, rng),
                          kKernelTolerance);
    }
  }

  TEST_CASE("a folded planar arm is judged right by all instruction sets") {
    const Robot robot = planar8();
    Rng rng(104);
    const auto rows = folded_states(robot, 20000, 1e-2, rng);
    const int free_count = check_against_exact(robot, {}, rows, kKernelTolerance);
    CHECK(free_count > 1000);
    CHECK(free_count < 19000);
  }

  TEST_CASE("a folded arm in space is judged right by all instruction sets") {
    const Robot robot = folding_arm(6);
    Rng rng(105);
    const auto rows = folded_states(robot, 20000, 0.1, rng);
    const int free_count = check_against_exact(robot, {}, rows, kKernelTolerance);
    CHECK(free_count > 1000);
    CHECK(free_count < 19000);
  }

  TEST_CASE("obstacles that are nearly parallel to the links are judged right") {
    const Robot robot = folding_arm(4);
    Rng rng(106);
    int free_count = 0;
    for (int i = 0; i < 100; ++i) {
      const double tilt = std::pow(10.0, rng.uniform(-7.0, -2.0));
      const double gap = rng.uniform(-1e-3, 1e-3) + 0.03;
      const double a = rng.uniform(0.5, 3.0);
      const Scene scene{
          "rods",
          {{"rod", {Capsule{{a, gap, 0}, {a + 2, gap + tilt, tilt}, 0.01}}},
           {"slab",
            {Box{{rotation_about(Vec3::UnitX(), tilt), {2, 0, 0.07 + gap}}, {3, 0.5, 0.05}}}},
           {"pipe",
            {Cylinder{{rotation_about(Vec3::UnitY(), kPi / 2 + tilt), {a, -gap, 0}}, 0.01, 2}}}}};
      const auto rows = folded_states(robot, 100, 1e-2, rng);
      free_count += check_against_exact(robot, scene, rows, kKernelTolerance);
    }
    CHECK(free_count > 500);
    CHECK(free_count < 9500);
  }

  TEST_CASE("kernels are right two hundredths of a millimetre on either side of contact") {
    Rng rng(107);
    int near_count = 0;
    for (int i = 0; i < 60; ++i) {
      const bool is_planar = i % 2 == 0;
      const Robot robot = is_planar ? planar8() : random_robot(rng);
      const Scene scene =
          is_planar ? random_circles(4, rng) : random_scene(robot, 5, rng, small_shape);
      std::vector<Configuration> free, hit;
      std::vector<float> rows;
      for (int k = 0; k < 300; ++k) {
        const auto state = random_states(robot, 1, rng, is_planar ? 0.4 : 1.0);
        const bool is_free = clearance(robot, scene, row(state, 0, robot)) >= 0;
        (is_free ? free : hit).emplace_back(state.begin(), state.end());
      }
      for (std::size_t k = 0; k < std::min({free.size(), hit.size(), std::size_t{60}}); ++k) {
        const Configuration q = near_contact(robot, scene, free[k], hit[k], 1e-4);
        rows.insert(rows.end(), q.begin(), q.end());
        ++near_count;
      }
      INFO("seed 107, world " << i);
      if (!rows.empty()) check_against_exact(robot, scene, rows, 2e-5);
    }
    CHECK(near_count > 1000);
  }

  TEST_CASE("joint values of many turns are judged like any other") {
    Rng rng(108);
    const Robot robot = folding_arm(3);
    const Scene scene = random_scene(robot, 6, rng, small_shape);
    std::vector<float> rows;
    for (int i = 0; i < 6000; ++i) rows.push_back(static_cast<float>(rng.uniform(-1e4, 1e4)));
    const int free_count = check_against_exact(robot, scene, rows, kKernelTolerance);
    CHECK(free_count > 100);
    CHECK(free_count < 1900);
  }
}

}  // namespace
}  // namespace mneme::test
