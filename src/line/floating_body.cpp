// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "line/floating_body.h"

#include "mneme/spheres.h"

#include "base/as_index.h"
#include "check/parted_pairs.h"
#include "geometry/parts.h"
#include "planning/end_contacts.h"
#include "robot/kinematics.h"
#include "tables/make_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <tuple>
#include <utility>
#include <variant>

namespace mneme::internal {
namespace {

/// Axes of the joints, and the one that slides: yaw and pitch of a ray, the distance along it, then
/// yaw, pitch and roll of the body. One slide has the reach of the arm; three along x, y and z
/// would have three times as much, and tables of the scene that differ from those of the arm.
constexpr std::array<int, 6> kAxes = {2, 1, 0, 2, 1, 0};
constexpr int kSlide = 2;

/// `reach`: how far the slide goes, metres.
Joint floating_joint(int number, double reach) {
  Joint joint;
  joint.name = fmt::format("floating_{}", number);
  joint.type = number == kSlide ? JointType::prismatic : JointType::revolute;
  joint.parent_link = number;
  joint.child_link = number + 1;
  joint.axis = Vec3::Unit(kAxes.at(as_index(number)));
  joint.upper = number == kSlide ? reach : 2 * std::numbers::pi;
  joint.lower = -joint.upper;
  return joint;
}

/// The values of the six joints, which reach any pose.
std::array<float, 6> floating_values(const Transform& pose) {
  const Vec3& p = pose.translation;
  const double ray_yaw = std::atan2(p.y(), p.x());
  const double ray_pitch = -std::atan2(p.z(), std::hypot(p.x(), p.y()));
  const Eigen::Matrix3d ray =
      rotation_about(Vec3::UnitZ(), ray_yaw) * rotation_about(Vec3::UnitY(), ray_pitch);
  const Eigen::Matrix3d R = ray.transpose() * pose.rotation;
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  // At the poles yaw alone turns.
  const bool is_pole = std::hypot(R(0, 0), R(1, 0)) < 1e-9;
  const double yaw = is_pole ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0));
  const double roll = is_pole ? 0 : std::atan2(R(2, 1), R(2, 2));
  return {static_cast<float>(ray_yaw), static_cast<float>(ray_pitch), static_cast<float>(p.norm()),
          static_cast<float>(yaw),     static_cast<float>(pitch),     static_cast<float>(roll)};
}

Link moved_link(Link link, const Transform& X) {
  link.parent_joint = -1;
  for (Sphere& sphere : link.spheres) sphere.center = X * sphere.center;
  for (Capsule& capsule : link.capsules) capsule = moved(capsule, X);
  if (link.approximation) {
    Mesh& surface = link.approximation->surface;
    surface = std::get<Mesh>(transformed(X, surface));
  }
  return link;
}

/// A robot of six joints that carries `links`.
Robot::Parts make_parts(std::vector<Link> links, double reach) {
  Robot::Parts parts;
  parts.name = "floating";
  parts.allowed_pairs.emplace();
  for (int i = 0; i <= 6; ++i) {
    parts.links.push_back({.name = fmt::format("floating_link_{}", i), .parent_joint = i - 1});
  }
  for (int i = 0; i < 6; ++i) parts.joints.push_back(floating_joint(i, reach));
  for (Link& link : links) {
    Joint joint;
    joint.name = "to_" + link.name;
    joint.parent_link = 6;
    joint.child_link = static_cast<int>(parts.links.size());
    link.parent_joint = static_cast<int>(parts.joints.size());
    parts.joints.push_back(std::move(joint));
    parts.links.push_back(std::move(link));
  }
  return parts;
}

/// Takes `depth` metres off the radius of each shape, up to its centre or axis, and drops exact
/// geometry.
void deflate(double depth, std::vector<Link>& links) {
  constexpr double kLeast = 1e-4;  // metres: a centre in an obstacle still touches it
  const auto thinner = [&](double radius) {
    return std::max(std::min(radius, kLeast), radius - depth);
  };
  for (Link& link : links) {
    for (Sphere& sphere : link.spheres) sphere.radius = thinner(sphere.radius);
    for (Capsule& capsule : link.capsules) capsule.radius = thinner(capsule.radius);
    link.approximation.reset();
  }
}

