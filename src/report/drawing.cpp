// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture.h"
#include "base/as_index.h"
#include "base/fail.h"
#include "robot/kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace mneme::internal {
namespace {

constexpr int kMostFanArms = 36;
constexpr double kFanStep = 0.3;  // L2 joint distance between neighbours of the fan
constexpr int kTraceStates = 241;
constexpr std::size_t kMostLongLabels = 3;
constexpr double kFrameMargin = 0.12;  // metres between a primitive's circles and its frame

/// Says why `q` does not fit the robot; empty if it does. Limits are not checked.
std::optional<std::string> misfit(const Robot& robot, const Configuration& q,
                                  std::string_view what) {
  if (static_cast<int>(q.size()) != robot.joint_count()) {
    return fmt::format("{} has {} values; robot {} has {} joints", what, q.size(), robot.name(),
                       robot.joint_count());
  }
  if (std::ranges::all_of(q, [](double value) { return std::isfinite(value); })) return {};
  return fmt::format("{} has a value that is not a finite number", what);
}

Result<void> check_keys(const GlSampler& gl) {
  for (const PrimitiveRetrieval& retrieval : gl.primitives) {
    if (retrieval.primitive.key.size() == 6) continue;
    return fail(ErrorCode::invalid,
                "picture: a primitive's key has {} numbers; expected 6, a pair of circles",
                retrieval.primitive.key.size());
  }
  return {};
}

/// Returns the rectangle along the line of centres that holds both circles of a key.
std::vector<Point> frame_around(const PrimitiveKey& key) {
  const Point a = {key[0], key[1]};
  const double length = std::hypot(key[3] - a.x, key[4] - a.y);
  const Point along =
      length > 0 ? Point{(key[3] - a.x) / length, (key[4] - a.y) / length} : Point{1, 0};
  const double first = std::min(-key[2], length - key[5]) - kFrameMargin;
  const double last = std::max(key[2], length + key[5]) + kFrameMargin;
  const double side = std::max(key[2], key[5]) + kFrameMargin;
  const auto corner = [&](double s, double t) {
    return Point{a.x + s * along.x - t * along.y, a.y + s * along.y + t * along.x};
  };
  return {corner(first, -side), corner(last, -side), corner(last, side), corner(first, side)};
}

std::string describe(const PrimitiveRetrieval& retrieval, bool is_brief) {
  const std::size_t count = retrieval.matches.size();
  if (count == 0) return retrieval.is_learned ? "learned now" : "no match";
  const std::string error = short_number(retrieval.matches.front().similarity_error, 3);
  if (is_brief) return fmt::format("{} \u00b7 {}", count, error);
  return fmt::format("{}{} match{}, error {}", retrieval.is_learned ? "learned now, " : "", count,
                     count == 1 ? "" : "es", error);
}

void add_memories(const PlanarPicture& picture, Drawing& drawing) {
  const bool is_brief = picture.gl->primitives.size() > kMostLongLabels;
  for (const PrimitiveRetrieval& retrieval : picture.gl->primitives) {
    const PrimitiveKey key = moved_key(retrieval.primitive.to_scene, retrieval.primitive.key);
    drawing.primitives.push_back({frame_around(key), describe(retrieval, is_brief)});
  }
  if (picture.gl->mixture == nullptr) return;
  const GaussianMixture& mixture = *picture.gl->mixture;
  for (const int component : choose_components(mixture, picture.max_arms)) {
    const auto first = mixture.means.begin() + component * mixture.joint_count;
    const Configuration mean(first, first + mixture.joint_count);
    drawing.memories.push_back({mixture.sources.empty() ? 0 : mixture.sources[as_index(component)],
                                arm_at(picture.problem->robot, mean)});
  }
}

void add_path(const PlanarPicture& picture, Drawing& drawing) {
  const Robot& robot = picture.problem->robot;
  const bool has_path = !picture.path.empty();
  drawing.start = arm_at(robot, has_path ? picture.path.front() : picture.problem->start);
  if (!has_path) {
    for (const Configuration& goal : picture.problem->goals) {
      drawing.goals.push_back(arm_at(robot, goal));
    }
    return;
  }
  drawing.goals.push_back(arm_at(robot, picture.path.back()));
  const double steps = path_length(robot, picture.path) / kFanStep;
  const int count = std::clamp(static_cast<int>(std::ceil(steps)) + 1, 2, kMostFanArms);
  const std::vector<Configuration> states = spread_along(robot, picture.path, count);
  for (std::size_t i = 1; i + 1 < states.size(); ++i) {
    drawing.fan.push_back(arm_at(robot, states[i]));
  }
  for (const Configuration& q : spread_along(robot, picture.path, kTraceStates)) {
    const Arm arm = arm_at(robot, q);
    if (!arm.empty()) drawing.tip_trace.push_back(arm.back().points.back());
  }
}

/// Returns an upper bound of the distance from the first joint to any point of the moving links.
double reach_of(const Robot& robot) {
  std::vector<double> offsets(robot.links().size(), 0);
  double reach = 0;
  for (const Joint& joint : robot.joints()) {
    const std::size_t link = as_index(joint.child_link);
    const double from_parent =
        offsets[as_index(joint.parent_link)] + joint.origin.translation.norm();
    offsets[link] = &joint == &robot.group_joint(0) ? 0 : from_parent;
    for (const Capsule& capsule : robot.links()[link].capsules) {
      const double extent = std::max(capsule.a.norm(), capsule.b.norm()) + capsule.radius;
      reach = std::max(reach, offsets[link] + extent);
    }
    for (const Sphere& sphere : robot.links()[link].spheres) {
      reach = std::max(reach, offsets[link] + sphere.center.norm() + sphere.radius);
    }
  }
  return reach;
}

constexpr double kJoined = 1e-6;  // metres

Point flat(const Vec3& p) { return {p.x(), p.y()}; }

void append_segment(const Point& a, const Point& b, double radius, Arm& arm) {
  const bool is_joined = !arm.empty() && std::hypot(arm.back().points.back().x - a.x,
                                                    arm.back().points.back().y - a.y) < kJoined;
  if (!is_joined) arm.push_back({{a}, radius});
  arm.back().points.push_back(b);
  arm.back().radius = std::max(arm.back().radius, radius);
}

}  // namespace

