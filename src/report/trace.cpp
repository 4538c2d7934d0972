// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/trace.h"

#include "mneme/report.h"

#include "check/link_distances.h"
#include "report/picture.h"
#include "robot/link_shapes.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Radians of L2 joint distance between the points of an edge, and the most of them.
constexpr double kEdgeStep = 0.35;
constexpr int kMostEdgeSteps = 6;

std::vector<int> links_with_shapes(const Robot& robot) {
  std::vector<int> links;
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const Link& link = robot.links()[i];
    if (has_shapes(link)) links.push_back(static_cast<int>(i));
  }
  return links;
}

Configuration along(const Robot& robot, std::span<const double> from, std::span<const double> to,
                    double fraction) {
  Configuration q(from.begin(), from.end());
  const Configuration delta = robot.difference(from, to);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] += fraction * delta[i];
  return q;
}

class Tracer {
 public:
  Tracer(const Problem& problem, const TraceSettings& settings, PlanTrace& trace)
      : robot_(problem.robot),
        settings_(settings),
        trace_(trace),
        link_indices_(links_with_shapes(robot_)),
        skeleton_(robot_),
        links_(robot_),
        obstacles_(obstacle_shapes(robot_, problem.scene)) {
    for (const int i : link_indices_)
      trace_.links.push_back(robot_.links()[static_cast<std::size_t>(i)]);
    for (int i = 0; i < robot_.joint_count(); ++i)
      trace_.joints.push_back(robot_.group_joint(i).name);
  }

  [[nodiscard]] PlanTrace::Poses poses_at(std::span<const double> q) const {
    return chosen(robot_.link_poses(q));
  }

  /// Equal steps along the path, and its own configurations between them.
  void add_path(const Path& path) {
    if (path.empty()) return;
    const double step = path_length(robot_, path) / std::max(1, settings_.waypoints);
    double travelled = 0;
    add_waypoint(path.front(), travelled, true);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const double length = robot_.distance(path[i - 1], path[i]);
      const int count = step > 0 ? std::max(1, static_cast<int>(std::ceil(length / step))) : 1;
      for (int k = 1; k <= count; ++k) {
        const double fraction = static_cast<double>(k) / count;
        const bool is_vertex = k == count;
        add_waypoint(is_vertex ? path[i] : along(robot_, path[i - 1], path[i], fraction),
                     travelled + fraction * length, is_vertex);
      }
      travelled += length;
    }
  }

  void add_memory(const GlSampler& gl) {
    for (const PrimitiveRetrieval& retrieval : gl.primitives) {
      PlanTrace::Primitive& primitive = trace_.primitives.emplace_back();
      primitive.primitive = retrieval.primitive;
      primitive.is_learned = retrieval.is_learned;
      for (const Match& match : retrieval.matches) {
        primitive.similarity_errors.push_back(match.similarity_error);
        primitive.components += match.experience->sampler.component_count();
      }
    }
    if (gl.mixture == nullptr) return;
    const GaussianMixture& mixture = *gl.mixture;
    trace_.component_count = mixture.component_count();
    const auto joints = static_cast<std::size_t>(mixture.joint_count);
    for (const int component : choose_components(mixture, settings_.components)) {
      const auto i = static_cast<std::size_t>(component);
      const auto mean = std::span(mixture.means).subspan(i * joints, joints);
      trace_.components.push_back(arm_of(mixture.origins.empty() ? 0 : mixture.origins[i], mean));
    }
  }

  void add_search(const PlanRecorder& recorder) {
    for (const auto* samples : {&recorder.uniform_samples(), &recorder.memory_samples()}) {
      for (const PlanRecorder::Sample& sample : samples->entries())
        trace_.samples.push_back(arm_of(sample.origin, sample.q));
    }
    for (const auto& [origin, count] : recorder.draws()) {
      const auto i = static_cast<std::size_t>(origin);
      if (origin == kUniformOrigin) {
        trace_.uniform_draws = count;
      } else if (i < trace_.primitives.size()) {
        trace_.primitives[i].draws = count;
      }
    }
    for (const PlanRecorder::Edge& edge : recorder.edges().entries()) add_edge(edge);
    trace_.edge_count = recorder.edges().seen();
  }

 private:
  [[nodiscard]] PlanTrace::Poses chosen(const std::vector<Transform>& poses) const {
    PlanTrace::Poses chosen;
    for (const int i : link_indices_) chosen.push_back(poses[static_cast<std::size_t>(i)]);
    return chosen;
  }

  void add_waypoint(const Configuration& q, double travelled, bool is_vertex) {
    if (is_vertex) trace_.vertices.push_back(static_cast<int>(trace_.waypoints.size()));
    const std::vector<Transform> poses = robot_.link_poses(q);
    const Clearance clearance = find_clearance(links_, links_.posed(poses), obstacles_);
    PlanTrace::Waypoint& waypoint = trace_.waypoints.emplace_back();
    waypoint.q = q;
    waypoint.poses = chosen(poses);
    waypoint.travelled = travelled;
    waypoint.clearance = clearance.distance;
    const auto found = std::ranges::find(link_indices_, clearance.link);
    if (found != link_indices_.end())
      waypoint.nearest_link = static_cast<int>(found - link_indices_.begin());
    waypoint.nearest_obstacle = clearance.obstacle;
    waypoint.tip = skeleton_.tip(poses);
  }

  [[nodiscard]] PlanTrace::Arm arm_of(Origin origin, std::span<const float> q) const {
    return {origin, skeleton_.points(Configuration(q.begin(), q.end()))};
  }

  void add_edge(const PlanRecorder::Edge& edge) {
    const Configuration from(edge.from.begin(), edge.from.end());
    const Configuration to(edge.to.begin(), edge.to.end());
    const double length = robot_.distance(from, to);
    const int steps =
        std::clamp(static_cast<int>(std::ceil(length / kEdgeStep)), 1, kMostEdgeSteps);
    PlanTrace::Edge& traced = trace_.edges.emplace_back();
    traced.graph = edge.graph;
    for (int k = 0; k <= steps; ++k) {
      const Configuration q = along(robot_, from, to, static_cast<double>(k) / steps);
      traced.tips.push_back(skeleton_.tip(robot_.link_poses(q)));
    }
  }

  const Robot& robot_;
  const TraceSettings& settings_;
  PlanTrace& trace_;
  std::vector<int> link_indices_;
  Skeleton skeleton_;
  LinkDistances links_;
  std::vector<ObstacleShape> obstacles_;
};

