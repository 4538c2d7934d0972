// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/scripted_sampler.h"
#include "planning/small_worlds.h"
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
  /// Draws until a batch of `count` steps has been rejected as a whole.
  void reject_until(int count) {
    do {
      REQUIRE(batch.draw(tree));
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

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a batch is one step after a success and grows with the rejections in a row") {
    BatchFixture f({{0, 0, 1}});
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.size() == 1);
    f.batch.settle(0, SampleOutcome::rejected);
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.size() == 2);
    f.reject_until(16);
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.size() == 16);
    f.batch.settle(0, SampleOutcome::extended);
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.size() == 1);
  }

  TEST_CASE("steps go from the nearest node towards the sample, at most the range") {
    BatchFixture f({{0, 0, 2}, {0, 0.25, 0}});
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.node(0) == 0);
    CHECK(f.batch.end(0)[2] == doctest::Approx(0.5));
    CHECK(f.batch.sample(0)[2] == 2);
    CHECK(!f.batch.is_sample_reached(0));
    f.batch.settle(0, SampleOutcome::extended);
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.end(0)[1] == 0.25f);
    CHECK(f.batch.is_sample_reached(0));
  }

  TEST_CASE("ends in contact are known before any motion is checked") {
    BatchFixture f({{0.5, 0, 0}, {0.85, 0, 0}});
    const int near_wall = f.tree.add(std::vector<float>{0.5f, 0.0f, 0.0f}, 0);
    f.reject_until(2);
    REQUIRE(f.batch.draw(f.tree));
    for (int i = 0; i < f.batch.size(); ++i) {
      CHECK(f.batch.node(i) == near_wall);
      CHECK(f.batch.is_end_valid(i) == (f.batch.sample(i)[0] < 0.8f));
    }
  }

  TEST_CASE("samples outside the domain of their node are rejected without a step") {
    BatchFixture f({{0, 0, 2}, {0, 0, 0.5}});
    for (int i = 0; i < 20000; ++i) f.tree.adapt_domain(0, false);
    REQUIRE(f.batch.draw(f.tree));
    REQUIRE(f.batch.size() == 1);
    CHECK(f.batch.sample(0)[2] == 0.5f);
    const auto& reports = f.sampler.log().reports;
    REQUIRE(reports.size() == 1);
    CHECK(reports.front() == std::pair(Origin{0}, SampleOutcome::rejected));
  }

  TEST_CASE("after many rejections a step starts at any node, wherever its sample is") {
    BatchFixture f({{0, 0, 2}});
    f.tree.add(std::vector<float>{0.0f, 0.0f, 0.5f}, 0);
    for (int i = 0; i < 20000; ++i) f.tree.adapt_domain(1, false);
    int from_root = 0;
    for (int round = 0; round < 20; ++round) {
      REQUIRE(f.batch.draw(f.tree));
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
    REQUIRE(f.batch.draw(f.tree));
    CHECK(f.batch.size() == 5);
    CHECK(!f.batch.draw(f.tree));
  }
}

}  // namespace mneme::test
