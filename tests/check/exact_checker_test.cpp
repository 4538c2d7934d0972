// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "check/exact_checker.h"
#include "support/support.h"

namespace mneme {
namespace {

const std::string kArm = R"(<robot name="arm">
  <link name="base"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.3"/><geometry><capsule radius="0.05" length="0.4"/>
    </geometry></collision></link>
  <link name="lower"><collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.1"/></geometry>
    </collision><collision><origin xyz="0 0 0.4"/><geometry><sphere radius="0.08"/></geometry>
    </collision></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.6"/>
    <axis xyz="1 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>)";

Scene random_scene(Rng& rng) {
  const auto point = [&] {
    return Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  };
  const auto size = [&] { return rng.uniform(0.02, 0.3); };
  const Transform pose{rotation_from_rpy(3 * point()), point()};
  return {"s",
          {{"ball", {Sphere{point(), size()}}},
           {"box", {Box{pose, Vec3(size(), size(), size())}, Capsule{point(), point(), 0.03}}},
           {"can", {Cylinder{{rotation_from_rpy(3 * point()), point()}, size(), size()}}}}};
}

TEST_SUITE("law") {
  TEST_CASE("States are free exactly where the checker finds no contacts") {
    constexpr std::uint64_t kSeed = 5;
    const Robot robot = parse_robot(kArm, "arm.urdf").value();
    Rng rng(kSeed);
    int free_count = 0;
    constexpr int kScenes = 60;
    constexpr int kStates = 20;
    for (int i = 0; i < kScenes; ++i) {
      const Scene scene = random_scene(rng);
      const auto checker = CollisionChecker::make(robot, scene);
      REQUIRE(checker.has_value());
      const internal::ExactChecker exact(robot, scene);
      for (int j = 0; j < kStates; ++j) {
        const Configuration q = test::random_configuration(robot, rng);
        INFO("seed " << kSeed << ", scene " << i << ", state " << j);
        REQUIRE(exact.is_free(q) == checker->contacts(q).empty());
        free_count += exact.is_free(q) ? 1 : 0;
      }
    }
    CHECK(free_count > kScenes * kStates / 10);
    CHECK(free_count < kScenes * kStates * 9 / 10);
  }
}

}  // namespace
}  // namespace mneme
