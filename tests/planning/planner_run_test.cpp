// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/scripted_sampler.h"
#include "planning/small_worlds.h"
#include "planning/planner_run.h"

#include <atomic>

namespace mneme::test {
namespace {

/// A run that outlives what it refers to.
struct Fixture {
  explicit Fixture(World world_, const PlanSettings& settings_ = {},
                   const CheckerSettings& checking = {})
      : world(std::move(world_)),
        settings(settings_),
        checker(make_checker(world, checking)),
        sampler({Configuration(world.query.start.size(), 0.125)}),
        finisher(checker, settings.finish()),
        run({checker, world.query, sampler, settings, finisher}) {}

  World world;
  PlanSettings settings;
  CollisionChecker checker;
  ScriptedSampler sampler;
  PathFinisher finisher;
  internal::PlannerRun run;
};

World open_world() { return {"open", gantry(), {}, {{0.1, 0.2, 0.3}, {{1, 1, 1}, {-1, 0.7, 0}}}}; }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a run has start and goals within the limits in single precision") {
    World world = open_world();
    world.query.goals.push_back({2 + 5e-6, 0, 0});
    const Fixture f(world);
    CHECK(f.run.start() == std::vector<float>{0.1f, 0.2f, 0.3f});
    CHECK(f.run.goals() == internal::FloatPath{{1, 1, 1}, {-1, 0.7f, 0}, {2, 0, 0}});
  }

  TEST_CASE("a range that is left out is the robot's own, and twice that early in the search") {
    const auto own = doctest::Approx(default_range(gantry()));
    Fixture f(open_world());
    CHECK(f.run.range() / 2 == own);
    CHECK(f.run.begin_iterations(99) == 99);
    CHECK(f.run.range() / 2 == own);
    CHECK(f.run.begin_iterations() == 1);
    CHECK(f.run.range() == own);
  }

  TEST_CASE("a range or a resolution that is set, or no verification, keeps early steps short") {
    const auto own = doctest::Approx(default_range(gantry()));
    CHECK(Fixture(open_world(), {}, {.resolution = 0.01}).run.range() == own);
    PlanSettings unverified;
    unverified.verify = false;
    CHECK(Fixture(open_world(), unverified).run.range() == own);
    PlanSettings settings;
    settings.range = 0.125;
    CHECK(Fixture(open_world(), settings).run.range() == 0.125f);
  }

  TEST_CASE("messages name every goal by its number and at most four contacts") {
    World world = open_world();
    for (int i = 0; i < 6; ++i) {
      world.scene.obstacles.push_back(
          make_ball("ball" + std::to_string(i), {1, 1, 1}, 0.1 + 0.1 * i));
    }
    const auto refused = require(refuse_query(make_checker(world), world.query));
    const PlanResult& result = refused;
    CHECK(result.status == PlanStatus::invalid_goal);
    CHECK(contains(result.message, "goal 1 is in contact"));
    CHECK(contains(result.message, "link 'link_3' touches obstacle 'ball0'"));
    CHECK(contains(result.message, "'ball3'"));
    CHECK(!contains(result.message, "'ball4'"));
    CHECK(contains(result.message, "2 more"));
  }

  TEST_CASE("iterations end at the limit") {
    PlanSettings settings;
    settings.max_iterations = 40;
    Fixture f(open_world(), settings);
    int count = 0;
    while (f.run.begin_iterations()) ++count;
    CHECK(count == 40);
    const PlanResult result = f.run.give_up(7);
    CHECK(result.status == PlanStatus::iteration_limit);
    CHECK(result.iterations == 40);
    CHECK(result.nodes == 7);
  }

  TEST_CASE("a run that is cancelled before it begins does not begin") {
    const std::atomic<bool> is_cancelled = true;
    PlanSettings settings;
    settings.cancel = &is_cancelled;
    Fixture f(open_world(), settings);
    CHECK(!f.run.find_direct_path());
    CHECK(!f.run.begin_iterations());
    CHECK(f.run.give_up(0).status == PlanStatus::cancelled);
  }

  TEST_CASE("the first goal in sight of the start is found") {
    World world = open_world();
    world.scene.obstacles = {make_box("wall", {0.4, -3, -3}, {0.6, 3, 3})};
    Fixture f(world);
    REQUIRE(f.run.find_direct_path());
    CHECK(f.run.finish(2).path == Path{world.query.start, world.query.goals[1]});
    world.query.goals.pop_back();
    Fixture blocked(world);
    CHECK(!blocked.run.find_direct_path());
  }

