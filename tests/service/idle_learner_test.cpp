// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/idle_learner.h"
#include "support/enclosed_arm.h"

#include <chrono>
#include <thread>

namespace mneme::test {
namespace {

using internal::IdleLearner;

/// A passage of an arm, and an empty memory.
struct Cell {
  Robot robot = panda();
  Path motion = bent_motion();
  Problem problem{.name = "passage",
                  .robot = robot,
                  .scene = enclose(robot, motion, 3),
                  .start = motion.front(),
                  .goals = {motion.back()}};
  TemporaryDirectory directory;
  std::shared_ptr<Database> database = std::make_shared<Database>(
      Database::open(directory / "m.db", make_signature(robot), OpenMode::create).value());
  SolveSettings settings;

  Cell() {
    settings.plan.timeout_s = 600;
    settings.plan.max_iterations = 300'000;
  }
};

/// A plan whose search was long.
PlanResult long_plan() {
  PlanResult plan;
  plan.status = PlanStatus::solved;
  plan.states_checked = 1'000'000;
  return plan;
}

/// True once `is_done` holds, within a minute.
template <class IsDone>
bool wait_until(const IsDone& is_done) {
  for (int i = 0; i < 6000 && !is_done(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return is_done();
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a problem whose search was long is studied while no request is at work") {
    Cell cell;
    IdleLearner learner(cell.database);
    PlanResult easy = long_plan();
    easy.states_checked = 1000;
    {
      const IdleLearner::Request request(&learner);
      learner.offer(cell.problem, cell.settings, easy);
      learner.offer(cell.problem, cell.settings, long_plan());
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      CHECK(cell.database->size() == 0);
    }
    REQUIRE(wait_until([&] { return learner.finished() == 1; }));
    CHECK(cell.database->size() > 0);
    CHECK(cell.database->queued_rows().waiting == 0);
  }

  TEST_CASE("a study ends when a request comes or the service stops") {
    Cell cell;
    cell.problem.goals = {{2.5, 1.5, 0, -0.5, 0, 2, 0}};
    cell.problem.scene = {};
    IdleLearner learner(cell.database);
    for (int i = 0; i < 20; ++i) learner.offer(cell.problem, cell.settings, long_plan());
    { const IdleLearner::Request request(&learner); }
    learner.stop();
    const auto finished = learner.finished();
    learner.offer(cell.problem, cell.settings, long_plan());
    { const IdleLearner::Request request(&learner); }
    CHECK(learner.finished() == finished);
  }
}

}  // namespace mneme::test
