// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Arms that carry a cup over a table, from one random pose to another. MNEME_UPRIGHT_PROBLEMS says
// how many problems of each robot, MNEME_UPRIGHT_ITERATIONS after how many each is given up; the
// shares that are solved, and how fast, are told.
#include "mneme/learning.h"

#include "goal/posed_robots.h"
#include "planning/small_worlds.h"
#include "support/planar_memory.h"

#include <cstdlib>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

struct Waiter {
  std::string robot;
  OrientationConstraint upright;
  Capsule cup;  ///< in the frame of the link that is kept upright
  std::vector<std::string> fingers;
  Axis axis;         ///< of the link, that of the cup
  Vec3 least, most;  ///< where the link may be
  Scene table;
};

Waiter panda_waiter() {
  const Vec3 at(0, 0, 0.105);
  return {"panda",
          {"panda_hand", Vec3::UnitX(), Vec3::UnitZ(), 0.2},
          {at - 0.04 * Vec3::UnitX(), at + 0.04 * Vec3::UnitX(), 0.03},
          {"panda_leftfinger", "panda_rightfinger"},
          Axis::x,
          {0.25, -0.6, 0.1},
          {0.7, 0.6, 0.7},
          {"table",
           {make_box("table", {0.25, -0.7, -0.05}, {1, 0.7, 0}),
            make_box("carton", {0.45, -0.1, 0}, {0.55, 0.1, 0.3})}}};
}

Waiter fetch_waiter() {
  return {"fetch",
          {"gripper_link", Vec3::UnitZ(), Vec3::UnitZ(), 0.2},
          {{0, 0, -0.04}, {0, 0, 0.04}, 0.03},
          {"l_gripper_finger_link", "r_gripper_finger_link"},
          Axis::z,
          {0.45, -0.6, 0.75},
          {0.95, 0.6, 1.3},
          {"table",
           {make_box("table", {0.45, -0.7, 0.6}, {1.2, 0.7, 0.65}),
            make_box("carton", {0.65, -0.1, 0.65}, {0.75, 0.1, 0.95})}}};
}

Robot with_cup(const Waiter& waiter) {
  AttachedObject cup{"cup", waiter.upright.link, {waiter.cup}, {}, waiter.fingers};
  return require(attach(shipped_robot(waiter.robot), {cup}));
}

/// A goal that a random configuration reaches.
struct Asked {
  std::string name;
  bool is_pose = true;  ///< that of the cup; otherwise the configuration
  double turn = 0;      ///< that the cup may be turned about its axis
};

/// Random configurations, led upright: those that are free and over the table.
class Poses {
 public:
  explicit Poses(const Waiter& waiter)
      : waiter_(waiter),
        robot_(with_cup(waiter)),
        checker_(make_checker(robot_, waiter.table, {{}, 1e-3, Isa::automatic, {waiter.upright}})) {
  }

  Configuration next() {
    for (;;) {
      const Configuration random = random_configuration(robot_, rng_);
      std::vector<float> q(random.begin(), random.end());
      if (!checker_.project(q) || !checker_.is_valid(std::span<const float>(q))) continue;
      const Configuration found(q.begin(), q.end());
      const Vec3 at = pose_at(robot_, waiter_.upright.link, found).pose.translation;
      const bool is_over_table =
          (at - waiter_.least).minCoeff() > 0 && (waiter_.most - at).minCoeff() > 0;
      if (is_over_table) return found;
    }
  }
  Problem problem(const Asked& asked) {
    Problem problem{.name = "upright",
                    .robot = robot_,
                    .scene = waiter_.table,
                    .start = next(),
                    .goals = {next()}};
    problem.constraints = {waiter_.upright};
    if (!asked.is_pose) return problem;
    problem.pose_goals = {pose_at(robot_, waiter_.upright.link, problem.goals[0])};
    problem.pose_goals[0].axis = waiter_.axis;
    problem.pose_goals[0].turn = asked.turn;
    problem.goals.clear();
    return problem;
  }

 private:
  const Waiter& waiter_;
  Robot robot_;
  CollisionChecker checker_;
  Rng rng_{7};
};

/// The largest along the path whose corners are rounded.
double tilt_of_trajectory(const Problem& problem, const SolveSettings& settings, const Path& path) {
  const TrajectorySettings timing;
  const auto limits = require(find_rate_limits(problem.robot, {}));
  const auto trajectory = require(make_trajectory(problem, settings, path, limits, timing));
  double largest = 0;
  const auto points = require(trajectory.sample(timing.dt));
  for (const Trajectory::Point& point : points) {
    largest = std::max(largest, tilt(problem.robot, problem.constraints[0], point.position));
  }
  return largest;
}