/// `depth`: metres that the links may be in an obstacle.
std::optional<FloatingRobot> make_floating_robot(std::vector<Link> links, double reach,
                                                 bool is_exact, double depth) {
  std::erase_if(links, [](const Link& link) { return !has_shapes(link); });
  if (links.empty()) return std::nullopt;
  double excess = 0;
  bool has_surfaces = false;
  for (Link& link : links) {
    has_surfaces = has_surfaces || link.approximation.has_value();
    // Surfaces cost milliseconds to prepare.
    if (!is_exact) link.approximation.reset();
    if (link.approximation) excess = std::max(excess, link.approximation->excess);
  }
  std::vector<Link> cores = links;
  // Twice the excess: it is measured at samples.
  deflate(depth + 2 * excess, cores);
  if (depth > 0) {
    links = std::move(cores);
    excess = 0;
  }
  auto robot = make_robot(make_parts(std::move(links), reach));
  if (!robot) return std::nullopt;
  FloatingRobot floating{*std::move(robot), std::nullopt, has_surfaces};
  if (excess == 0) return floating;
  auto core = make_robot(make_parts(std::move(cores), reach));
  if (core) floating.core = *std::move(core);
  return floating;
}

/// Floating robots of links by the robot that they are of: their tables take longer than most tests
/// with them. Thread-safe.
class FloatingRobots {
 public:
  /// Precondition: `bare` has no attached objects.
  std::optional<FloatingRobot> find_or_make(const Robot& bare, int tip, bool is_exact) {
    const std::lock_guard lock(mutex_);
    std::erase_if(made_, [](const auto& entry) { return std::get<0>(entry.first).expired(); });
    const Key key(bare.identity(), tip, is_exact);
    auto found = made_.find(key);
    if (found == made_.end()) found = made_.emplace(key, make(bare, tip, is_exact)).first;
    return found->second;
  }

 private:
  using Key = std::tuple<std::weak_ptr<const void>, int, bool>;
  struct Less {
    bool operator()(const Key& a, const Key& b) const {
      const auto &one = std::get<0>(a), &other = std::get<0>(b);
      if (one.owner_before(other) || other.owner_before(one)) return one.owner_before(other);
      return std::tie(std::get<1>(a), std::get<2>(a)) < std::tie(std::get<1>(b), std::get<2>(b));
    }
  };

  static std::optional<FloatingRobot> make(const Robot& bare, int tip, bool is_exact) {
    const auto joints = as_index(bare.joint_count());
    const std::vector<Transform> poses =
        bare.link_poses(bare.normalized(Configuration(joints, 0.0)));
    const Transform X_TW = poses[as_index(tip)].inverse();
    std::vector<Link> links;
    for (const int i : rigid_with(bare, tip)) {
      links.push_back(moved_link(bare.links()[as_index(i)], X_TW * poses[as_index(i)]));
    }
    return make_floating_robot(std::move(links), farthest_reach(bare), is_exact, 0);
  }

  std::mutex mutex_;
  std::map<Key, std::optional<FloatingRobot>, Less> made_;
};

/// The scene without what it says of other links.
Scene scene_for(const Robot& robot, Scene scene) {
  scene.exact_pairs.clear();
  // Contact that is allowed at the ends of a line is no reason to drop a pose there.
  for (const EndContact& contact : std::exchange(scene.end_contacts, {})) {
    if (Obstacle* other = scene.find(contact.second)) other->may_touch.push_back(contact.first);
    if (Obstacle* other = scene.find(contact.first)) other->may_touch.push_back(contact.second);
  }
  for (Obstacle& obstacle : scene.obstacles) {
    obstacle.exact_links.clear();
    std::erase_if(obstacle.may_touch,
                  [&](const std::string& name) { return !robot.find_link(name); });
  }
  return scene;
}

}  // namespace

std::optional<FloatingBody> FloatingBody::make(std::optional<FloatingRobot> floating,
                                               const Scene& scene, const BodySettings& settings) {
  if (!floating) return std::nullopt;
  const auto make_checker = [&](const Robot& robot) {
    return CollisionChecker::make(robot, scene_for(robot, scene), {.isa = settings.isa});
  };
  auto checker = make_checker(floating->robot);
  if (!checker) return std::nullopt;
  FloatingBody body(*std::move(checker), floating->has_surfaces);
  if (!floating->core) return body;
  if (auto core = make_checker(*floating->core)) body.core_ = *std::move(core);
  return body;
}

