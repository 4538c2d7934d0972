// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/motion_memory.h"
#include "replay/proven_motions.h"
#include "store/row_codec.h"
#include "support/enclosed_arm.h"
#include "support/kinds.h"

namespace mneme::test {
namespace {

/// A memory of a passage alone, and the passage elsewhere.
struct Passage {
  Robot robot = panda();
  Scene scene = enclose(robot, bent_motion(), 3);
  TemporaryDirectory directory;
  SolveSettings settings;

  Passage() {
    settings.plan.walk = 0;
    settings.plan.timeout_s = 120;
    settings.plan.max_iterations = 1'000'000;
  }
  [[nodiscard]] Database open(const std::string& name) const {
    return Database::open(directory / name, make_signature(robot), OpenMode::create).value();
  }
  [[nodiscard]] Database learned() const {
    Database database = open("m.db");
    const std::vector<Path> paths = {bent_motion()};
    auto rows = learn_from_paths({robot, scene}, paths, of_kind("motions")).value();
    REQUIRE(rows.size() == 1);
    REQUIRE(database.insert(std::move(rows)));
    return database;
  }
  [[nodiscard]] Problem problem_at(double angle) const {
    const Path motion = turned(bent_motion(), angle);
    return {"turned", robot, "", turned(scene, angle), motion.front(), {motion.back()}, {}};
  }
  [[nodiscard]] SolveResult solve_with(Database* database, const Problem& problem) const {
    SolveResult result = require_solved(problem, database, settings);
    return result;
  }
};

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a passage that was learned alone is passed in fewer iterations elsewhere") {
    const Passage passage;
    Database memory = passage.learned();
    std::uint64_t with = 0, without = 0;
    for (const double angle : {-1.1, 0.7, 1.5}) {
      const Problem problem = passage.problem_at(angle);
      const SolveResult one = passage.solve_with(&memory, problem);
      CHECK(passage.solve_with(&memory, problem).plan.path == one.plan.path);
      with += one.plan.iterations;
      without += passage.solve_with(nullptr, problem).plan.iterations;
    }
    CHECK(with < without);
  }

  TEST_CASE("places are kept for the scene by queries that remember, and by no others") {
    Passage passage;
    Database memory = passage.learned();
    const Problem problem = passage.problem_at(-0.4);
    const SolveResult first = passage.solve_with(&memory, problem);
    const auto known = [&] {
      const auto cell = internal::StaticCell::find(problem.robot, problem.scene, {});
      REQUIRE(cell != nullptr);
      return cell->places().copy();
    };
    CHECK(known().empty());
    passage.settings.remember_after = 1'000'000'000;
    CHECK(passage.solve_with(&memory, problem).plan.path == first.plan.path);
    REQUIRE(known().size() == 1);
    REQUIRE(known().begin()->second.size() == 1);
    CHECK(std::abs(known().begin()->second.front() + 0.4f) < 0.03f);
  }

  TEST_CASE("a long search teaches its tight stretches") {
    Passage passage;
    Database database = passage.open("new.db");
    passage.settings.memory.kind = "motions";
    passage.settings.remember_after = 0;
    const SolveResult easy = passage.solve_with(
        &database,
        {"open", passage.robot, "", {}, bent_motion().front(), {bent_motion().back()}, {}});
    CHECK(!easy.remembered.is_queued);
    const SolveResult hard = passage.solve_with(&database, passage.problem_at(0));
    const auto work = hard.plan.iterations + hard.plan.states_checked;
    REQUIRE(database.flush());
    CHECK(hard.remembered.is_queued == (work >= 50'000));
    CHECK((database.size() > 0) == hard.remembered.is_queued);
    if (database.size() > 0) CHECK(database.get(0)->path().planning_states.has_value());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("motions that were dear to find are looked for before those of unknown cost") {
    const Passage passage;
    Database memory = passage.learned();
    Experience dear = require(memory.get(0));
    CHECK_FALSE(dear.path().planning_states.has_value());
    dear.path().planning_states = 1'000'000;
    dear.path().waypoints[dear.path().waypoints.size() / 2] += 1e-3f;  // another motion
    require(memory.insert({dear}));
    const Problem problem = passage.problem_at(0.3);
    const auto query = require(internal::make_query(problem, &memory, passage.settings));
    const auto resolved = require(internal::resolve_goals(query));
    internal::MotionMemory motions(resolved);
    std::vector<PlacedMotion> placed;
    CheckCounters counters;
    REQUIRE(motions.find_more(placed, counters));  // reads the rows
    REQUIRE(motions.find_more(placed, counters));  // looks for the first one
    const internal::MotionPlaces places = motions.take_found().places;
    REQUIRE(places.size() == 1);
    CHECK(places.begin()->first == internal::EncodedRow(dear).content());
  }
}

}  // namespace mneme::test
