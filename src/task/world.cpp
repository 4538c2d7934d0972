// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/world.h"

#include "mneme/spheres.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "check/parted_pairs.h"
#include "line/floating_body.h"
#include "robot/kinematics.h"
#include "tables/make_tables.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

Transform frame_of(const Sphere& sphere) { return {Eigen::Matrix3d::Identity(), sphere.center}; }
Transform frame_of(const Capsule& capsule) {
  const Vec3 middle = 0.5 * (capsule.a + capsule.b);
  const Vec3 z = capsule.b - capsule.a;
  const Vec3 axis = Vec3::UnitZ().cross(z);
  if (axis.norm() < 1e-12) return {Eigen::Matrix3d::Identity(), middle};
  return {rotation_about(axis.normalized(), std::atan2(axis.norm(), z.z())), middle};
}
template <class Posed>
Transform frame_of(const Posed& shape) {
  return shape.pose;
}

/// Pose of the frame that a task names by a held object, in its link's frame.
Transform frame_in_link(const AttachedObject& object) {
  if (!object.shapes.empty()) return pose_of(object.shapes.front());
  return object.meshes.empty() ? Transform() : object.meshes.front().pose;
}

/// Shapes of a held object for an obstacle, in its link's frame.
std::vector<Shape> shapes_once_free(const ApproximatedObject& held) {
  std::vector<Shape> shapes = held.object.shapes;
  if (held.object.meshes.empty() && !shapes.empty()) return shapes;
  if (held.approximation) {
    // Has the triangles of mesh files, which are not read again.
    shapes.emplace_back(held.approximation->surface);
  } else {
    shapes.insert(shapes.end(), held.spheres.begin(), held.spheres.end());
    shapes.insert(shapes.end(), held.capsules.begin(), held.capsules.end());
  }
  return shapes;
}

/// Metres between the links rigid with the carrier and the obstacle, and the nearest link.
std::pair<double, std::string> distance_to_hand(const Robot& robot, const std::string& carrier,
                                                const Obstacle& obstacle, const Configuration& q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  double nearest = std::numeric_limits<double>::infinity();
  std::string name = carrier;
  for (const int link : rigid_with(robot, *robot.find_link(carrier))) {
    std::vector<Capsule> shapes = shapes_of(robot.links()[as_index(link)], poses[as_index(link)]);
    if (shapes.empty() && robot.links()[as_index(link)].name == carrier) {
      const Vec3 origin = poses[as_index(link)].translation;
      shapes.push_back({origin, origin, 0});
    }
    for (const Capsule& capsule : shapes) {
      for (const Shape& shape : obstacle.shapes) {
        const double gap = distance_to_segment(capsule.a, capsule.b, shape) - capsule.radius;
        if (gap < nearest)
          std::tie(nearest, name) = std::pair(gap, robot.links()[as_index(link)].name);
      }
    }
  }
  return {nearest, name};
}

void add_new(const std::string& name, std::vector<std::string>& names) {
  if (std::ranges::count(names, name) == 0) names.push_back(name);
}

/// What an object may touch by the world's pairs.
struct Partners {
  std::vector<std::string> carried = {};    ///< links and held objects
  std::vector<std::string> obstacles = {};  ///< not held
};

Partners find_partners(const World& world, const std::string& object) {
  Partners partners;
  for (const auto& [carried, obstacle] : world.allowed) {
    if (carried != object && obstacle != object) continue;
    const bool was_obstacle = carried == object;
    const std::string& other = was_obstacle ? obstacle : carried;
    const bool is_obstacle = world.scene.find(other) != nullptr;
    const bool is_carried = world.robot.find_link(other).has_value();
    // An obstacle may have the name of a link.
    if (is_obstacle && (was_obstacle || !is_carried)) {
      add_new(other, partners.obstacles);
    } else if (is_carried) {
      add_new(other, partners.carried);
    }
  }
  return partners;
}

