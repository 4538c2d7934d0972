// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planning_fixture.h"
#include "planning/scripted_sampler.h"
#include "planning/growth.h"

#include <algorithm>

namespace mneme::test {
namespace {

/// The gantry at the origin, before a wall at x = 0.9 that reaches across its room; range 0.5.
struct BatchFixture {
  explicit BatchFixture(std::vector<Configuration> script) : sampler(std::move(script)) {
    REQUIRE(!refuse_query(checker, world.query));
    tree.add(run.start(), -1);
  }
  static PlanSettings make_settings() {
    PlanSettings settings;
    settings.range = 0.5;
    settings.max_iterations = 10000;
    return settings;
  }
  /// Samples until a batch of `count` steps has been rejected as a whole.
  void reject_until(int count) {
    do {
      REQUIRE(batch.sample_steps(tree));
      for (int i = 0; i < batch.size(); ++i) batch.settle(i, SampleOutcome::rejected);
    } while (batch.size() < count);
  }

  World world{"",
              gantry(),
              {"", {make_box("wall", {0.9, -3, -3}, {1.1, 3, 3})}},
              {{0, 0, 0}, {{0.5, 0, 0}}}};
  CollisionChecker checker = make_checker(world);
  ScriptedSampler sampler;
  PlanSettings settings = make_settings();
  PathFinisher finisher{checker, settings.finish()};
  internal::PlannerRun run{PlanTask{checker, world.query, sampler, settings, finisher}};
  internal::Tree tree{run};
  internal::Growth batch{run};
};

/// An arm of space in the open that walks as often as `share` says; its sampler plays one draw.
struct WalkingFixture {
  static PlanSettings make_settings(double share) {
    PlanSettings settings;
    settings.walk = share;
    settings.walk_after = 0;
    settings.max_iterations = 1000;
    return settings;
  }
  explicit WalkingFixture(double share)
      : of_run({"", spatial_arm(), {}, {{0, 0.5, 0.5, 0}, {{1, 1, 1, 1}}}}, make_settings(share),
               Isa::automatic,
               std::make_unique<ScriptedSampler>(std::vector<Configuration>{{1, -1, 1, 0}})) {
    tree.add(of_run.run.start(), -1);
  }
  [[nodiscard]] const ScriptedSampler::Log& log() const {
    return dynamic_cast<const ScriptedSampler&>(*of_run.sampler).log();
  }

