// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/trace.h"

#include "mneme/report.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "check/link_distances.h"
#include "mesh/mesh_file.h"
#include "report/picture.h"
#include "robot/kinematics.h"
#include "report/visuals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

/// L2 joint distance between the points of an edge, and the largest number of steps.
constexpr double kEdgeStep = 0.35;
constexpr int kMostEdgeSteps = 6;

using Looks = std::map<std::string, std::vector<PlanTrace::Look>>;

/// Returns visual shapes by the name of the link or attached object.
Looks find_looks(const Problem& problem, const TraceSettings& settings) {
  Looks looks;
  if (!problem.robot_path.empty() && !problem.robot.is_planar()) {
    for (Visual& visual : read_visuals(problem.robot_path, settings.package_paths))
      looks[visual.link].push_back({std::move(visual.shape), std::move(visual.color)});
  }
  for (const ApproximatedObject& carried : problem.robot.attached()) {
    std::vector<PlanTrace::Look>& seen = looks[carried.object.name];
    for (const Shape& shape : carried.object.shapes) seen.push_back({shape, ""});
    for (const MeshFile& file : carried.object.meshes) {
      auto triangles = read_triangles(file.path, file.scale, file.pose);
      if (!triangles) continue;
      auto parts = std::make_shared<Parts<Triangle>>(*std::move(triangles));
      seen.push_back({Mesh{{}, std::move(parts), 0}, ""});
    }
  }
  return looks;
}

/// Returns the links with collision or visual shapes.
std::vector<int> seen_links(const Robot& robot, const Looks& looks) {
  std::vector<int> links;
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const Link& link = robot.links()[i];
    if (has_shapes(link) || looks.contains(link.name)) links.push_back(static_cast<int>(i));
  }
  return links;
}

PlanTrace::Limits limits_of(const Robot& robot, const RateLimits* rates) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  PlanTrace::Limits limits;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    const bool is_limited = joint.type != JointType::continuous;
    limits.lower.push_back(is_limited ? joint.lower : -kNone);
    limits.upper.push_back(is_limited ? joint.upper : kNone);
    limits.velocity.push_back(joint.velocity);
    limits.acceleration.push_back(joint.acceleration.value_or(kNone));
  }
  if (rates != nullptr) {
    limits.velocity = rates->velocity;
    limits.acceleration = rates->acceleration;
  }
  return limits;
}

class Tracer {
 public:
  Tracer(const Problem& problem, const Scene& scene, const TraceSettings& settings, Looks looks,
         PlanTrace& trace)
      : robot_(problem.robot),
        settings_(settings),
        trace_(trace),
        link_indices_(seen_links(robot_, looks)),
        skeleton_(robot_),
        links_(robot_),
        obstacles_(obstacle_shapes(robot_, scene)) {
    for (const int i : link_indices_) {
      const Link& link = robot_.links()[as_index(i)];
      trace_.links.push_back(link);
      trace_.looks.push_back(std::move(looks[link.name]));
      const auto carried = std::ranges::find(
          robot_.attached(), link.name, [](const ApproximatedObject& object) -> const std::string& {
            return object.object.name;
          });
      trace_.carriers.push_back(carried == robot_.attached().end() ? "" : carried->object.link);
    }
    trace_.joints = robot_.joint_names();
  }

  [[nodiscard]] PlanTrace::Poses poses_at(std::span<const double> q) const {
    return chosen(robot_.link_poses(q));
  }