Result<World> attached(const World& world, const Stage& stage, const Configuration& q) {
  const Obstacle* obstacle = world.scene.find(stage.object);
  const Transform X_WL = world.robot.link_poses(q)[as_index(*world.robot.find_link(stage.carrier))];
  AttachedObject object{stage.object, stage.carrier, {}, {}, stage.may_touch};
  for (const Shape& shape : obstacle->shapes) {
    object.shapes.push_back(transformed(X_WL.inverse(), shape));
  }
  World next = world;
  next.held[stage.object] = {stage.carrier, X_WL.inverse() * world.poses.at(stage.object),
                             stage.may_touch};
  next.poses.erase(stage.object);
  MNEME_TRY(next.scene.remove(stage.object));
  // Contact of the obstacle that was allowed, always or at ends, stays so. Links of this stage may
  // touch it always now.
  next.scene.end_contacts = world.scene.end_contacts;
  std::erase_if(next.scene.end_contacts, [&](const EndContact& contact) {
    const std::string& other = contact.first == stage.object ? contact.second : contact.first;
    return (contact.first == stage.object || contact.second == stage.object) &&
           std::ranges::count(stage.may_touch, other) > 0;
  });
  for (const std::string& name : find_partners(next, stage.object).carried) {
    add_new(name, object.may_touch);
  }
  let_obstacles_touch(next, stage.object);
  std::vector<ApproximatedObject> objects;
  objects.push_back(MNEME_TRY(approximate_object(std::move(object))));
  next.robot = MNEME_TRY(world.robot.with_attached(std::move(objects)));
  return next;
}

Result<World> detached(const World& world, const Stage& stage, const Configuration& q) {
  const HeldObject& held = world.held.at(stage.object);
  const Transform X_WL = world.robot.link_poses(q)[as_index(*world.robot.find_link(held.link))];
  const auto object = std::ranges::find_if(
      world.robot.attached(),
      [&](const ApproximatedObject& each) { return each.object.name == stage.object; });
  Obstacle obstacle{stage.object, {}};
  for (const Shape& shape : shapes_once_free(*object)) {
    obstacle.shapes.push_back(transformed(X_WL, shape));
  }
  World next = world;
  next.poses[stage.object] = X_WL * held.X_LO;
  next.robot = MNEME_TRY(world.robot.without_attached(stage.object));
  next.held.erase(stage.object);
  for (Obstacle& other : next.scene.obstacles) {
    std::erase(other.exact_links, stage.object);
    std::erase(other.may_touch, stage.object);
  }
  std::erase_if(next.scene.exact_pairs, [&](const auto& pair) {
    return pair.first == stage.object || pair.second == stage.object;
  });
  obstacle.may_touch = find_partners(next, stage.object).carried;
  MNEME_TRY(next.scene.add(std::move(obstacle)));
  return next;
}

/// `robot` with the objects that `other` holds.
Result<Robot> with_held(const Robot& robot, const Robot& other) {
  if (other.attached().empty()) return robot;
  return robot.with_attached({other.attached().begin(), other.attached().end()});
}

/// The robot that `make` makes of the world's robot without held objects, kept in `made` for robots
/// and values that are the same.
template <class Make, class IsSame>
Result<Robot> find_or_make(const World& world, const std::map<std::string, double>& values,
                           std::vector<GripperRobots::Entry>& made, const Make& make,
                           const IsSame& is_same) {
  const Robot bare = world.robot.without_attached();
  auto known = std::ranges::find_if(made, [&](const GripperRobots::Entry& entry) {
    return entry.from.identity().lock() == bare.identity().lock() &&
           std::ranges::equal(entry.values, values, is_same);
  });
  if (known == made.end()) {
    made.push_back({bare, values, MNEME_TRY(make(bare, values))});
    known = std::prev(made.end());
  }
  return with_held(known->to, world.robot);
}

