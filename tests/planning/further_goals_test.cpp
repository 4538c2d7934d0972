// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Goals that come while a planner searches.
#include "planning/planner_flow.h"
#include "planning/planner_run.h"

#include <utility>
#include <vector>

namespace mneme::test {
namespace {

/// Nothing at first, then all it has.
class LateGoals final : public GoalSource {
 public:
  explicit LateGoals(std::vector<Configuration> goals) : goals_(std::move(goals)) {}
  std::vector<Configuration> more() override {
    return ++calls_ == 2 ? std::exchange(goals_, {}) : std::vector<Configuration>();
  }
  [[nodiscard]] int calls() const { return calls_; }

 private:
  std::vector<Configuration> goals_;
  int calls_ = 0;
};

/// A ball that slides along x and y, a wall across x = 0, the start on one side of it and the goal
/// on the other.
World walled_slider() {
  Robot::Parts parts;
  parts.name = "slider";
  parts.allowed_pairs.emplace();
  parts.links.push_back({.name = "base"});
  add_link(parts, JointType::prismatic, Vec3::Zero(), Vec3::UnitX(), 1, {});
  add_link(parts, JointType::prismatic, Vec3::Zero(), Vec3::UnitY(), 1, {{Vec3::Zero(), 0.05}});
  Scene scene;
  scene.obstacles.push_back({"wall", {Box{{}, Vec3(0.1, 3, 1)}}});
  return {"wall", make_small_robot(std::move(parts)), scene, {{-0.5, 0}, {{0.5, 0}}}};
}

PlanResult run_with(OwnPlanner plan, const World& world, GoalSource* source) {
  PlanSettings settings = patient_settings();
  settings.max_iterations = 20000;
  const CollisionChecker checker = make_checker(world);
  const auto sampler = make_uniform_sampler(world.robot);
  PathFinisher finisher(checker, settings.finish());
  return plan({checker, world.query, *sampler, settings, finisher, {}, source});
}

TEST_SUITE("unit") {
  TEST_CASE("a planner goes to goals that come while it searches") {
    const World world = walled_slider();
    const Configuration late = {-0.7, 0.9};
    for (const auto& [planner, plan] :
         {std::pair<const char*, OwnPlanner>("rrt_connect", rrt_connect),
          std::pair<const char*, OwnPlanner>("rrt", rrt),
          std::pair<const char*, OwnPlanner>("prm", prm)}) {
      const std::string name = planner;
      CAPTURE(name);
      LateGoals goals({late});
      const PlanResult result = run_with(plan, world, &goals);
      REQUIRE_MESSAGE(result.is_solved(), result.message);
      CHECK(result.path.front() == world.query.start);
      CHECK(result.path.back() == late);
      CHECK(goals.calls() == 2);
    }
  }

  TEST_CASE("a search takes up to 64 goals, however many come at once") {
    const World world = walled_slider();
    const CollisionChecker checker = make_checker(world);
    const auto sampler = make_uniform_sampler(world.robot);
    const PlanSettings settings = patient_settings();
    PathFinisher finisher(checker, settings.finish());
    LateGoals goals(std::vector<Configuration>(200, {-0.7, 0.9}));
    internal::PlannerRun run({checker, world.query, *sampler, settings, finisher, {}, &goals});
    for (int i = 0; i < 3; ++i) {
      REQUIRE(run.begin_iterations(1000) == 1000);
      static_cast<void>(run.take_further_goals());
    }
    CHECK(run.goals().size() == 64);
  }

  TEST_CASE("without further goals, or when none comes, the goal stays out of reach") {
    const World world = walled_slider();
    LateGoals none({});
    CHECK(run_with(rrt_connect, world, &none).status == PlanStatus::iteration_limit);
    CHECK(none.calls() > 2);
    CHECK(run_with(rrt_connect, world, nullptr).status == PlanStatus::iteration_limit);
  }
}

}  // namespace
}  // namespace mneme::test