  RunFixture of_run;
  internal::Tree tree{of_run.run};
  internal::Growth growth{of_run.run};
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a batch is one step after a success and grows with the rejections in a row") {
    BatchFixture f({{0, 0, 1}});
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.size() == 1);
    f.batch.settle(0, SampleOutcome::rejected);
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.size() == 2);
    f.reject_until(16);
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.size() == 16);
    f.batch.settle(0, SampleOutcome::extended);
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.size() == 1);
  }

  TEST_CASE("steps go from the nearest node towards the sample, at most the range") {
    BatchFixture f({{0, 0, 2}, {0, 0.25, 0}});
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.node(0) == 0);
    CHECK(f.batch.end(0)[2] == doctest::Approx(0.5));
    CHECK(f.batch.sample(0)[2] == 2);
    CHECK(!f.batch.is_sample_reached(0));
    f.batch.settle(0, SampleOutcome::extended);
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.end(0)[1] == 0.25f);
    CHECK(f.batch.is_sample_reached(0));
  }

  TEST_CASE("ends in contact are known before any motion is checked") {
    BatchFixture f({{0.5, 0, 0}, {0.85, 0, 0}});
    const int near_wall = f.tree.add(std::vector<float>{0.5f, 0.0f, 0.0f}, 0);
    f.reject_until(2);
    REQUIRE(f.batch.sample_steps(f.tree));
    for (int i = 0; i < f.batch.size(); ++i) {
      CHECK(f.batch.node(i) == near_wall);
      CHECK(f.batch.is_end_valid(i) == (f.batch.sample(i)[0] < 0.8f));
    }
  }

  TEST_CASE("samples outside the domain of their node are rejected without a step") {
    BatchFixture f({{0, 0, 2}, {0, 0, 0.5}});
    for (int i = 0; i < 20000; ++i) f.tree.adapt_domain(0, false);
    REQUIRE(f.batch.sample_steps(f.tree));
    REQUIRE(f.batch.size() == 1);
    CHECK(f.batch.sample(0)[2] == 0.5f);
    const auto& reports = f.sampler.log().reports;
    REQUIRE(reports.size() == 1);
    CHECK(reports.front() == std::pair(SampleSource{0}, SampleOutcome::rejected));
  }

  TEST_CASE("after many rejections a step starts at any node, wherever its sample is") {
    BatchFixture f({{0, 0, 2}});
    f.tree.add(std::vector<float>{0.0f, 0.0f, 0.5f}, 0);
    for (int i = 0; i < 20000; ++i) f.tree.adapt_domain(1, false);
    int from_root = 0;
    for (int round = 0; round < 20; ++round) {
      REQUIRE(f.batch.sample_steps(f.tree));
      REQUIRE(f.batch.size() == 1);
      from_root += f.batch.node(0) == 0 ? 1 : 0;
      f.batch.settle(0, SampleOutcome::extended);
    }
    CHECK(from_root > 0);
    CHECK(from_root < 20);
  }

  TEST_CASE("a batch that a limit ends early has the steps that were drawn") {
    BatchFixture f({{0, 0, 1}});
    f.reject_until(16);
    f.settings.max_iterations = f.sampler.log().drawn + 5;
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.size() == 5);
    CHECK(!f.batch.sample_steps(f.tree));
  }

  TEST_CASE("a step that is taken goes on towards its draw until it is there") {
    BatchFixture f({{0, 0, 1.75}});
    REQUIRE(f.batch.sample_steps(f.tree));
    const int last = f.batch.take(0, f.tree);
    CHECK(last == 4);
    CHECK(f.tree.size() == 5);
    CHECK(f.tree[last][2] == 1.75f);
    CHECK(f.tree.path_to(last).size() == 5);
  }

  TEST_CASE("a step that is taken ends before what blocks it") {
    BatchFixture f({{2, 0, 0}});
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.take(0, f.tree) == 1);
    CHECK(f.tree.size() == 2);
    CHECK(f.tree[1][0] == 0.5f);
    f.batch.settle(0, SampleOutcome::extended);
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.take(0, f.tree) == -1);
    CHECK(f.tree.size() == 2);
  }

  TEST_CASE("a step that is taken ends at the limit of nodes") {
    BatchFixture f({{0, 0, 1.75}});
    f.settings.max_nodes = 3;
    REQUIRE(f.batch.sample_steps(f.tree));
    CHECK(f.batch.take(0, f.tree) == 2);
    CHECK(f.tree.size() == 3);
    CHECK(f.batch.take(0, f.tree) == -1);
    CHECK(f.tree.size() == 3);
  }

  TEST_CASE("a walk is an iteration and a batch by itself that the sampler knows nothing of") {
    WalkingFixture f(1);
    for (std::uint64_t i = 1; i <= 20; ++i) {
      const int before = f.tree.size();
      REQUIRE(f.growth.sample_steps(f.tree));
      CHECK(f.growth.size() == 1);
      CHECK(f.of_run.run.iterations() == i);
      const int last = f.growth.take(0, f.tree);
      CHECK(last == (f.tree.size() == before ? -1 : f.tree.size() - 1));
      f.growth.settle(0, last < 0 ? SampleOutcome::rejected : SampleOutcome::extended);
    }
    CHECK(f.tree.size() > 20);
    CHECK(f.log().drawn == 0);
    CHECK(f.log().reports.empty());
  }

  TEST_CASE(
      "walks and draws together are the iterations, and rejected walks do not widen batches") {
    WalkingFixture f(0.5);
    f.of_run.settings.max_nodes = 100000;
    std::uint64_t walks = 0;
    for (int i = 0; i < 200; ++i) {
      const std::uint64_t drawn = f.log().drawn;
      REQUIRE(f.growth.sample_steps(f.tree));
      CHECK(f.growth.size() == 1);
      const bool is_walk = f.log().drawn == drawn;
      walks += is_walk ? 1 : 0;
      f.growth.take(0, f.tree);
      f.growth.settle(0, is_walk ? SampleOutcome::rejected : SampleOutcome::extended);
    }
    CHECK(walks > 0);
    CHECK(walks < 100);
    CHECK(f.log().drawn + walks == f.of_run.run.iterations());
    CHECK(f.log().reports.size() == f.log().drawn);
  }

  TEST_CASE("walks end at the limit of iterations") {
    WalkingFixture f(1);
    f.of_run.settings.max_iterations = 3;
    for (int i = 0; i < 3; ++i) REQUIRE(f.growth.sample_steps(f.tree));
    CHECK(!f.growth.sample_steps(f.tree));
    CHECK(f.growth.size() == 0);
    CHECK(f.of_run.run.iterations() == 3);
    CHECK(f.log().drawn == 0);
  }
}

}  // namespace mneme::test