/// Each pair is of a link or held object and an obstacle, in either order: check_task() refuses
/// others, and names with two meanings.
World with_allowed(const World& world, const Stage& stage) {
  World next = world;
  for (const auto& [first, second] : stage.pairs) {
    const bool is_second = next.scene.find(second) != nullptr;
    const AllowedContact pair =
        is_second ? AllowedContact{first, second} : AllowedContact{second, first};
    add_new(pair.carried, next.scene.find(pair.obstacle)->may_touch);
    if (std::ranges::count(next.allowed, pair) == 0) next.allowed.push_back(pair);
  }
  return next;
}

auto names_of(const Robot& robot, std::span<const std::pair<int, int>> pairs) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [first, second] : pairs) {
    names.emplace_back(robot.links()[as_index(first)].name, robot.links()[as_index(second)].name);
  }
  return names;
}

Robot::Parts parts_of(const Robot& bare) {
  Robot::Parts parts;
  parts.name = bare.name();
  parts.links.assign(bare.links().begin(), bare.links().end());
  parts.joints.assign(bare.joints().begin(), bare.joints().end());
  parts.allowed_pairs = names_of(bare, bare.allowed_pairs());
  parts.states.assign(bare.named_states().begin(), bare.named_states().end());
  parts.exact_pairs = names_of(bare, bare.exact_pairs());
  parts.root_frame = bare.root_frame();
  return parts;
}

/// Metres by which a hand alone, and objects in it, may reach farther than the robot.
double extra_reach(const Task& task) {
  double extra = 0.5;  // of a hand, from the origin of its link
  for (const Stage& stage : task.stages) {
    const Obstacle* object = task.scene.find(stage.object);
    if (stage.kind != StageKind::attach || object == nullptr || object->shapes.empty()) continue;
    const Vec3 middle = bounding_sphere(object->shapes.front()).center;
    double radius = 0;
    for (const Shape& shape : object->shapes) {
      const Sphere bound = bounding_sphere(shape);
      radius = std::max(radius, (bound.center - middle).norm() + bound.radius);
    }
    // The ball around an object may reach as far again as the object.
    extra += 4 * radius;
  }
  return extra;
}

/// The options that make the robot again.
RobotOptions options_of(const Robot& robot) {
  RobotOptions options;
  options.joints = robot.joint_names();
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const Joint& joint = robot.joints()[i];
    const bool is_planned = std::ranges::count(robot.group(), static_cast<int>(i)) > 0;
    if (is_free(joint) && !is_planned) options.fixed_values.emplace(joint.name, joint.fixed_value);
  }
  return options;
}

/// The robot with the joints of `values` in its planning group, too. Checks links that only these
/// joints part, by exact geometry where there is one.
Result<Robot> make_wide(const Robot& bare, const std::map<std::string, double>& values) {
  RobotOptions options = options_of(bare);
  for (const auto& [joint, value] : values) {
    options.fixed_values.erase(joint);
    options.joints.push_back(joint);
  }
  Robot wide = MNEME_TRY(make_robot(parts_of(bare), options));
  options.allowed_pairs = names_of(wide, connected_pairs(wide, bare));
  wide = MNEME_TRY(make_robot(parts_of(bare), options));
  for (auto& pair : names_of(wide, linked_pairs(wide, bare))) options.allowed_pairs.push_back(pair);
  Robot::Parts parts = parts_of(bare);
  for (const auto& [first, second] : parted_pairs(wide, bare)) {
    const Link &one = wide.links()[as_index(first)], &other = wide.links()[as_index(second)];
    if (one.approximation || other.approximation) {
      parts.exact_pairs.emplace_back(one.name, other.name);
    }
  }
  return make_robot(std::move(parts), options);
}

}  // namespace

Result<Robot> with_joint_values(const Robot& robot, const std::map<std::string, double>& values) {
  RobotOptions options = options_of(robot);
  for (const auto& [joint, value] : values) options.fixed_values[joint] = value;
  return with_held(MNEME_TRY(make_robot(parts_of(robot.without_attached()), options)), robot);
}

