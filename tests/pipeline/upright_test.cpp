// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Arms that carry a cup over a table, from one random pose to another. MNEME_UPRIGHT_PROBLEMS says
// how many problems of each robot; the shares that are solved, and how fast, are told.
#include "goal/posed_robots.h"
#include "planning/small_worlds.h"

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
  Vec3 least, most;  ///< where the link may be
  Scene table;
};

Waiter panda_waiter() {
  const Vec3 at(0, 0, 0.105);
  return {"panda",
          {"panda_hand", Vec3::UnitX(), Vec3::UnitZ(), 0.2},
          {at - 0.04 * Vec3::UnitX(), at + 0.04 * Vec3::UnitX(), 0.03},
          {"panda_leftfinger", "panda_rightfinger"},
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
          {0.45, -0.6, 0.75},
          {0.95, 0.6, 1.3},
          {"table",
           {make_box("table", {0.45, -0.7, 0.6}, {1.2, 0.7, 0.65}),
            make_box("carton", {0.65, -0.1, 0.65}, {0.75, 0.1, 0.95})}}};
}

Robot with_cup(const Waiter& waiter) {
  AttachedObject cup{"cup", waiter.upright.link, {waiter.cup}, {}, waiter.fingers};
  const auto robot = attach(shipped_robot(waiter.robot), {cup});
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return *robot;
}

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
  Problem problem() {
    Problem problem{"upright", robot_, "", waiter_.table, next(), {next()}, {}};
    problem.constraints = {waiter_.upright};
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
  const auto limits = find_rate_limits(problem.robot, {});
  REQUIRE(limits.has_value());
  const auto trajectory = make_trajectory(problem, settings, path, *limits, timing);
  REQUIRE_MESSAGE(trajectory.has_value(), (trajectory ? "" : trajectory.error().message));
  double largest = 0;
  const auto points = trajectory->sample(timing.dt);
  REQUIRE(points.has_value());
  for (const Trajectory::Point& point : *points) {
    largest = std::max(largest, tilt(problem.robot, problem.constraints[0], point.position));
  }
  return largest;
}

int problem_count() {
  const char* count = std::getenv("MNEME_UPRIGHT_PROBLEMS");
  return count == nullptr ? 3 : std::atoi(count);
}

TEST_SUITE("flow") {
  TEST_CASE("cups are carried upright all the way") {
    for (const Waiter& waiter : {panda_waiter(), fetch_waiter()}) {
      Poses poses(waiter);
      int solved = 0, quick = 0;
      double longest_s = 0, largest = 0;
      const int count = problem_count();
      for (int i = 0; i < count; ++i) {
        const Problem problem = poses.problem();
        SolveSettings settings;
        settings.plan.timeout_s = 1e6;
        settings.plan.max_iterations = 5000;
        const auto result = solve(problem, nullptr, settings);
        REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
        if (!result->plan.is_solved()) continue;
        const Path& path = result->plan.path;
        ++solved;
        quick += result->total_time_s <= 1;
        longest_s = std::max(longest_s, result->total_time_s);
        largest = std::max(largest, largest_tilt(problem.robot, waiter.upright, path, 1e-3));
        CHECK(is_path_free(problem.robot, problem.scene, path, 0.01));
        largest = std::max(largest, tilt_of_trajectory(problem, settings, path));
      }
      MESSAGE(waiter.robot, ": ", solved, " of ", count, " solved, ", quick,
              " within 1 s, longest ", longest_s, " s, largest tilt ", largest, " rad");
      CHECK(3 * solved >= count);
      CHECK(largest <= waiter.upright.angle);
    }
  }
}

}  // namespace
}  // namespace mneme::test
