// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task_page.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>

namespace mneme::app {
namespace {

Transform frame_of(const Sphere& sphere) { return {Eigen::Matrix3d::Identity(), sphere.center}; }
Transform frame_of(const Capsule& capsule) {
  return {Eigen::Matrix3d::Identity(), 0.5 * (capsule.a + capsule.b)};
}
template <class Posed>
Transform frame_of(const Posed& shape) {
  return shape.pose;
}

/// An object that some stage holds.
struct ShownObject {
  Link link;  ///< as the first stage that holds it has it
  std::vector<PlanTrace::Look> looks;
  std::string carrier;
  Transform X_LS;  ///< pose of its first_frame() in the carrying link
};

class TaskTracer {
 public:
  TaskTracer(const TaskResult& plan, const TaskMotion& motion, const RateLimits& limits,
             const SolveSettings& planned, const TrajectoryOptions& timing,
             const TraceSettings& settings)
      : plan_(plan),
        motion_(motion),
        limits_(limits),
        planned_(planned),
        timing_(timing),
        settings_(settings) {}

  Result<PlanTrace> trace() {
    std::vector<PlanTrace> stages;
    for (std::size_t i = 0; i < plan_.stages.size(); ++i) {
      stages.push_back(MNEME_TRY(trace_stage(i)));
      find_objects(plan_.stages[i], stages.back());
    }
    whole_ = stages.front();
    keep_bare_links();
    for (const auto& [key, object] : objects_) {
      const std::string& name = key;
      whole_.links.push_back(object.link);
      whole_.looks.push_back(object.looks);
      whole_.carriers.push_back(object.carrier);
      std::erase_if(whole_.scene.obstacles,
                    [&](const Obstacle& obstacle) { return obstacle.name == name; });
    }
    whole_.waypoints.clear();
    whole_.vertices.clear();
    for (std::size_t i = 0; i < stages.size(); ++i) add_stage(i, stages[i]);
    whole_.start = whole_.waypoints.front().poses;
    whole_.goals = {whole_.waypoints.back().poses};
    whole_.duration_s = motion_.trajectory.duration_s();
    return std::move(whole_);
  }

 private:
  [[nodiscard]] Result<PlanTrace> trace_stage(std::size_t i) const {
    const StageResult& stage = plan_.stages[i];
    SolveResult solved;
    solved.plan.status = PlanStatus::solved;
    solved.plan.path = stage.gripper ? stage.gripper->path : stage.path;
    solved.plan.states_checked = plan_.states_checked;
    solved.plan.motions_checked = plan_.motions_checked;
    solved.plan.iterations = plan_.iterations;
    solved.plan.nodes = plan_.nodes;
    solved.total_time_s = plan_.total_time_s;
    solved.planning_time_s = plan_.first_plan_time_s;
    solved.planner = "task, " + planned_.planner;
    solved.sampler = planned_.sampler;
    solved.seed = planned_.plan.seed;
    solved.isa = planned_.isa == Isa::automatic ? default_isa() : planned_.isa;
    solved.goals = {solved.plan.path.back()};
    TraceSettings settings = settings_;
    settings.waypoints = std::max(2, settings.waypoints / static_cast<int>(plan_.stages.size()));
    const auto& timed = motion_.stages[i];
    const Problem& world = world_of(stage);
    RateLimits limits = limits_;
    if (stage.gripper) {
      limits = MNEME_TRY(find_rate_limits(world.robot, timing_.settings, timing_.limits));
    }
    return make_trace(world, solved, nullptr, 0, settings, {timed ? &*timed : nullptr, &limits});
  }

  /// Robot and scene of what moves in the stage.
  static const Problem& world_of(const StageResult& stage) {
    return stage.gripper ? *stage.gripper->world : *stage.world;
  }

  void find_objects(const StageResult& stage, const PlanTrace& traced) {
    for (const ApproximatedObject& each : stage.world->robot.attached()) {
      const AttachedObject& object = each.object;
      if (objects_.contains(object.name)) continue;
      const auto link = std::ranges::find(traced.links, object.name, &Link::name);
      if (link == traced.links.end()) continue;
      const auto at = static_cast<std::size_t>(link - traced.links.begin());
      objects_[object.name] = {*link, traced.looks[at], object.link, first_frame(object.shapes)};
    }
  }