Result<Robot> find_or_make_wide(const World& world, const std::map<std::string, double>& values) {
  const auto is_same_joint = [](const auto& a, const auto& b) { return a.first == b.first; };
  return find_or_make(world, values, world.grippers->wide, make_wide, is_same_joint);
}

Transform pose_of(const Shape& shape) {
  return std::visit([](const auto& each) { return frame_of(each); }, shape);
}

void prepare_shapes_of(const Task& task, double margin) {
  const double reach = reach_of(task.robot) + extra_reach(task) + margin;
  const bool may_touch = !task.robot.attached().empty() || !task.scene.end_contacts.empty() ||
                         std::ranges::count(task.stages, StageKind::attach, &Stage::kind) > 0;
  prepare_shapes(task.robot, task.scene, reach, may_touch);
}

World first_world(const Task& task) {
  World world{task.robot, task.scene, {}, {}, {}};
  const std::vector<Transform> poses = task.robot.link_poses(task.start);
  for (const ApproximatedObject& each : task.robot.attached()) {
    const AttachedObject& object = each.object;
    world.held[object.name] = {object.link, frame_in_link(object), object.may_touch};
  }
  for (const Obstacle& obstacle : task.scene.obstacles) {
    if (!obstacle.shapes.empty()) world.poses[obstacle.name] = pose_of(obstacle.shapes.front());
    for (const std::string& name : obstacle.may_touch) {
      world.allowed.push_back({name, obstacle.name});
    }
  }
  return world;
}

Result<void> check_near(const World& world, const Stage& stage, const Configuration& q) {
  const Obstacle* obstacle = world.scene.find(stage.object);
  const auto [gap, nearest] = distance_to_hand(world.robot, stage.carrier, *obstacle, q);
  if (gap <= kFarthestAttach) return {};
  return fail(ErrorCode::invalid,
              "object '{}' is {:.1f} cm from link '{}', the nearest of the hand; a link attaches "
              "what is within {:.0f} cm: move there first",
              stage.object, 100 * gap, nearest, 100 * kFarthestAttach);
}

Result<World> after_stage(const World& world, const Stage& stage, const Configuration& q) {
  switch (stage.kind) {
    case StageKind::attach:
      return attached(world, stage, q);
    case StageKind::detach:
      return detached(world, stage, q);
    case StageKind::allow:
      return with_allowed(world, stage);
    case StageKind::gripper: {
      World next = world;
      next.robot = MNEME_TRY(find_or_make(world, stage.values, world.grippers->made,
                                          with_joint_values, std::equal_to<>()));
      return next;
    }
    case StageKind::move:
    case StageKind::line:
      break;
  }
  return world;
}

void let_obstacles_touch(World& world, const std::string& object) {
  for (const std::string& name : find_partners(world, object).obstacles) {
    add_new(object, world.scene.find(name)->may_touch);
  }
}

void let_touch_at_ends(Scene& scene, const std::string& object,
                       const std::vector<std::string>& links, double stretch) {
  if (stretch == 0) return;
  for (const std::string& link : links) scene.end_contacts.push_back({link, object, stretch});
}

std::vector<Transform> link_targets(const World& world, const PoseChoice& choice,
                                    const std::vector<Transform>& start_poses) {
  Transform X_WF;
  if (const auto link = world.robot.find_link(choice.frame); link && !choice.frame.empty()) {
    if (as_index(*link) < start_poses.size()) X_WF = start_poses[as_index(*link)];
  }
  if (const auto pose = world.poses.find(choice.frame); pose != world.poses.end()) {
    X_WF = pose->second;
  }
  const Transform X_OL =
      choice.object.empty() ? Transform() : world.held.at(choice.object).X_LO.inverse();
  std::vector<Transform> targets;
  targets.reserve(choice.poses.size());
  for (const Transform& pose : choice.poses) targets.push_back(X_WF * pose * X_OL);
  return targets;
}

}  // namespace mneme::internal