/// Why something has no pose, or nothing: limits do not matter here.
std::optional<std::string> unusable(const Robot& robot, std::span<const double> q,
                                    const std::string& what) {
  if (static_cast<int>(q.size()) != robot.joint_count()) {
    return what + " has " + std::to_string(q.size()) + " values, expected " +
           std::to_string(robot.joint_count());
  }
  const bool is_finite = std::ranges::all_of(q, [](double value) { return std::isfinite(value); });
  return is_finite ? std::nullopt : std::optional(what + " holds a value that is not finite");
}

Result<void> check_fit(const Problem& problem, const SolveResult& result) {
  const Robot& robot = problem.robot;
  std::optional<std::string> flaw = unusable(robot, problem.start, "start");
  for (const Configuration& goal : problem.goals)
    if (!flaw) flaw = unusable(robot, goal, "goal");
  for (const Configuration& q : result.plan.path)
    if (!flaw) flaw = unusable(robot, q, "a configuration of the path");
  if (!flaw && result.gl.mixture != nullptr && result.gl.mixture->component_count() > 0 &&
      result.gl.mixture->joint_count != robot.joint_count()) {
    flaw = "the memory is of another robot";
  }
  const auto obstacle_count = static_cast<int>(problem.scene.obstacles.size());
  for (const PrimitiveRetrieval& retrieval : result.gl.primitives) {
    for (const int i : retrieval.primitive.obstacles)
      if (!flaw && (i < 0 || i >= obstacle_count)) flaw = "a primitive is of another scene";
  }
  if (flaw) return fail(ErrorCode::invalid, "cannot trace the plan: " + *flaw);
  return {};
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {

PlanRecorder::PlanRecorder(const TraceSettings& settings)
    : uniform_(settings.samples), memory_(settings.samples), edges_(settings.edges) {}

void PlanRecorder::on_sample(std::span<const float> q, Origin origin) {
  ++draws_[origin];
  Thinned<Sample>& samples = origin == kUniformOrigin ? uniform_ : memory_;
  if (samples.counts_next()) samples.add({origin, {q.begin(), q.end()}});
}

void PlanRecorder::on_edge(std::span<const float> from, std::span<const float> to, int graph) {
  if (edges_.counts_next()) {
    edges_.add({graph, {from.begin(), from.end()}, {to.begin(), to.end()}});
  }
}

Result<PlanTrace> make_trace(const Problem& problem, const SolveResult& result,
                             const PlanRecorder* recorder, double load_time_s,
                             const TraceSettings& settings) {
  if (auto checked = internal::check_fit(problem, result); !checked)
    return tl::unexpected(checked.error());
  PlanTrace trace;
  trace.problem = problem.name;
  trace.robot = problem.robot.name();
  trace.is_planar = problem.robot.is_planar();
  trace.scene = problem.scene;
  trace.load_time_s = load_time_s;
  trace.path_length = path_length(problem.robot, result.plan.path);
  trace.result = result;
  trace.result.gl.primitives.clear();
  trace.result.gl.mixture = nullptr;
  internal::Tracer tracer(problem, settings, trace);
  trace.start = tracer.poses_at(problem.start);
  // Those that poses were resolved to count, too.
  for (const Configuration& goal : result.goals.empty() ? problem.goals : result.goals) {
    trace.goals.push_back(tracer.poses_at(goal));
  }
  tracer.add_path(result.plan.path);
  tracer.add_memory(result.gl);
  if (recorder != nullptr) tracer.add_search(*recorder);
  return trace;
}

}  // namespace mneme