  /// Adds waypoints at equal steps, and the path's own configurations.
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
        add_waypoint(is_vertex ? path[i] : interpolate(robot_, path[i - 1], path[i], fraction),
                     travelled + fraction * length, is_vertex);
      }
      travelled += length;
    }
  }

  /// Adds waypoints at equal times. The vertices are the waypoints nearest to the path's
  /// configurations.
  void add_trajectory(const Trajectory& trajectory, const Path& path) {
    const int steps = std::max(1, settings_.waypoints);
    trace_.duration_s = trajectory.duration_s();
    double travelled = 0;
    for (int i = 0; i <= steps; ++i) {
      const Trajectory::Point point = trajectory.at(trace_.duration_s * i / steps);
      if (i > 0) travelled += robot_.distance(trace_.waypoints.back().q, point.position);
      PlanTrace::Waypoint& waypoint = add_waypoint(point.position, travelled, false);
      waypoint.time_s = point.time_s;
      waypoint.velocity = point.velocity;
      waypoint.acceleration = point.acceleration;
    }
    std::size_t from = 0;
    for (const Configuration& q : path) {
      const auto rest = std::span(trace_.waypoints).subspan(from);
      const auto nearest = std::ranges::min_element(
          rest, {}, [&](const PlanTrace::Waypoint& w) { return robot_.distance(w.q, q); });
      from += static_cast<std::size_t>(nearest - rest.begin());
      trace_.vertices.push_back(static_cast<int>(from));
    }
  }

  /// Adds the contacts at `q`: the start if `goal` is -1.
  void add_touches(const Scene& scene, const Configuration& q, int goal) {
    const PosedLinks posed = links_.posed(robot_.link_poses(q));
    for (const Contact& contact : find_contacts(robot_, links_, scene, q, 0)) {
      PlanTrace::Touch& touch = trace_.touches.emplace_back();
      touch.goal = goal;
      touch.link = index_of(contact.link);
      touch.is_self = contact.is_self;
      touch.distance = contact.distance;
      const auto other = std::ranges::find(scene.obstacles, contact.other, &Obstacle::name);
      touch.other = contact.is_self ? index_of(contact.other)
                                    : static_cast<int>(other - scene.obstacles.begin());
      touch.place = place_of(contact, posed.poses);
    }
  }

  void add_memory(const GlSampler& gl) {
    for (const PrimitiveRetrieval& retrieval : gl.primitives) {
      PlanTrace::Primitive& primitive = trace_.primitives.emplace_back();
      primitive.primitive = retrieval.primitive;
      primitive.is_learned = retrieval.is_learned;
      for (const Match& match : retrieval.matches) {
        primitive.similarity_errors.push_back(match.similarity_error);
        primitive.components += match.experience->component_count();
      }
    }
    if (gl.mixture == nullptr) return;
    const GaussianMixture& mixture = *gl.mixture;
    trace_.component_count = mixture.component_count();
    const auto joints = static_cast<std::size_t>(mixture.joint_count);
    for (const int component : choose_components(mixture, settings_.components)) {
      const std::size_t i = as_index(component);
      const auto mean = std::span(mixture.means).subspan(i * joints, joints);
      trace_.components.push_back(arm_of(mixture.sources.empty() ? 0 : mixture.sources[i], mean));
    }
  }

  void add_search(const PlanRecorder& recorder) {
    for (const auto* samples : {&recorder.uniform_samples(), &recorder.memory_samples()}) {
      for (const PlanRecorder::Sample& sample : samples->entries())
        trace_.samples.push_back(arm_of(sample.source, sample.q));
    }
    for (const auto& [source, count] : recorder.sample_counts()) {
      const auto i = static_cast<std::size_t>(source);
      if (source == kUniformSource) {
        trace_.uniform_count = count;
      } else if (i < trace_.primitives.size()) {
        trace_.primitives[i].sample_count = count;
      }
    }
    for (const PlanRecorder::Edge& edge : recorder.edges().entries()) add_edge(edge);
    trace_.edge_count = recorder.edges().seen();
  }

 private:
  [[nodiscard]] PlanTrace::Poses chosen(const std::vector<Transform>& poses) const {
    PlanTrace::Poses chosen;
    for (const int i : link_indices_) chosen.push_back(poses[as_index(i)]);
    return chosen;
  }

  /// Returns the index into the trace's links, or -1.
  [[nodiscard]] int index_of(const std::string& link) const {
    const auto found = std::ranges::find(trace_.links, link, &Link::name);
    return found == trace_.links.end() ? -1 : static_cast<int>(found - trace_.links.begin());
  }

  /// Returns the middle of the link's shape that is nearest to, or deepest in, the other body.
  [[nodiscard]] Vec3 place_of(const Contact& contact, std::span<const Transform> poses) const {
    const auto posed = [&](const std::string& name) {
      const std::size_t i = as_index(*robot_.find_link(name));
      return shapes_of(robot_.links()[i], poses[i]);
    };
    const std::vector<Capsule> others =
        contact.is_self ? posed(contact.other) : std::vector<Capsule>();
    const auto gap = [&](const Capsule& c) {
      double least = std::numeric_limits<double>::infinity();
      for (const Capsule& o : others)
        least = std::min(least, segment_distance(c.a, c.b, o.a, o.b) - o.radius);
      for (const ObstacleShape& o : obstacles_) {
        if (contact.is_self || scene_name(o) != contact.other) continue;
        least = std::min(least, distance_to_segment(c.a, c.b, *o.shape));
      }
      return least - c.radius;
    };
    const std::vector<Capsule> shapes = posed(contact.link);
    const auto nearest = std::ranges::min_element(shapes, {}, gap);
    return nearest == shapes.end() ? Vec3::Zero() : Vec3((nearest->a + nearest->b) / 2);
  }

  [[nodiscard]] const std::string& scene_name(const ObstacleShape& shape) const {
    return trace_.scene.obstacles[as_index(shape.obstacle)].name;
  }

  PlanTrace::Waypoint& add_waypoint(const Configuration& q, double travelled, bool is_vertex) {
    poll_interrupt();
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
    return waypoint;
  }

  [[nodiscard]] PlanTrace::Arm arm_of(SampleSource source, std::span<const float> q) const {
    return {source, skeleton_.points(Configuration(q.begin(), q.end()))};
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
      const Configuration q = interpolate(robot_, from, to, static_cast<double>(k) / steps);
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

Result<void> check_fit(const Problem& problem, const SolveResult& result) {
  std::optional<std::string> flaw = find_misfit(problem, result.plan.path, &result.gl);
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

void PlanRecorder::on_sample(std::span<const float> q, SampleSource source) {
  ++sample_counts_[source];
  Thinned<Sample>& samples = source == kUniformSource ? uniform_ : memory_;
  if (samples.counts_next()) samples.add({source, {q.begin(), q.end()}});
}

void PlanRecorder::on_edge(std::span<const float> from, std::span<const float> to, int graph) {
  if (edges_.counts_next()) {
    edges_.add({graph, {from.begin(), from.end()}, {to.begin(), to.end()}});
  }
}

Result<PlanTrace> make_trace(const Problem& problem, const SolveResult& result,
                             const PlanRecorder* recorder, double load_time_s,
                             const TraceSettings& settings, const TimedPlan& timed) {
  MNEME_TRY(internal::check_fit(problem, result));
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
  trace.limits = internal::limits_of(problem.robot, timed.limits);
  internal::Tracer tracer(problem, checked_scene(problem, result), settings,
                          internal::find_looks(problem, settings), trace);
  trace.start = tracer.poses_at(problem.start);
  // Pose goals appear as the configurations that inverse kinematics found.
  const auto& goals = result.goals.empty() ? problem.goals : result.goals;
  for (const Configuration& goal : goals) trace.goals.push_back(tracer.poses_at(goal));
  if (result.plan.status == PlanStatus::invalid_start)
    tracer.add_touches(problem.scene, problem.start, -1);
  if (result.plan.status == PlanStatus::invalid_goal) {
    for (std::size_t i = 0; i < goals.size(); ++i)
      tracer.add_touches(problem.scene, goals[i], static_cast<int>(i));
  }
  if (timed.trajectory != nullptr && !result.plan.path.empty()) {
    tracer.add_trajectory(*timed.trajectory, result.plan.path);
  } else {
    tracer.add_path(result.plan.path);
  }
  tracer.add_memory(result.gl);
  if (recorder != nullptr) tracer.add_search(*recorder);
  return trace;
}

Result<std::string> plan_and_trace(const Problem& problem, Database* database,
                                   SolveSettings settings, const TraceSettings& shown) {
  PlanRecorder recorder(shown);
  settings.plan.observer = &recorder;
  settings.remember_after.reset();
  settings.replay = 0;
  settings.learn_budget_s = 0;
  const SolveResult result = MNEME_TRY(solve(problem, database, settings));
  const PlanTrace trace = MNEME_TRY(make_trace(problem, result, &recorder, 0, shown));
  return to_json(trace);
}

}  // namespace mneme
