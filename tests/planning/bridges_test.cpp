// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Remembered motions in a search.
#include "planning/planner_flow.h"

#include <utility>
#include <vector>

namespace mneme::test {
namespace {

/// Gives one list of motions per call.
class ScriptedMotions final : public MotionSource {
 public:
  using Rows = std::vector<PlacedMotion>;
  explicit ScriptedMotions(std::vector<Rows> lists, std::uint64_t work_per_call = 0)
      : lists_(std::move(lists)), work_per_call_(work_per_call) {}
  bool find_more(Rows& placed, CheckCounters& counters) override {
    REQUIRE(calls_ < lists_.size());
    counters.work += work_per_call_;
    placed = lists_[calls_++];
    return calls_ < lists_.size();
  }
  [[nodiscard]] double trust() const override { return trusted_; }
  void report(std::uint64_t, std::span<const int> followed) override {
    followed_.assign(followed.begin(), followed.end());
  }
  void trust_only(double share) { trusted_ = share; }
  [[nodiscard]] std::size_t calls() const { return calls_; }
  [[nodiscard]] const std::vector<int>& followed() const { return followed_; }

 private:
  std::vector<Rows> lists_;
  std::uint64_t work_per_call_;
  std::size_t calls_ = 0;
  double trusted_ = 1;
  std::vector<int> followed_;
};

/// A ball before a hole that leaves it 2 mm.
World narrow_hole() {
  return {"hole", gantry(), wall_with_hole(0.204), {{-1.5, 1, 0.5}, {{1.5, -1, -0.5}}}};
}

/// Straight through the hole and on to `last`, at `height`.
std::vector<float> through_the_hole(float last, float height = 0) {
  std::vector<float> rows;
  for (float x = -0.3f; x <= last + 1e-3f; x += 0.1f) rows.insert(rows.end(), {x, 0, height});
  return rows;
}

PlanResult plan_with_motions(const World& world, MotionSource* motions) {
  PlanSettings settings = patient_settings();
  settings.max_iterations = 60000;
  const CollisionChecker checker = make_checker(world);
  const auto sampler = make_uniform_sampler(world.robot);
  PathFinisher finisher(checker, settings.finish());
  PlanTask task{checker, world.query, *sampler, settings, finisher};
  task.motions = motions;
  PlanResult result = rrt_connect(task);
  if (result.is_solved()) check_solution(world, checker, result);
  return result;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a motion through a hole saves the search for it") {
    const World world = narrow_hole();
    const PlanResult without = plan_with_motions(world, nullptr);
    ScriptedMotions motions({{{through_the_hole(0.3f), 7}}});
    const PlanResult with = plan_with_motions(world, &motions);
    REQUIRE(with.is_solved());
    CHECK(with.iterations < 2000);
    CHECK(with.iterations * 5 < without.iterations);
    CHECK(motions.followed() == std::vector<int>{7});
    ScriptedMotions again({{{through_the_hole(0.3f), 7}}});
    CHECK(plan_with_motions(world, &again).path == with.path);
  }

  TEST_CASE("of a motion in contact the free stretches are used") {
    const World world = narrow_hole();
    std::vector<float> rows = through_the_hole(0.3f);
    const std::vector<float> blocked = through_the_hole(0.3f, 0.5f);
    rows.insert(rows.end(), blocked.begin(), blocked.end());
    ScriptedMotions motions({{{blocked, 1}, {rows, 2}}});
    const PlanResult result = plan_with_motions(world, &motions);
    REQUIRE(result.is_solved());
    CHECK(result.iterations < 4000);
    CHECK(motions.followed() == std::vector<int>{2});
  }

  TEST_CASE("motions are looked for late, and for a share of the work") {
    const World open{"open", gantry(), {}, {{-1.5, 1, 0}, {{1.5, -1, 1}}}};
    ScriptedMotions unused(std::vector<ScriptedMotions::Rows>(1));
    CHECK(plan_with_motions(open, &unused).is_solved());
    CHECK(unused.calls() == 0);
    const auto calls_of_work = [](std::uint64_t work) {
      ScriptedMotions useless(std::vector<ScriptedMotions::Rows>(10000), work);
      (void)plan_with_motions(narrow_hole(), &useless);
      return static_cast<double>(useless.calls());
    };
    const double many = calls_of_work(100'000), few = calls_of_work(10'000'000);
    CHECK(many < 10000);
    CHECK(few > 1);
    CHECK(5 * few <= many);
  }

  TEST_CASE("motions that have hardly paid are looked for later, and less") {
    const auto calls = [](double trust) {
      ScriptedMotions useless(std::vector<ScriptedMotions::Rows>(10000), 10'000'000);
      useless.trust_only(trust);
      (void)plan_with_motions(narrow_hole(), &useless);
      CHECK(useless.followed().empty());
      return useless.calls();
    };
    const std::size_t trusted = calls(1), mistrusted = calls(0.1);
    CHECK(mistrusted >= 1);
    CHECK(5 * mistrusted < trusted);
  }
}

}  // namespace mneme::test
