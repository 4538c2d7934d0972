// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"
#include "mneme/goal.h"
#include "mneme/live.h"

#include "base/as_index.h"
#include "geometry/solids.h"
#include "live/planner_files.h"
#include "problem/problem_input.h"
#include "report/trace.h"
#include "robot/kinematics.h"
#include "scene/scene_input.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>

namespace mneme {
namespace internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTries = 1000;
/// Links are fixed to each other if their relative pose changes by less, in metres and entries of
/// rotation matrices.
constexpr double kSame = 1e-9;

/// Returns the middle of all limits, from where the arm reaches to all sides.
Configuration middle_configuration(const Robot& robot) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    q.push_back((joint.lower + joint.upper) / 2);
  }
  return robot.normalized(q);
}

/// Returns the configuration that resting_problem() describes; the middle if none is free.
Configuration rest_of(const Robot& robot) {
  const Configuration middle = middle_configuration(robot);
  const auto checker = CollisionChecker::make(robot, {});
  if (!checker) return middle;
  for (const NamedState& state : robot.named_states()) {
    const auto q = robot.configuration_of(state.name);
    if (q && robot.is_configuration(*q) && checker->is_valid(std::span<const double>(*q)))
      return *q;
  }
  Rng rng(1);
  Configuration q = middle;
  for (int i = 0; i < kTries; ++i, q = random_configuration(robot, rng))
    if (checker->is_valid(std::span<const double>(q))) return q;
  return middle;
}

Json pose_json(const Transform& pose) {
  const Eigen::Quaterniond turn(pose.rotation);
  const Vec3& p = pose.translation;
  return {p.x(), p.y(), p.z(), turn.x(), turn.y(), turn.z(), turn.w()};
}

/// Poses of all links at two random configurations.
struct TwoPoses {
  std::vector<Transform> here, there;

  explicit TwoPoses(const Robot& robot) {
    Rng rng(1);
    here = robot.link_poses(random_configuration(robot, rng));
    there = robot.link_poses(random_configuration(robot, rng));
  }
  /// Returns the pose of `link` in the frame of `tip`; empty if they move relative to each other.
  [[nodiscard]] std::optional<Transform> fixed_pose(int tip, int link) const {
    const Transform a = here[as_index(tip)].inverse() * here[as_index(link)];
    const Transform b = there[as_index(tip)].inverse() * there[as_index(link)];
    const bool is_fixed =
        (a.translation - b.translation).norm() < kSame && (a.rotation - b.rotation).norm() < kSame;
    return is_fixed ? std::optional(a) : std::nullopt;
  }
};

/// Lists the links of the trace that are fixed to `tip`.
Json carried_with(const Robot& robot, int tip, const std::vector<Link>& links) {
  const TwoPoses poses(robot);
  Json carried = Json::array();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto pose = poses.fixed_pose(tip, *robot.find_link(links[i].name));
    if (pose) carried.push_back({{"link", i}, {"pose", pose_json(*pose)}});
  }
  return carried;
}

/// Lists for each link that has visual shapes only a link with collision shapes to which it is
/// fixed.
Json welds_json(const Robot& robot, const std::vector<Link>& links) {
  const TwoPoses poses(robot);
  Json welds = Json::array();
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (has_shapes(links[i])) continue;
    for (std::size_t k = 0; k < links.size(); ++k) {
      const auto pose =
          poses.fixed_pose(*robot.find_link(links[k].name), *robot.find_link(links[i].name));
      if (!has_shapes(links[k]) || !pose) continue;
      welds.push_back({{"link", i}, {"to", k}, {"pose", pose_json(*pose)}});
      break;
    }
  }
  return welds;
}

/// Returns the first goal of a link: the problem's pose goal, or the link's pose at the first goal
/// or the start.
Transform goal_of(const Problem& problem, const std::string& link, int index) {
  const auto found = std::ranges::find(problem.pose_goals, link, &PoseGoal::link);
  if (found != problem.pose_goals.end()) return found->pose;
  const Configuration& q = problem.goals.empty() ? problem.start : problem.goals.front();
  return problem.robot.link_poses(q)[as_index(index)];
}

Json tips_json(const Problem& problem, const PlanTrace& trace) {
  const Robot& robot = problem.robot;
  Json tips = Json::array();
  for (const std::string& name : find_tips(robot)) {
    const int index = *robot.find_link(name);
    tips.push_back({{"link", name},
                    {"pose", pose_json(goal_of(problem, name, index))},
                    {"carries", carried_with(robot, index, trace.links)}});
  }
  return tips;
}

bool has_compound(const Obstacle& obstacle) {
  return std::ranges::any_of(obstacle.shapes, is_compound);
}

/// Lists allowed contacts with the obstacles that the page's requests contain.
Json allow_json(Scene scene) {
  std::erase_if(scene.obstacles, has_compound);
  return allowed_json(scene);
}

/// Moves clouds, meshes and octrees of the scene, which requests do not contain, to the end.
/// Returns them.
Scene kept_of(Scene& scene) {
  auto& obstacles = scene.obstacles;
  const auto kept =
      std::stable_partition(obstacles.begin(), obstacles.end(), std::not_fn(has_compound));
  Scene result;
  result.obstacles.assign(kept, obstacles.end());
  return result;
}

/// The trace of a live page. As in a plan's scene, `kept` stands behind the other obstacles.
Result<Json> live_trace(const Problem& problem, const Scene& kept, bool has_memory,
                        const TraceSettings& settings) {
  const PlanTrace trace = MNEME_TRY(make_trace(problem, {}, nullptr, 0, settings));
  auto json = Json::parse(to_json(trace));
  json["live"] = {{"start", problem.start},
                  {"has_memory", has_memory},
                  {"scene", kept.obstacles.empty() ? Json() : Json(kLivePageScene)},
                  {"allow", allow_json(problem.scene)},
                  {"constraints", constraints_json(problem)},
                  {"start_velocity", problem.start_velocity},
                  {"tips", tips_json(problem, trace)},
                  {"welds", welds_json(problem.robot, trace.links)}};
  return json;
}

}  // namespace
}  // namespace internal

Problem resting_problem(const Robot& robot, const std::string& robot_path) {
  return {.name = robot.name(),
          .robot = robot,
          .robot_path = robot_path,
          .start = internal::rest_of(robot)};
}

Result<LivePage> make_live_page(Problem problem, bool has_memory, const TraceSettings& settings) {
  LivePage page;
  page.kept = internal::kept_of(problem.scene);
  const auto json = MNEME_TRY(internal::live_trace(problem, page.kept, has_memory, settings));
  page.html = MNEME_TRY(to_page(json.dump(), "the page of the service"));
  return page;
}

Result<std::string> make_offline_page(Problem problem, const PlannerModule& module,
                                      const TraceSettings& settings) {
  for (const ApproximatedObject& carried : problem.robot.attached()) {
    if (carried.object.meshes.empty()) continue;
    return fail(ErrorCode::unsupported,
                "attached object '" + carried.object.name +
                    "': a page that plans by itself reads no mesh; use boxes and cylinders");
  }
  const Scene kept = internal::kept_of(problem.scene);
  auto json = MNEME_TRY(internal::live_trace(problem, kept, false, settings));
  json["live"]["planner"] = internal::planner_json(problem);
  return internal::to_page_with(internal::planner_elements(module), json.dump(), problem.name);
}

}  // namespace mneme
