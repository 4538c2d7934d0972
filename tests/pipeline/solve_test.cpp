// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/lifting_arm.h"
#include "support/planar_memory.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace mneme::test {
namespace {

/// Checks that a solve with `settings` is an error of kind invalid that names `word`.
void check_refused(const Problem& problem, const SolveSettings& settings, const std::string& word) {
  const Error error = require_error(solve(problem, nullptr, settings));
  INFO(word);
  CHECK(error.code == ErrorCode::invalid);
  CHECK_MESSAGE(contains(error.message, word), error.message);
}

/// Puts each number of `part`, a part of `settings`, outside its range, and expects its name.
template <class Part>
void check_ranges_of(const Problem& problem, SolveSettings& settings, Part& part) {
  visit_settings(part, [&](const char* name, auto& value, auto least, auto most, const char*) {
    using Setting = std::remove_cvref_t<decltype(value)>;
    using Value = SettingValue<Setting>;
    const Setting before = value;
    if constexpr (std::is_floating_point_v<Value>) {
      for (const double bad :
           {least - 1, most * 1.01, std::nan(""), std::numeric_limits<double>::infinity()}) {
        value = bad;
        check_refused(problem, settings, std::string("'") + name + "'");
      }
    } else if constexpr (std::is_same_v<Value, int>) {
      for (const int bad : {least - 1, most + 1}) {
        value = bad;
        check_refused(problem, settings, std::string("'") + name + "'");
      }
    }
    value = before;
  });
}

/// An easy problem: the arm turns away from a circle.
Problem easy_problem() {
  Problem problem = planar_problem("threaded_b0");
  problem.scene = make_circle_scene("", {{4, 4, 1.5}, {-2, 4.5, 1}});
  problem.start = Configuration(8, 0.1);
  problem.goals = {Configuration(8, 0.1)};
  problem.goals[0][0] = -2.5;
  return problem;
}

/// lifting_arm() from above the shelf's board to below it.
Problem spatial_problem() {
  return {"spatial", lifting_arm(), "", shelf_scene(), {0, 0, 0, 0}, {{0, 0, 0.6, -0.4}}, {}};
}

/// Learns the primitives of a problem's scene from paths of other queries in it.
void learn_paths_into(Database& database, const Problem& problem) {
  SolveSettings settings;
  settings.plan.timeout_s = 60;
  settings.sampler = "uniform";
  std::vector<Path> paths;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    settings.plan.seed = seed;
    const SolveResult result = require_solved(problem, nullptr, settings);
    paths.push_back(result.plan.path);
  }
  auto rows = require(learn_from_paths(memory_query(problem), paths, {}, 0.3));
  REQUIRE(!rows.empty());
  require(database.insert(std::move(rows)));
}