Result<Drawing> make_drawing(const PlanarPicture& picture) {
  assert(picture.problem != nullptr);
  const Problem& problem = *picture.problem;
  if (!problem.robot.is_planar()) {
    return fail(
        ErrorCode::unsupported,
        "picture: robot {} is not planar; expected joints that turn about z and links in the "
        "plane z = 0. --view shows any robot",
        problem.robot.name());
  }
  if (const auto flaw = find_misfit(problem, picture.path, picture.gl)) {
    return fail(ErrorCode::invalid, "picture: " + *flaw);
  }
  if (picture.gl != nullptr) MNEME_TRY(check_keys(*picture.gl));
  Drawing drawing;
  for (const Obstacle& obstacle : problem.scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      if (auto outline = planar_outline(shape)) drawing.obstacles.push_back(std::move(*outline));
    }
  }
  const auto poses = problem.robot.link_poses(problem.start);
  drawing.base = flat(poses[as_index(problem.robot.group_joint(0).child_link)].translation);
  drawing.reach = reach_of(problem.robot);
  if (picture.gl != nullptr) add_memories(picture, drawing);
  add_path(picture, drawing);
  return drawing;
}

std::optional<std::string> find_misfit(const Problem& problem, const Path& path,
                                       const GlSampler* gl) {
  const Robot& robot = problem.robot;
  if (auto flaw = misfit(robot, problem.start, "the start")) return flaw;
  for (const Configuration& goal : problem.goals) {
    if (auto flaw = misfit(robot, goal, "a goal")) return flaw;
  }
  for (const Configuration& waypoint : path) {
    if (auto flaw = misfit(robot, waypoint, "a waypoint")) return flaw;
  }
  const GaussianMixture* mixture = gl == nullptr ? nullptr : gl->mixture.get();
  const bool fits = mixture == nullptr || mixture->component_count() == 0 ||
                    mixture->joint_count == robot.joint_count();
  if (fits) return {};
  return fmt::format("the mixture has {} joints; robot {} has {}", mixture->joint_count,
                     robot.name(), robot.joint_count());
}