int number_from(const char* variable, int otherwise) {
  const char* number = std::getenv(variable);
  return number == nullptr ? otherwise : std::atoi(number);
}

/// Carries cups, and says how many arrive.
int carry(const Waiter& waiter, const Asked& asked, int count) {
  Poses poses(waiter);
  int solved = 0, quick = 0;
  double longest_s = 0, largest = 0;
  for (int i = 0; i < count; ++i) {
    const Problem problem = poses.problem(asked);
    SolveSettings settings;
    settings.plan.timeout_s = 1e6;
    settings.plan.max_iterations =
        static_cast<std::uint64_t>(number_from("MNEME_UPRIGHT_ITERATIONS", 5000));
    const auto result = require(solve(problem, nullptr, settings));
    if (!result.plan.is_solved()) continue;
    const Path& path = result.plan.path;
    ++solved;
    quick += result.total_time_s <= 1;
    longest_s = std::max(longest_s, result.total_time_s);
    largest = std::max(largest, largest_tilt(problem.robot, waiter.upright, path, 1e-3));
    CHECK(is_path_free(problem.robot, problem.scene, path, 0.01));
    largest = std::max(largest, tilt_of_trajectory(problem, settings, path));
  }
  MESSAGE(waiter.robot, ", ", asked.name, ": ", solved, " of ", count, " solved, ", quick,
          " within 1 s, longest ", longest_s, " s, largest tilt ", largest, " rad");
  CHECK(largest <= waiter.upright.angle);
  return solved;
}

TEST_SUITE("flow") {
  TEST_CASE("cups are carried upright all the way") {
    const int count = number_from("MNEME_UPRIGHT_PROBLEMS", 3);
    for (const Waiter& waiter : {panda_waiter(), fetch_waiter()}) {
      for (const Asked& asked : {Asked{"configurations", false}, Asked{"poses"},
                                 Asked{"poses, turned any way", true, kPi}}) {
        CHECK(3 * carry(waiter, asked, count) >= count);
      }
    }
  }

  TEST_CASE("memory of whole paths keeps those under other constraints apart") {
    const Waiter waiter = fetch_waiter();
    Problem problem = Poses(waiter).problem({"configurations", false});
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", problem.robot.without_attached());
    SolveSettings settings;
    settings.memory.kind = "paths";
    settings.remember_after = 0;
    settings.replay = 0.5;
    settings.plan.max_iterations = 5000;
    const auto solve_again = [&] {
      SolveResult result = require_solved(problem, &database, settings);
      REQUIRE(database.flush());
      return result;
    };
    CHECK(solve_again().remembered.is_queued);
    CHECK(database.size() == 1);
    const SolveResult replayed = solve_again();
    CHECK(replayed.replay.is_hit());
    CHECK(largest_tilt(problem.robot, waiter.upright, replayed.plan.path, 1e-3) <= 0.2);
    problem.constraints[0].angle = 0.25;
    CHECK_FALSE(solve_again().replay.is_hit());
    problem.constraints.clear();
    const SolveResult free = solve_again();
    CHECK_FALSE(free.replay.is_hit());
    CHECK_FALSE(free.replay.nearest.has_value());
    const Replay again = solve_again().replay;
    CHECK((again.is_hit() || again.cheap_row.has_value()));
  }

  TEST_CASE("problems teach paths that keep their constraints") {
    const Waiter waiter = fetch_waiter();
    const Problem problem = Poses(waiter).problem({"configurations", false});
    ProblemLesson lesson;
    lesson.paths = 3;
    const auto repeated = require(solve_repeatedly(problem, lesson));
    CHECK(!repeated.paths.empty());
    for (const Path& path : repeated.paths) {
      CHECK(largest_tilt(problem.robot, waiter.upright, path, 1e-3) <= waiter.upright.angle);
    }
  }

  TEST_CASE("memory that knows no constraints says so and learns nothing from what keeps them") {
    const Waiter waiter = fetch_waiter();
    const Problem problem = Poses(waiter).problem({"configurations", false});
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", problem.robot.without_attached());
    SolveSettings settings;
    settings.memory.kind = "body_pairs";
    settings.remember_after = 0;
    require_solved(problem, &database, settings);
    REQUIRE(database.flush());
    CHECK(database.size() == 0);
    CHECK(database.queued_rows().lost == 1);
    CHECK(contains(database.queued_rows().failure, "'body_pairs' does not support constraints"));
  }
}

}  // namespace
}  // namespace mneme::test