double mean_iterations(const Problem& problem, Database* database, SolveSettings settings,
                       int seeds) {
  std::uint64_t sum = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    settings.plan.seed = static_cast<std::uint64_t>(seed);
    sum += require(solve(problem, database, settings)).plan.iterations;
  }
  return static_cast<double>(sum) / seeds;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a path begins at the turn of the start and never jumps") {
    Problem problem = easy_problem();
    problem.goals[0][0] = -2.5;
    for (const double turns : {0.0, 1.0, -3.0}) {
      for (const double angle : {2.7, 0.1}) {
        problem.start[0] = angle + 2 * kPi * turns;
        for (const char* planner : {"rrt_connect", "rrt", "prm"}) {
          SolveSettings settings;
          settings.planner = planner;
          const SolveResult result = require_solved(problem, nullptr, settings);
          const Path& path = result.plan.path;
          CHECK(path.front() == problem.start);
          for (std::size_t i = 1; i < path.size(); ++i) {
            CHECK(std::abs(path[i][0] - path[i - 1][0]) < kPi);
          }
          CHECK(std::abs(std::remainder(path.back()[0] + 2.5, 2 * kPi)) < 1e-6);
          CHECK(is_path_free(problem.robot, problem.scene, path, 0.002));
          const RateLimits limits{Configuration(8, 1.0), Configuration(8, 1.0)};
          const auto trajectory = require(make_trajectory(problem, settings, path, limits));
          CHECK(trajectory.at(0).position == problem.start);
          const Configuration end = trajectory.at(trajectory.duration_s()).position;
          CHECK(end[0] == doctest::Approx(path.back()[0]));
        }
      }
    }
  }

  TEST_CASE("memory of similar pairs needs far fewer iterations than uniform sampling") {
    const Problem problem = planar_problem("threaded_b4");
    const auto primitives = require(decompose(memory_query(problem)));
    REQUIRE(primitives.size() == 1);
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    LearnSettings learning;
    learning.starts_per_link = 2;
    learn_into(database, problem.robot, keys_near(primitives[0].key, 60, 0.2, 1), learning);
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.plan.max_iterations = 400000;
    settings.plan.simplify = false;
    settings.plan.anchor = 0;
    settings.plan.walk = 0;
    const double uniform = mean_iterations(problem, nullptr, settings, 6);
    const double memory = mean_iterations(problem, &database, settings, 6);
    INFO("uniform ", uniform, ", memory ", memory);
    CHECK(memory < 0.25 * uniform);
    require_solved(problem, &database, settings);
  }

  TEST_CASE("memory of the bare robot helps it when it carries something, and its paths are free") {
    Problem problem = planar_problem("threaded_b4");
    const auto primitives = require(decompose(memory_query(problem)));
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    LearnSettings learning;
    learning.starts_per_link = 2;
    learn_into(database, problem.robot, keys_near(primitives[0].key, 20, 0.2, 1), learning);
    // Off the axis: what pairs ask of a robot does not count for what it carries.
    const auto robot =
        require(attach(problem.robot, {{"cup", "link_8", {Sphere{{0.2, 0.05, 0}, 0.01}}}}));
    problem.robot = robot;
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.plan.max_iterations = 400000;
    settings.retrieve_after = 0;
    const auto result = require(solve(problem, &database, settings));
    CHECK(result.gl.mixture->component_count() > 0);
    REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
    CHECK(is_path_free(problem.robot, problem.scene, result.plan.path, 0.002));
  }

  TEST_CASE("a start in contact is solved once that contact is allowed") {
    Problem problem = easy_problem();
    problem.scene.obstacles.push_back({"post", {Sphere{{1, 0, 0}, 0.1}}});
    const std::vector<std::string> links = {"link_1"};
    problem.start.assign(8, 0.0);
    CHECK(require(solve(problem, nullptr, {})).plan.status == PlanStatus::invalid_start);
    problem.scene.obstacles.back().may_touch = links;
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.margin = 1e-3;
    CHECK(require(solve(problem, nullptr, settings)).plan.status != PlanStatus::invalid_start);
    problem.scene.obstacles.back().may_touch = {"hand"};
    CHECK(contains(solve(problem, nullptr, settings).error().message, "'hand'"));
  }

  TEST_CASE("every planner solves with every sampler, and its path starts and ends as asked") {
    const Problem problem = easy_problem();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.learn = cheap_settings();
    settings.memory.max_gap = 5;
    for (const PlannerEntry& planner : planners()) {
      for (const SamplerEntry& entry : samplers()) {
        if (entry.samples_valid_states) continue;
        const std::string_view sampler = entry.name;
        INFO(planner.name, " with ", sampler);
        settings.planner = planner.name;
        settings.sampler = sampler;
        settings.learn_budget_s = entry.uses_memory ? 1 : 0;
        const SolveResult result = require_solved(problem, &database, settings);
        CHECK(result.planner == planner.name);
        CHECK(result.sampler == sampler);
        CHECK(result.seed == settings.plan.seed);
        CHECK(result.isa != Isa::automatic);
        CHECK(result.plan.path.front() == problem.robot.normalized(problem.start));
        CHECK(result.plan.path.back() == problem.robot.normalized(problem.goals[0]));
        CHECK(result.gl.primitives.size() == (sampler == "gl" ? 1 : 0));
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("times are consistent") {
    const Problem problem = planar_problem("scenario1");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.learn_budget_s = 60;
    settings.plan.timeout_s = 60;
    settings.learn = cheap_settings();
    bool has_learned = false;
    for (int round = 0; round < 3; ++round) {
      const SolveResult result = require(solve(problem, &database, settings));
      CHECK(result.total_time_s > 0);
      CHECK(result.planning_time_s > 0);
      CHECK(result.planning_time_s <= result.total_time_s);
      CHECK(result.preparation_time_s + result.planning_time_s + result.plan.simplification_time_s +
                result.plan.verification_time_s ==
            doctest::Approx(result.total_time_s));
      CHECK(result.plan.planning_time_s <= result.planning_time_s);
      CHECK(result.gl.retrieval_time_s > 0);
      CHECK(result.gl.retrieval_time_s + result.gl.learning_time_s <= result.plan.planning_time_s);
      CHECK((result.gl.learning_time_s > 0) == (round == 0));
      has_learned = has_learned || result.gl.primitives.at(0).is_learned;
    }
    CHECK(has_learned);
  }

  TEST_CASE("the same seed gives the same path, another one another path") {
    const Problem problem = planar_problem("threaded_b2");
    const auto primitives = require(decompose(memory_query(problem)));
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    learn_into(database, problem.robot, keys_near(primitives[0].key, 20, 0.1, 4));
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.plan.max_iterations = 1000000;
    const SolveResult first = require(solve(problem, &database, settings));
    const SolveResult second = require(solve(problem, &database, settings));
    REQUIRE_MESSAGE(first.plan.is_solved(), first.plan.message);
    CHECK(first.plan.path == second.plan.path);
    CHECK(first.plan.iterations == second.plan.iterations);
    settings.plan.seed = 2;
    CHECK(require(solve(problem, &database, settings)).plan.path != first.plan.path);
  }

  TEST_CASE("an arm in space solves with memory, and the same seed gives the same path") {
    const Problem problem = spatial_problem();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    learn_paths_into(database, problem);
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    for (const std::optional<int> after :
         {std::optional(0), std::optional(1), std::optional<int>()}) {
      settings.retrieve_after = after;
      for (const PlannerEntry& planner : planners()) {
        settings.planner = planner.name;
        settings.plan.seed = 1;
        INFO(planner.name, " after ", after.value_or(-1));
        const SolveResult first = require_solved(problem, &database, settings);
        CHECK(first.plan.path.front() == problem.robot.normalized(problem.start));
        CHECK(first.plan.path.back() == problem.robot.normalized(problem.goals[0]));
        CheckCounters counters;
        const CollisionChecker checker = make_checker(problem.robot, problem.scene);
        CHECK(find_invalid_motion(checker, first.plan.path, counters) == -1);
        const SolveResult second = require(solve(problem, &database, settings));
        CHECK(first.plan.path == second.plan.path);
        CHECK(first.plan.iterations == second.plan.iterations);
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("without a database or without a match the sampler is uniform") {
    const Problem problem = planar_problem("scenario1");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.retrieve_after = 0;
    const SolveResult gl = require(solve(problem, nullptr, settings));
    CHECK(gl.sampler == "gl");
    CHECK(gl.gl.primitives.empty());
    const SolveResult without_match = require(solve(problem, &database, settings));
    CHECK(without_match.gl.primitives.size() == 1);
    settings.sampler = "uniform";
    const SolveResult uniform = require(solve(problem, &database, settings));
    CHECK(uniform.gl.primitives.empty());
    REQUIRE(uniform.plan.is_solved());
    CHECK(gl.plan.path == uniform.plan.path);
    CHECK(without_match.plan.path == uniform.plan.path);
  }

  TEST_CASE("an unknown planner or sampler is an error that names those there are") {
    const Problem problem = easy_problem();
    SolveSettings settings;
    settings.planner = "teleport";
    check_refused(problem, settings, "'teleport'");
    check_refused(problem, settings, "rrt_connect, rrt, prm");
    settings = {};
    settings.sampler = "psychic";
    check_refused(problem, settings, "'psychic'");
    check_refused(problem, settings, "gl, uniform, halton");
    settings.sampler = "";
    check_refused(problem, settings, "''");
  }

  TEST_CASE("every number outside its range is an error that names the setting") {
    const Problem problem = easy_problem();
    SolveSettings settings;
    check_ranges_of(problem, settings, settings);
    check_ranges_of(problem, settings, settings.plan);
    check_ranges_of(problem, settings, settings.memory);
    check_ranges_of(problem, settings, settings.learn);
    CHECK(solve(problem, nullptr, settings).has_value());
  }

  TEST_CASE("a bad start is an answer, not an error") {
    Problem problem = easy_problem();
    problem.start = {kPi / 4, 0, 0, 0, 0, 0, 0, 0};
    const SolveResult result = require(solve(problem, nullptr, {}));
    CHECK(result.plan.status == PlanStatus::invalid_start);
    CHECK(contains(result.plan.message, problem.scene.obstacles[0].name));
    problem = easy_problem();
    problem.goals.clear();
    CHECK(require(solve(problem, nullptr, {})).plan.status == PlanStatus::invalid_goal);
  }

  TEST_CASE(
      "of several goals those in contact are left out with a note, and the rest is planned to") {
    Problem problem = easy_problem();
    const Configuration free = problem.goals[0];
    problem.goals = {{kPi / 4, 0, 0, 0, 0, 0, 0, 0}, free};
    const SolveResult result = require_solved(problem, nullptr, {});
    CHECK(result.goals == std::vector<Configuration>{free});
    REQUIRE(result.notes.size() == 1);
    CHECK(result.notes[0].starts_with("goal 1 is in contact: "));
    problem.goals.pop_back();
    const SolveResult refused = require(solve(problem, nullptr, {}));
    CHECK(refused.plan.status == PlanStatus::invalid_goal);
    CHECK(refused.notes.empty());
  }

  TEST_CASE("no time is a timeout") {
    SolveSettings settings;
    settings.plan.timeout_s = 0;
    const SolveResult result = require(solve(easy_problem(), nullptr, settings));
    CHECK(result.plan.status == PlanStatus::timeout);
    CHECK(result.plan.iterations == 0);
  }

  TEST_CASE("learning keeps the time limit and hears a cancellation") {
    const Problem problem = planar_problem("scenario2");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.learn_budget_s = 100;
    settings.learn.starts_per_link = 1000;
    settings.learn.paths_per_start = 1000;
    settings.similarity = 1e-9;
    for (const bool is_merging : {false, true}) {
      settings.learn.merge_cliques = is_merging;
      settings.plan.timeout_s = is_merging ? 0.8 : 0.4;
      const SolveResult result = require(solve(problem, &database, settings));
      // Without the limit it would be minutes; the slack is for busy machines.
      CHECK(result.total_time_s < settings.plan.timeout_s + 10);
    }
    const std::int64_t rows = database.size();
    CHECK(rows > 0);
    const std::atomic<bool> is_cancelled = true;
    settings.plan.timeout_s = 100;
    settings.plan.cancel = &is_cancelled;
    const SolveResult cancelled = require(solve(problem, &database, settings));
    CHECK(cancelled.plan.status == PlanStatus::cancelled);
    CHECK(cancelled.total_time_s < 10);
    CHECK(database.size() == rows);
  }

  TEST_CASE("what is learned says with which settings, the resolution of the solve included") {
    const Problem problem = planar_problem("scenario1");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.learn_budget_s = 60;
    settings.plan.timeout_s = 60;
    settings.learn = cheap_settings();
    settings.resolution = 0.03;
    const auto learned_with = [&] {
      require(solve(problem, &database, settings));
      return database.get(database.size() - 1)->provenance.settings;
    };
    CHECK(contains(learned_with(), "learn-resolution=0.03"));
    Database other = make_database(directory / "b.db", problem.robot);
    database = std::move(other);
    settings.learn.resolution = 0.01;
    CHECK(contains(learned_with(), "learn-resolution=0.01"));
  }

  TEST_CASE(
      "a scene that the kind of memory cannot take is an error only for the sampler of memory") {
    Problem problem = easy_problem();
    Box crate;
    crate.pose.translation = Vec3(0, 20, 0);
    crate.half_extents = Vec3(1, 1, 1);
    problem.scene.obstacles.push_back({"crate", {crate}});
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.retrieve_after = 0;
    CHECK(contains(require_error(solve(problem, &database, settings)).message, "'crate'"));
    settings.sampler = "uniform";
    require_solved(problem, &database, settings);
    require_solved(problem, nullptr, {});
  }

  TEST_CASE("a database of another robot is an error, if memory is asked for") {
    const Problem problem = easy_problem();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", planar_arm({3, 3, 3}));
    CHECK(require_error(solve(problem, &database, {})).code == ErrorCode::wrong_robot);
    SolveSettings settings;
    settings.sampler = "uniform";
    require_solved(problem, &database, settings);
  }

  TEST_CASE("memory is asked only after so many iterations, and reported only then") {
    const Problem problem = spatial_problem();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    learn_paths_into(database, problem);
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.retrieve_after = 1000000000;
    const SolveResult late = require_solved(problem, &database, settings);
    CHECK(late.gl.primitives.empty());
    CHECK(late.gl.mixture == nullptr);
    CHECK(late.gl.retrieval_time_s == 0);
    // Until then it is the uniform planner.
    const SolveResult uniform = require(solve(problem, nullptr, settings));
    CHECK(late.plan.path == uniform.plan.path);
    REQUIRE(uniform.plan.iterations > 1);
    for (const int after : {0, 1}) {
      settings.retrieve_after = after;
      const SolveResult result = require_solved(problem, &database, settings);
      CHECK(result.gl.primitives.size() == 3);
      REQUIRE(result.gl.mixture != nullptr);
      CHECK(result.gl.mixture->component_count() > 0);
      CHECK(result.gl.retrieval_time_s > 0);
      CHECK(result.gl.retrieval_time_s <= result.plan.planning_time_s);
      CHECK(result.plan.planning_time_s <= result.planning_time_s);
    }
  }

  TEST_CASE("a database of another robot is an error even if memory is never asked") {
    const Problem problem = spatial_problem();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", planar8());
    SolveSettings settings;
    settings.retrieve_after = 1000000000;
    CHECK(require_error(solve(problem, &database, settings)).code == ErrorCode::wrong_robot);
  }

  TEST_CASE("what goes wrong when memory is asked late is an error too") {
    Problem problem = planar_problem("threaded_b2");
    problem.scene.obstacles.push_back({"crate", {box_at({0, 20, 0}, {1, 1, 1})}});
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", problem.robot);
    SolveSettings settings;
    settings.retrieve_after = 1;
    CHECK(contains(require_error(solve(problem, &database, settings)).message, "'crate'"));
  }

  TEST_CASE("a scene that cannot be checked is an error") {
    Problem problem = easy_problem();
    problem.scene.obstacles.push_back({"hole", {Sphere{Vec3(std::nan(""), 0, 0), 1}}});
    CHECK(contains(require_error(solve(problem, nullptr, {})).message, "'hole'"));
  }

  TEST_CASE("means in contact with the whole scene are dropped, unless they shall not be") {
    Problem problem = easy_problem();
    const Robot& robot = problem.robot;
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    problem.scene = make_scene(near_pair());
    learn_into(database, robot, {near_pair()});
    problem.scene.obstacles.push_back({"post", {Sphere{Vec3(5.5, 1, 0), 0.8}}});
    problem.start = Configuration(8, 0.1);
    problem.start[0] = 2;
    problem.goals = {problem.start};
    SolveSettings settings;
    settings.retrieve_after = 0;
    settings.retarget = false;
    const SolveResult dropped = require(solve(problem, &database, settings));
    settings.drop_invalid_means = false;
    const SolveResult kept = require(solve(problem, &database, settings));
    CHECK(kept.gl.mixture->component_count() == database.info().components);
    CHECK(dropped.gl.mixture->component_count() < kept.gl.mixture->component_count());
    const CollisionChecker checker = make_checker(robot, problem.scene);
    for (int i = 0; i < dropped.gl.mixture->component_count(); ++i) {
      CHECK(checker.is_valid(std::span<const double>(mean_of(*dropped.gl.mixture, i))));
    }
  }

  TEST_CASE("the samplers have names of their own") {
    CHECK(sampler_names().size() == samplers().size());
    CHECK(sampler_names().front() == "gl");
    CHECK(find_sampler("Unifrom").error().message.ends_with("did you mean 'uniform'?"));
    for (const SamplerEntry& entry : samplers()) {
      CHECK(find_sampler(entry.name).value() == &entry);
      CHECK(!entry.summary.empty());
      CHECK(bool(entry.make != nullptr));
    }
  }
}

}  // namespace mneme::test
