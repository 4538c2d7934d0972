// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/collision_kernels.h"
#include "collision/random_worlds.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

internal::RobotTables separation_tables_of(const Robot& robot) {
  return require(internal::make_robot_tables(robot));
}

internal::RobotTables without_separation_tables(internal::RobotTables tables) {
  for (internal::BodyPairRow& pair : tables.body_pairs) pair.separation_table = -1;
  return tables;
}

/// Answers of kernels with and without separation tables on the same robot, without obstacles.
class Comparison {
 public:
  explicit Comparison(const Robot& robot)
      : with_(separation_tables_of(robot)),
        without_(without_separation_tables(with_)),
        joints_(static_cast<std::size_t>(robot.joint_count())) {}

  [[nodiscard]] bool has_separation_tables() const { return with_.separation_tables != nullptr; }

  void compare_states(const std::vector<float>& rows) {
    const auto count = rows.size() / joints_;
    for (const Isa isa : available_isas()) {
      const auto& kernels = internal::collision_kernels(isa);
      std::vector<std::uint8_t> one(count), other(count);
      CheckCounters counters;
      kernels.check_states(with_, scene_, rows.data(), static_cast<int>(count), 0, one.data(),
                           counters);
      kernels.check_states(without_, scene_, rows.data(), static_cast<int>(count), 0, other.data(),
                           counters);
      CHECK(one == other);
      free += std::ranges::count(one, 1);
      hit += std::ranges::count(one, 0);
    }
  }

  void compare_motion(const float* from, const std::vector<float>& delta, float margin) {
    const std::vector<float> bodies(static_cast<std::size_t>(with_.moving_count), 2);
    const std::vector<float> pairs(with_.body_pairs.size(), 2);
    const internal::SweptChain sweep{
        from, delta.data(), 1, bodies.data(), pairs.data(), 0, margin, false, false, 16, 1e-4f};
    for (const Isa isa : available_isas()) {
      const auto& kernels = internal::collision_kernels(isa);
      CheckCounters one, other;
      CHECK(kernels.is_motion_free(with_, scene_, from, delta.data(), 20, 0, one) ==
            kernels.is_motion_free(without_, scene_, from, delta.data(), 20, 0, other));
      CHECK(one.states == other.states);
      const bool is_free = kernels.is_sweep_free(with_, scene_, sweep, one);
      CHECK(is_free == kernels.is_sweep_free(without_, scene_, sweep, other));
      CHECK(one.states <= other.states);
      ++(is_free ? free_sweeps : blocked_sweeps);
    }
  }

  std::ptrdiff_t free = 0, hit = 0;
  int free_sweeps = 0, blocked_sweeps = 0;

 private:
  internal::RobotTables with_, without_;
  internal::SceneTables scene_ = internal::make_scene_tables(Scene()).value();
  std::size_t joints_;
};

TEST_SUITE("law") {
  TEST_CASE("separation tables change no answer of states, motions and sweeps") {
    Rng rng(611);
    for (const char* name : {"panda", "ur5"}) {
      const Robot robot = load_robot(source_file(std::string("robots/") + name + ".urdf")).value();
      Comparison comparison(robot);
      REQUIRE(comparison.has_separation_tables());
      // Also beyond the limits.
      const std::vector<float> rows = random_states(robot, 4000, rng, 1.1);
      comparison.compare_states(rows);
      const auto joints = static_cast<std::size_t>(robot.joint_count());
      for (std::size_t i = 0; i < 150; ++i) {
        std::vector<float> delta;
        for (std::size_t j = 0; j < joints; ++j) {
          delta.push_back(static_cast<float>(rng.uniform(-0.5, 0.5)));
        }
        const float margin = i % 3 == 0 ? 5e-3f : 1e-4f;
        comparison.compare_motion(rows.data() + i * joints, delta, margin);
      }
      CHECK(comparison.free > 1000);
      CHECK(comparison.hit > 100);
      CHECK(comparison.free_sweeps > 20);
      CHECK(comparison.blocked_sweeps > 20);
    }
  }

  TEST_CASE("separation tables of random robots change no answer") {
    Rng rng(612);
    std::ptrdiff_t free = 0, hit = 0;
    for (int i = 0; i < rounds(60); ++i) {
      const Robot robot = random_robot(rng);
      Comparison comparison(robot);
      comparison.compare_states(random_states(robot, 200, rng, 1.2));
      free += comparison.free;
      hit += comparison.hit;
    }
    CHECK(free > 1000);
    CHECK(hit > 100);
  }

  TEST_CASE("joint values that no cell holds are safe to look up") {
    const Robot robot = load_robot(source_file("robots/ur5.urdf")).value();
    Comparison comparison(robot);
    std::vector<float> rows;
    for (const float value : {1e30f, -1e30f, std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity(), std::nanf("")}) {
      rows.insert(rows.end(), static_cast<std::size_t>(robot.joint_count()), value);
    }
    comparison.compare_states(rows);
  }
}

}  // namespace
}  // namespace mneme::test