  TEST_CASE("a finished path ends at the query's own values") {
    World world{"", gantry(), {}, {{0.1, 0.2, 0.3}, {{1, 1, 1}, {1.0 / 3, 0.7, -2 - 1e-6}}}};
    for (const bool simplify : {true, false}) {
      PlanSettings settings;
      settings.simplify = simplify;
      Fixture f(world, settings);
      const internal::FloatPath path = {f.run.start(), {1, 0, -1}, f.run.goals()[1]};
      REQUIRE(f.run.find_invalid_motion(path) == -1);
      const PlanResult result = f.run.finish(3);
      CHECK(result.status == PlanStatus::solved);
      CHECK(result.path.front() == world.query.start);
      CHECK(result.path.back() == Configuration{1.0 / 3, 0.7, -2});
      CHECK(result.path.size() == (simplify ? 2 : 3));
      CHECK(result.nodes == 3);
    }
  }

  TEST_CASE("what shortcuts leave of a path is verified, not what they cut off") {
    World world = open_world();
    world.scene.obstacles = {make_ball("ball", {-1, -1, -1}, 0.5)};
    Fixture f(world);
    const internal::FloatPath path = {f.run.start(), {-1, -1, -1}, f.run.goals()[0]};
    REQUIRE(f.run.find_invalid_motion(path) == -1);
    CHECK(f.run.finish(3).path == Path{world.query.start, world.query.goals[0]});

    PlanSettings as_planned;
    as_planned.simplify = false;
    Fixture raw(world, as_planned);
    CHECK(raw.run.find_invalid_motion(path) == 0);
  }

  TEST_CASE("shortcuts through what no state meets are not taken") {
    // The fin lies between two of the 16 states of the straight motion.
    World world{"", gantry(), {}, {{-1.9, 0, 0}, {{1.9, 0, 0}}}};
    world.scene.obstacles = {make_box("fin", {0.5937, -0.5, -0.5}, {0.5938, 0.5, 0.5})};
    PlanSettings settings;
    settings.continuous = true;
    Fixture f(world, settings, coarse_states());
    const internal::FloatPath path = {f.run.start(), {-1.9f, 1, 0}, {1.9f, 1, 0}, f.run.goals()[0]};
    REQUIRE(f.run.is_motion_valid(path.front(), path.back()));
    REQUIRE(f.run.find_invalid_motion(path) == -1);
    const PlanResult result = f.run.finish(4);
    CHECK(result.path.size() > 2);
    CheckCounters ignored;
    CHECK(find_invalid_motion(f.checker, result.path, ignored, Verification::motions) == -1);
  }

  TEST_CASE("simplification and verification are not planning time") {
    Fixture f(open_world());
    const internal::FloatPath path = {f.run.start(), {1, 0, -1}, f.run.goals()[1]};
    CHECK(f.run.find_invalid_motion(path) == -1);
    const PlanResult result = f.run.finish(3);
    CHECK(result.verification_time_s > 0);
    CHECK(result.simplification_time_s > 0);
    CHECK(result.planning_time_s >= 0);
    CHECK(result.motions_checked > 2);
  }

  TEST_CASE("whoever gives up says how many paths were found and not verified") {
    World world = open_world();
    world.scene.obstacles = {make_box("wall", {0.4, -3, -3}, {0.6, 3, 3})};
    PlanSettings settings;
    settings.timeout_s = 1e-9;
    Fixture f(world, settings);
    const internal::FloatPath path = {f.run.start(), f.run.goals()[0]};
    CHECK(f.run.find_invalid_motion(path) == 0);
    CHECK(f.run.find_invalid_motion(path) == 0);
    CHECK(!f.run.begin_iterations());
    CHECK(f.run.give_up(0).message ==
          "no path within the time limit; verification refused 2 paths");
  }

  TEST_CASE("draws and reports go to the sampler's stream, checks are counted") {
    Fixture f(open_world());
    std::vector<float> q(3);
    CHECK(f.run.sample(q) == 0);
    CHECK(q == std::vector<float>(3, 0.125f));
    f.run.report(0, SampleOutcome::connected);
    REQUIRE(f.sampler.log().reports.size() == 1);
    CHECK(f.sampler.log().reports[0] == std::pair(0, SampleOutcome::connected));
    std::vector<std::uint8_t> is_valid(1);
    f.run.check_states(q, is_valid);
    CHECK(is_valid[0] == 1);
    const PlanResult result = f.run.give_up(0);
    CHECK(result.states_checked == 1);
    CHECK(result.motions_checked == 0);
  }
}

}  // namespace mneme::test
