// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/goal.h"
#include "mneme/instances.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "cell/blocked_link.h"
#include "cell/task_frame.h"

#include <algorithm>
#include <cmath>

namespace mneme {
namespace internal {
namespace {

/// Distance and size of obstacles that count as grasped, metres.
constexpr double kGraspDistance = 0.1, kGraspSize = 0.3;
/// Distances of tried middles from the goal: along x, y and z, metres, and yaw, radians.
constexpr CellTask kSearched = {0.25, 0.2, 0.05, 1.0};
/// Tasks by which middles are rated: some at corners, the rest random.
constexpr int kRatedTasks = 40, kRatedCorners = 16;
constexpr double kRatedClearance = 0.02;

/// Direction of the x axis of the largest box, as an angle about z.
double heading_of(const Scene& scene) {
  double largest = 0, heading = 0;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      const auto* box = std::get_if<Box>(&shape);
      if (box == nullptr || box->half_extents.prod() <= largest) continue;
      largest = box->half_extents.prod();
      heading = std::atan2(box->pose.rotation(1, 0), box->pose.rotation(0, 0));
    }
  }
  return heading;
}

void remove_grasped(const Vec3& pivot, Scene& scene) {
  std::erase_if(scene.obstacles, [&](const Obstacle& obstacle) {
    return std::ranges::any_of(obstacle.shapes, [&](const Shape& shape) {
      return 2 * bounding_sphere(shape).radius < kGraspSize &&
             distance(pivot, shape) < kGraspDistance;
    });
  });
}

/// Rates middles of a region.
class MiddleRater {
 public:
  MiddleRater(const CellRegion& region, const CollisionChecker& checker,
              const InverseKinematics& kinematics, std::uint64_t seed)
      : region_(region), checker_(checker), kinematics_(kinematics), seed_(seed) {}

  /// Number of tasks that can be reached clear; fewer than `least` may be too few.
  [[nodiscard]] int rate(const Transform& middle, int least) const {
    CellRegion region = region_;
    region.problem.pose_goals.front().pose = middle;
    const TaskFrame frame(region);
    const BlockedLink blocked(region, frame);
    Rng rng(seed_);
    int reached = 0;
    for (int i = 0; i < kRatedTasks && reached + kRatedTasks - i > least; ++i) {
      const CellTask task = frame.whole().sample(frame.varying(), rng, i < kRatedCorners);
      if (blocked.look_around({task, {}}, 0).blocked) continue;
      PoseGoal goal;
      goal.link = region.middle().link;
      goal.pose = frame.pose(task);
      IkSettings settings;
      settings.seeds = 256;
      settings.solutions = 1;
      settings.seed = seed_;
      const IkResult found =
          kinematics_.solve(goal, region.problem.start, settings, &checker_, kRatedClearance);
      reached += found.solutions.empty() ? 0 : 1;
    }
    return reached;
  }

 private:
  const CellRegion& region_;
  const CollisionChecker& checker_;
  const InverseKinematics& kinematics_;
  std::uint64_t seed_;
};

/// Returns a pose near the middle, by the region's own geometry.
Transform random_middle(const CellRegion& region, Rng& rng) {
  CellRegion wide = region;
  wide.half_extents = kSearched;
  CellTask task;
  for (std::size_t k = 0; k < kTaskSize; ++k) task[k] = kSearched[k] * rng.uniform(-1, 1);
  return TaskFrame(wide).pose(task);
}

}  // namespace
}  // namespace internal

Result<CellRegion> make_region(const Problem& problem, const RegionSettings& settings) {
  CellRegion region{problem, {{"start", problem.start}}, settings.half_extents, {}, settings.pivot,
                    {}};
  const auto link = problem.robot.find_link(settings.link);
  if (!link) {
    return fail(ErrorCode::invalid, "expected a link of robot {}, got \"{}\"", problem.robot.name(),
                settings.link);
  }
  if (!problem.goals.empty()) {
    PoseGoal goal;
    goal.link = settings.link;
    goal.pose = problem.robot.link_poses(problem.goals.front())[internal::as_index(*link)];
    region.problem.pose_goals = {goal};
    region.problem.goals.clear();
  } else if (problem.pose_goals.front().link != settings.link) {
    return fail(ErrorCode::invalid, "expected a goal for link {}, got one for {}", settings.link,
                problem.pose_goals.front().link);
  }
  Scene& scene = region.problem.scene;
  region.axes = rotation_about(Vec3::UnitZ(), internal::heading_of(scene));
  internal::remove_grasped(region.middle().pose * settings.pivot, scene);
  const auto checker = MNEME_TRY(CollisionChecker::make(problem.robot, scene));
  const auto kinematics = MNEME_TRY(InverseKinematics::make(problem.robot, settings.link));
  const internal::MiddleRater rater(region, checker, kinematics, settings.seed);
  Rng rng(settings.seed);
  Transform best = region.middle().pose;
  int most = settings.tries > 1 ? rater.rate(best, 0) : 0;
  for (int i = 1; i < settings.tries; ++i) {
    const Transform middle = internal::random_middle(region, rng);
    const int rating = rater.rate(middle, most);
    if (rating <= most) continue;
    most = rating;
    best = middle;
  }
  region.problem.pose_goals.front().pose = best;
  return region;
}

}  // namespace mneme