std::optional<FloatingBody> FloatingBody::of_link(const Robot& robot, const Scene& scene,
                                                  const std::string& link,
                                                  const BodySettings& settings) {
  static FloatingRobots hands;
  const Robot bare = robot.without_attached();
  return make(hands.find_or_make(bare, *bare.find_link(link), settings.is_exact), scene, settings);
}

std::optional<FloatingBody> FloatingBody::of_object(const Robot& robot, const Scene& scene,
                                                    const std::string& object,
                                                    const Transform& X_LO,
                                                    const BodySettings& settings) {
  const Transform X_OL = X_LO.inverse();
  std::vector<Link> links;
  for (const ApproximatedObject& each : robot.attached()) {
    if (each.object.name != object) continue;
    links.push_back(
        moved_link({object, -1, each.spheres, each.capsules, {}, each.approximation}, X_OL));
  }
  return make(
      make_floating_robot(std::move(links), farthest_reach(robot), settings.is_exact, kObjectDepth),
      scene, settings);
}

std::optional<FloatingBody> FloatingBody::of_obstacle(const Robot& robot, const Scene& scene,
                                                      const std::string& name,
                                                      const Transform& X_WO,
                                                      const BodySettings& settings) {
  const Transform X_OW = X_WO.inverse();
  AttachedObject object{name, "", {}};
  for (const Shape& shape : scene.find(name)->shapes) {
    object.shapes.push_back(transformed(X_OW, shape));
  }
  const auto spheres = approximate_object(std::move(object));
  Scene others = scene;
  if (!spheres || !others.remove(name)) return std::nullopt;
  std::vector<Link> links;
  links.push_back({name, -1, spheres->spheres, spheres->capsules, {}, spheres->approximation});
  return make(
      make_floating_robot(std::move(links), farthest_reach(robot), settings.is_exact, kObjectDepth),
      others, settings);
}

std::vector<std::uint8_t> FloatingBody::find_free(const std::vector<Transform>& poses) const {
  std::vector<float> rows;
  rows.reserve(6 * poses.size());
  for (const Transform& pose : poses) {
    const std::array<float, 6> values = floating_values(pose);
    rows.insert(rows.end(), values.begin(), values.end());
  }
  std::vector<std::uint8_t> is_free(poses.size(), 1);
  if (poses.empty()) return is_free;
  checker_.check_states(rows, is_free);
  if (!core_) return is_free;
  std::vector<std::uint8_t> may_be_free(poses.size(), 1);
  core_->check_states(rows, may_be_free);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (is_free[i] || !may_be_free[i]) continue;
    const Configuration q(rows.begin() + static_cast<std::ptrdiff_t>(6 * i),
                          rows.begin() + static_cast<std::ptrdiff_t>(6 * i + 6));
    is_free[i] = is_clear_by_exact_geometry(checker_, q, kLineClearance) ? 1 : 0;
  }
  return is_free;
}

std::string FloatingBody::describe_contact(const Transform& pose) const {
  const std::array<float, 6> values = floating_values(pose);
  return describe_deepest(checker_.contacts(Configuration(values.begin(), values.end())));
}

void prepare_shapes(const Robot& robot, const Scene& scene, double reach, bool may_touch) {
  const auto prepare = [&](const auto& shape) {
    if constexpr (requires { shape.parts; }) {
      static_cast<void>(share_grid(*shape.parts, region_of_interest(shape, reach)));
      if (may_touch) static_cast<void>(PartsAccess::tree(*shape.parts));
    }
  };
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) std::visit(prepare, shape);
  }
  for (const ApproximatedObject& held : robot.attached()) {
    for (const Shape& shape : held.object.shapes) std::visit(prepare, shape);
    // Stands for mesh files once the object is an obstacle.
    if (held.approximation && !held.object.meshes.empty()) prepare(held.approximation->surface);
  }
}

std::string describe_deepest(std::span<const Contact> contacts) {
  if (contacts.empty()) return "";
  const Contact& deepest = *std::ranges::min_element(contacts, {}, &Contact::distance);
  const std::string_view gap = deepest.distance > 1e-4 ? ", nearer than the margin" : "";
  return fmt::format("'{}' with '{}'{}", deepest.link, deepest.other, gap);
}

}  // namespace mneme::internal
