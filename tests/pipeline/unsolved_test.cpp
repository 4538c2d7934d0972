// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/unsolved.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

/// An arm that a post keeps from turning to its goal, whatever its second joint does.
struct Hopeless {
  Robot robot = require_arm(R"(<robot name="bender">
  <link name="base"/>
  <link name="upper"><collision><origin xyz="0.25 0 0" rpy="0 1.5708 0"/>
    <geometry><capsule radius="0.03" length="0.4"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0.2 0 0" rpy="0 1.5708 0"/>
    <geometry><capsule radius="0.03" length="0.3"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/>
    <origin xyz="0.5 0 0"/><limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>
</robot>)");
  Problem problem{.name = "hopeless",
                  .robot = robot,
                  .scene = {"", {post(0.8)}},
                  .start = {0, 0},
                  .goals = {{1.6, 0.1}}};
  TemporaryDirectory directory;
  Database database =
      Database::open(directory / "m.db", make_signature(robot), OpenMode::create).value();
  SolveSettings settings;

  Hopeless() {
    settings.remember_after = 1'000'000'000;
    settings.plan.timeout_s = 600;
    settings.plan.max_iterations = 12'000;
  }
  static Obstacle post(double angle) {
    const Vec3 at(0.3 * std::cos(angle), 0.3 * std::sin(angle), 0);
    return {"post", {Box{{Eigen::Matrix3d::Identity(), at}, {0.02, 0.02, 0.2}}}};
  }
  /// Iterations of a search in vain; 0 if memory answers after the first few.
  std::uint64_t iterations(const Problem& asked) {
    const auto result = require(solve(asked, &database, settings));
    CHECK(result.plan.status == PlanStatus::iteration_limit);
    const bool is_known = contains(result.plan.message, "remembers");
    CHECK(is_known == (result.plan.iterations <= 64));
    REQUIRE(database.flush());
    return is_known ? 0 : result.plan.iterations;
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a search in vain answers with the limit of the query that it has reached") {
    Hopeless hopeless;
    hopeless.settings.plan.max_iterations.reset();
    const auto query = [&] {
      return require(internal::make_query(hopeless.problem, &hopeless.database, hopeless.settings));
    };
    {
      const internal::Query searched = query();
      PlanResult in_vain;
      in_vain.status = PlanStatus::timeout;
      in_vain.iterations = 20'000;
      internal::remember_unsolved(require(internal::resolve_goals(searched)), in_vain);
      REQUIRE(hopeless.database.flush());
    }
    hopeless.settings.plan.timeout_s = 500;
    const PlanResult in_time = require(internal::find_unsolved(query()));
    CHECK(in_time.status == PlanStatus::timeout);
    CHECK(contains(in_time.message, "a search of 600 s for"));
    hopeless.settings.plan.timeout_s = 1000;
    CHECK_FALSE(internal::find_unsolved(query()).has_value());
    hopeless.settings.plan.max_iterations = 10'000;
    const PlanResult in_number = require(internal::find_unsolved(query()));
    CHECK(in_number.status == PlanStatus::iteration_limit);
    CHECK(contains(in_number.message, "a search of 20000 iterations for"));
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a search in vain is remembered for exactly its problem") {
    Hopeless hopeless;
    CHECK(hopeless.iterations(hopeless.problem) == 12'000);
    CHECK(hopeless.iterations(hopeless.problem) == 0);
    Problem renamed = hopeless.problem;
    renamed.name = "other";
    renamed.scene.name = "other";
    CHECK(hopeless.iterations(renamed) == 0);
    Problem moved = hopeless.problem;
    moved.start[1] += 1e-12;
    CHECK(hopeless.iterations(moved) == 12'000);
    moved = hopeless.problem;
    moved.scene.obstacles.front() = Hopeless::post(0.8 + 1e-12);
    CHECK(hopeless.iterations(moved) == 12'000);
    CHECK(hopeless.iterations(moved) == 0);
    hopeless.settings.margin = 1e-6;
    CHECK(hopeless.iterations(moved) == 12'000);
  }

  TEST_CASE("a longer search, and one without memory, tries again") {
    Hopeless hopeless;
    CHECK(hopeless.iterations(hopeless.problem) == 12'000);
    hopeless.settings.plan.max_iterations = 12'001;
    CHECK(hopeless.iterations(hopeless.problem) == 12'001);
    hopeless.settings.plan.max_iterations = 11'000;
    CHECK(hopeless.iterations(hopeless.problem) == 0);
    hopeless.settings.replay = 0;
    CHECK(hopeless.iterations(hopeless.problem) == 11'000);
    hopeless.settings.replay.reset();
    hopeless.settings.memory_mode = MemoryMode::off;
    CHECK(hopeless.iterations(hopeless.problem) == 11'000);
  }

  TEST_CASE("a short search in vain proves nothing, and one that may not remember keeps none") {
    Hopeless hopeless;
    hopeless.settings.plan.max_iterations = 4'000;
    CHECK(hopeless.iterations(hopeless.problem) == 4'000);
    CHECK(hopeless.iterations(hopeless.problem) == 4'000);
    hopeless.settings.plan.max_iterations = 12'000;
    hopeless.settings.remember_after.reset();
    CHECK(hopeless.iterations(hopeless.problem) == 12'000);
    hopeless.settings.remember_after = 0;
    hopeless.settings.replay = 0;  // as in study(), whose problems may be solved already
    CHECK(hopeless.iterations(hopeless.problem) == 12'000);
    CHECK(hopeless.database.size() == 0);
  }

  TEST_CASE("kinds of memory do not see what was searched in vain") {
    Hopeless hopeless;
    hopeless.iterations(hopeless.problem);
    REQUIRE(hopeless.database.size() == 1);
    Problem open = hopeless.problem;
    open.scene.obstacles.clear();
    require_solved(open, &hopeless.database, hopeless.settings);
  }
}

}  // namespace mneme::test