  /// The first shape's frame. An object of mesh files alone has no shapes while it is held: then
  /// the link's frame, which is also the frame of its surface once it is free.
  static Transform first_frame(const std::vector<Shape>& shapes) {
    if (shapes.empty()) return {};
    return std::visit([](const auto& shape) { return frame_of(shape); }, shapes.front());
  }

  void keep_bare_links() {
    for (std::size_t i = whole_.links.size(); i-- > 0;) {
      if (!objects_.contains(whole_.links[i].name)) continue;
      const auto at = static_cast<std::ptrdiff_t>(i);
      whole_.links.erase(whole_.links.begin() + at);
      whole_.looks.erase(whole_.looks.begin() + at);
      whole_.carriers.erase(whole_.carriers.begin() + at);
    }
  }

  /// The pose at which the object's link of the whole trace is where the object is.
  [[nodiscard]] static Transform object_pose(const std::string& name, const ShownObject& object,
                                             const Problem& world, const Configuration& q) {
    Transform X_WS;
    if (const Obstacle* free = world.scene.find(name); free != nullptr) {
      X_WS = first_frame(free->shapes);
    }
    for (const ApproximatedObject& each : world.robot.attached()) {
      if (each.object.name != name) continue;
      const auto link = static_cast<std::size_t>(*world.robot.find_link(each.object.link));
      X_WS = world.robot.link_poses(q)[link] * first_frame(each.object.shapes);
    }
    return X_WS * object.X_LS.inverse();
  }

  void add_stage(std::size_t i, const PlanTrace& traced) {
    if (traced.waypoints.size() < 2 && !whole_.waypoints.empty()) return;
    const StageResult& stage = plan_.stages[i];
    const Problem& world = world_of(stage);
    const auto index_of = [](const auto& list, const std::string& name) {
      const auto found =
          std::ranges::find_if(list, [&](const auto& each) { return each.name == name; });
      return found == list.end() ? -1 : static_cast<int>(found - list.begin());
    };
    for (const int vertex : traced.vertices) {
      whole_.vertices.push_back(vertex + static_cast<int>(whole_.waypoints.size()));
    }
    const double before = whole_.waypoints.empty() ? 0 : whole_.waypoints.back().travelled;
    for (PlanTrace::Waypoint waypoint : traced.waypoints) {
      PlanTrace::Poses poses;
      for (const Link& link : whole_.links) {
        const int at = index_of(traced.links, link.name);
        const auto object = objects_.find(link.name);
        poses.push_back(object != objects_.end()
                            ? object_pose(link.name, object->second, world, waypoint.q)
                            : waypoint.poses[static_cast<std::size_t>(at)]);
      }
      waypoint.poses = std::move(poses);
      if (stage.gripper) waypoint.q = stage.path.front();
      waypoint.travelled += before;
      waypoint.time_s += motion_.begins_s[i];
      if (waypoint.nearest_link >= 0) {
        const auto nearest = static_cast<std::size_t>(waypoint.nearest_link);
        waypoint.nearest_link = index_of(whole_.links, traced.links[nearest].name);
      }
      if (waypoint.nearest_obstacle >= 0) {
        const auto nearest = static_cast<std::size_t>(waypoint.nearest_obstacle);
        waypoint.nearest_obstacle =
            index_of(whole_.scene.obstacles, traced.scene.obstacles[nearest].name);
      }
      whole_.waypoints.push_back(std::move(waypoint));
    }
    whole_.path_length = whole_.waypoints.back().travelled;
  }

  const TaskResult& plan_;
  const TaskMotion& motion_;
  const RateLimits& limits_;
  const SolveSettings& planned_;
  const TrajectoryOptions& timing_;
  const TraceSettings& settings_;
  std::map<std::string, ShownObject> objects_;
  PlanTrace whole_;
};

}  // namespace

Result<PlanTrace> trace_task(const TaskResult& plan, const TaskMotion& motion,
                             const RateLimits& limits, const SolveSettings& planned,
                             const TrajectoryOptions& timing, const TraceSettings& settings) {
  return TaskTracer(plan, motion, limits, planned, timing, settings).trace();
}

}  // namespace mneme::app