Bounds bounds_of(const Drawing& drawing) {
  Bounds bounds;
  bounds.include(drawing.base);
  const auto include = [&bounds](const Arm& arm) {
    for (const ArmLine& line : arm) bounds.include(line.points);
  };
  include(drawing.start);
  for (const Arm& goal : drawing.goals) include(goal);
  for (const Arm& arm : drawing.fan) include(arm);
  for (const RememberedArm& memory : drawing.memories) include(memory.arm);
  Bounds reachable;
  reachable.include(drawing.base, drawing.reach);
  const auto include_reachable = [&](const Bounds& all) {
    const Bounds seen = all.clipped(reachable);
    if (seen.is_empty()) return;
    bounds.include({seen.left, seen.bottom});
    bounds.include({seen.right, seen.top});
  };
  for (const Outline& outline : drawing.obstacles) include_reachable(bounds_of(outline));
  for (const FramedPrimitive& primitive : drawing.primitives) {
    include_reachable(bounds_of(Outline(primitive.corners)));
  }
  return bounds;
}

Arm arm_at(const Robot& robot, std::span<const double> q) {
  Arm arm;
  Arm dots;
  const std::vector<Transform> poses = robot.link_poses(q);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Capsule& capsule : robot.links()[i].capsules) {
      append_segment(flat(poses[i] * capsule.a), flat(poses[i] * capsule.b), capsule.radius, arm);
    }
    for (const Sphere& sphere : robot.links()[i].spheres) {
      dots.push_back({{flat(poses[i] * sphere.center)}, sphere.radius});
    }
  }
  arm.insert(arm.end(), dots.begin(), dots.end());
  return arm;
}

std::vector<Configuration> spread_along(const Robot& robot, const Path& path, int count) {
  std::vector<double> passed = {0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    passed.push_back(passed.back() + robot.distance(path[i - 1], path[i]));
  }
  std::vector<Configuration> spread;
  std::size_t motion = 1;
  for (int k = 0; k < count; ++k) {
    const double distance = passed.back() * k / (count - 1);
    while (motion + 1 < path.size() && passed[motion] < distance) ++motion;
    if (passed.back() <= 0) {
      spread.push_back(path.front());
      continue;
    }
    const double length = passed[motion] - passed[motion - 1];
    const double fraction = length > 0 ? (distance - passed[motion - 1]) / length : 0;
    spread.push_back(interpolate(robot, path[motion - 1], path[motion], fraction));
  }
  return spread;
}

std::vector<int> choose_components(const GaussianMixture& mixture, int limit) {
  std::map<SampleSource, std::vector<int>> by_source;
  for (int i = 0; i < mixture.component_count(); ++i) {
    by_source[mixture.sources.empty() ? 0 : mixture.sources[as_index(i)]].push_back(i);
  }
  std::vector<std::vector<int>> sources;
  for (auto& [source, components] : by_source) sources.push_back(std::move(components));
  // Small sources first: the rest of their share goes to larger ones.
  std::ranges::stable_sort(sources, {}, &std::vector<int>::size);
  std::vector<int> chosen;
  int left = std::max(0, limit);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto size = static_cast<int>(sources[i].size());
    const int share = std::min(size, left / static_cast<int>(sources.size() - i));
    for (int k = 0; k < share; ++k) {
      chosen.push_back(sources[i][static_cast<std::size_t>(std::int64_t{k} * size / share)]);
    }
    left -= share;
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace mneme::internal
