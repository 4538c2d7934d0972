// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "task/small_tasks.h"

namespace mneme::test {
namespace {

TEST_SUITE("flow") {
  /// A task, and a database in which its plan is remembered.
  class RememberedTask {
   public:
    RememberedTask()
        : task_(make_task(kCell + kPickAndPlace)),
          database_(*Database::open(directory_ / "tasks.db", make_signature(task_.robot),
                                    OpenMode::create)) {
      first_ = solved(task_, &database_, remembering());
      check_plan(task_, first_);
      require(database_.flush());
    }

    static TaskSettings remembering() {
      TaskSettings settings;
      settings.solve.remember_after = 0;
      return settings;
    }
    [[nodiscard]] const Task& task() const { return task_; }
    [[nodiscard]] const TaskResult& first() const { return first_; }
    [[nodiscard]] Database& database() { return database_; }

   private:
    TemporaryDirectory directory_;
    Task task_;
    Database database_;
    TaskResult first_;
  };

  TEST_CASE("choices that worked come first where the object is near") {
    RememberedTask remembered;
    CHECK(remembered.first().remembered_rows == 0);
    Task moved = remembered.task();
    Transform shift;
    shift.translation = {0.02, -0.03, 0};
    REQUIRE(moved.scene.move("cup", shift));
    const TaskResult without = solved(moved);
    const TaskResult again = solved(moved, &remembered.database());
    check_plan(moved, again);
    CHECK(again.remembered_rows == 1);
    CHECK(again.stages[1].alternative == remembered.first().stages[1].alternative);
    CHECK(again.stages[5].alternative == remembered.first().stages[5].alternative);
    CHECK(again.states_checked < without.states_checked);
  }

  TEST_CASE("choices of an object far away, or of another name, do not count") {
    RememberedTask remembered;
    Task far = remembered.task();
    Transform shift;
    shift.translation = {-0.1, 0.65, 0};
    REQUIRE(far.scene.move("cup", shift));
    CHECK(solved(far, &remembered.database()).remembered_rows == 0);
    std::string yaml = kCell + kPickAndPlace;
    for (std::size_t at = 0; (at = yaml.find("cup", at)) != std::string::npos;) {
      yaml.replace(at, 3, "jug");
    }
    CHECK(solved(make_task(yaml), &remembered.database()).remembered_rows == 0);
  }

  TEST_CASE("a remembered place that is taken since is checked and not used") {
    RememberedTask remembered;
    Task task = remembered.task();
    const auto place = static_cast<std::size_t>(remembered.first().stages[5].alternative);
    const Vec3 at = task.stages[5].poses.poses[place].translation;
    REQUIRE(task.scene.add(
        {"block", {Box{{Eigen::Matrix3d::Identity(), at}, Vec3(0.03, 0.03, 0.05)}}}));
    const TaskResult again = solved(task, &remembered.database());
    check_plan(task, again);
    CHECK(again.remembered_rows == 1);
    CHECK(again.stages[5].alternative != static_cast<int>(place));
  }

  TEST_CASE("a database with choices serves plans of paths") {
    RememberedTask remembered;
    const Task& task = remembered.task();
    Problem problem{.name = "home",
                    .robot = task.robot,
                    .scene = task.scene,
                    .start = task.start,
                    .goals = {task.start}};
    problem.goals.front()[0] = 0.5;
    require_solved(problem, &remembered.database(), {});
  }
}

}  // namespace
}  // namespace mneme::test
