// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/link_distances.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "base/threads.h"
#include "check/free_cells.h"
#include "robot/kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

namespace mneme::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// True if spheres of these radii are more than `enough` apart.
bool are_apart(const Vec3& a, const Vec3& b, double radii, double enough) {
  const double reach = radii + enough;
  return reach < 0 || (a - b).squaredNorm() > reach * reach;
}

Vec3 center_of(const Capsule& posed) {
  return posed.a == posed.b ? posed.a : Vec3(0.5 * (posed.a + posed.b));
}

/// Returns `exact`, or, if that is 0, the `gap` between the spheres, made negative.
double unless_touching(double exact, double gap) {
  return exact > 0 ? exact : std::min(gap, -std::numeric_limits<double>::min());
}

bool contains(const std::vector<int>& links, int link) {
  return std::ranges::find(links, link) != links.end();
}

Result<void> check_link(const Robot& robot, const std::string& name, const std::string& what) {
  if (robot.find_link(name)) return {};
  return fail(ErrorCode::invalid,
              "{} '{}', but robot '{}' has no link and no attached object of this name", what, name,
              robot.name());
}

}  // namespace

NamedLinks find_named_links(const Robot& robot, const Obstacle& obstacle) {
  NamedLinks links;
  for (const std::string& name : obstacle.may_touch) {
    if (const auto link = robot.find_link(name)) links.may_touch.push_back(*link);
  }
  for (const std::string& name : obstacle.exact_links) {
    const auto link = robot.find_link(name);
    if (link && robot.links()[as_index(*link)].approximation) links.exact_links.push_back(*link);
  }
  return links;
}

Result<void> check_named_links(const Robot& robot, const Scene& scene) {
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const std::string& name : obstacle.may_touch) {
      MNEME_TRY(
          check_link(robot, name, fmt::format("obstacle '{}' may be touched by", obstacle.name)));
    }
    for (const std::string& name : obstacle.exact_links) {
      MNEME_TRY(check_link(
          robot, name,
          fmt::format("obstacle '{}' is checked by the exact geometry of", obstacle.name)));
    }
  }
  for (const EndContact& contact : scene.end_contacts) {
    for (const std::string& name : {contact.first, contact.second}) {
      if (scene.find(name) != nullptr) continue;
      MNEME_TRY(check_link(
          robot, name,
          fmt::format("scene '{}' allows contact at the ends of a path of", scene.name)));
    }
  }
  for (const auto& [first, second] : scene.exact_pairs) {
    for (const std::string& name : {first, second}) {
      MNEME_TRY(check_link(
          robot, name,
          fmt::format("scene '{}' has a pair checked by exact geometry of", scene.name)));
    }
  }
  return {};
}

std::vector<LinkPair> link_pairs(const Robot& robot, const Scene& scene) {
  std::vector<std::pair<int, int>> exact_pairs(robot.exact_pairs().begin(),
                                               robot.exact_pairs().end());
  for (const auto& [one, two] : scene.exact_pairs) {
    const auto first = robot.find_link(one), second = robot.find_link(two);
    if (!first || !second) continue;
    const auto is_approximated = [&](int link) {
      return robot.links()[as_index(link)].approximation.has_value();
    };
    if (is_approximated(*first) || is_approximated(*second))
      exact_pairs.push_back(std::minmax(*first, *second));
  }
  std::ranges::sort(exact_pairs);
  std::vector<LinkPair> pairs;
  pairs.reserve(robot.self_pairs().size());
  for (const auto& [first, second] : robot.self_pairs()) {
    const std::pair<int, int> pair = std::minmax(first, second);
    const bool is_exact = std::ranges::binary_search(exact_pairs, pair);
    pairs.push_back({first, second, is_exact});
  }
  return pairs;
}

std::vector<ObstacleShape> obstacle_shapes(const Robot& robot, const Scene& scene) {
  std::vector<ObstacleShape> shapes;
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    const Obstacle& obstacle = scene.obstacles[i];
    NamedLinks named = find_named_links(robot, obstacle);
    const ObstacleShape any{
        static_cast<int>(i), nullptr, {}, std::move(named.may_touch), std::move(named.exact_links)};
    for (const Shape& shape : obstacle.shapes) {
      ObstacleShape& added = shapes.emplace_back(any);
      added.shape = &shape;
      added.bound = bounding_sphere(shape);
    }
  }
  return shapes;
}

LinkDistances::LinkDistances(const Robot& robot) : cells_(std::make_shared<FreeCellsOfPairs>()) {
  add_links(robot);
}

LinkDistances::LinkDistances(const Robot& robot, const LinkDistances& bare)
    : links_(bare.links_),
      bare_count_(bare.link_count()),
      bare_cells_(bare.cells_),
      cells_(std::make_shared<FreeCellsOfPairs>()) {
  add_links(robot);
}

const std::vector<std::shared_ptr<const FreeCells>>& LinkDistances::free_cells(const Robot& robot,
                                                                               int first,
                                                                               int second) const {
  const bool is_bare = std::max(first, second) < bare_count_;
  return (is_bare ? bare_cells_ : cells_)->of(robot, *this, first, second);
}

void LinkDistances::prove_cells(const Robot& robot, const std::string& cache_directory) const {
  if (cache_directory.empty()) return;
  const ContentCache cache(cache_directory, "cells");
  for (const auto& [first, second] : robot.exact_pairs()) {
    for (const auto& cells : free_cells(robot, first, second)) cells->prove_all(cache);
  }
}

/// Adds the links that are new, such as attached objects.
void LinkDistances::add_links(const Robot& robot) {
  const std::vector<bool> is_moving = find_moving_links(robot);
  for (std::size_t i = links_.size(); i < robot.links().size(); ++i) {
    const Link& link = robot.links()[i];
    Body body{shapes_of(link), {}, {}, is_moving[i], ExactLink(link)};
    body.bound = bound_of(body.shapes);
    for (const Capsule& shape : body.shapes) body.bounds.push_back(bound_of({&shape, 1}));
    links_.push_back(std::move(body));
  }
}

PosedLinks LinkDistances::posed(std::vector<Transform> poses) const {
  assert(poses.size() == links_.size());
  PosedLinks result{std::move(poses), {}};
  result.centers.reserve(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    result.centers.push_back(result.poses[i] * links_[i].bound.center);
  }
  return result;
}

double LinkDistances::between(const PosedLinks& posed, int link, const ObstacleShape& other,
                              double enough) const {
  if (contains(other.may_touch, link)) return kInfinity;
  const double gap = between_spheres(posed, link, other, enough);
  if (gap > enough || !contains(other.exact_links, link)) return gap;
  const Transform X_LW = posed.poses[as_index(link)].inverse();
  return unless_touching(at(link).exact.distance_to(transformed(X_LW, *other.shape)), gap);
}

double LinkDistances::between(const PosedLinks& posed, const LinkPair& pair, double enough) const {
  const double gap = between_spheres(posed, pair.first, pair.second, enough);
  if (gap > enough || !pair.is_exact) return gap;
  const Transform X_LO =
      posed.poses[as_index(pair.first)].inverse() * posed.poses[as_index(pair.second)];
  return unless_touching(at(pair.first).exact.distance_to(at(pair.second).exact, X_LO, enough),
                         gap);
}

double LinkDistances::between_spheres(const PosedLinks& posed, int link, const ObstacleShape& other,
                                      double enough) const {
  const Body& body = at(link);
  const auto i = as_index(link);
  const double radius = body.bound.radius;
  if (are_apart(posed.centers[i], other.bound.center, radius + other.bound.radius, enough)) {
    return kInfinity;
  }
  const bool is_one = body.shapes.size() == 1;
  // The sphere around a large obstacle, such as a table, is a poor bound.
  if (!std::holds_alternative<Sphere>(*other.shape) &&
      distance(posed.centers[i], *other.shape) - radius > enough) {
    return kInfinity;
  }
  double least = kInfinity;
  for (std::size_t s = 0; s < body.shapes.size(); ++s) {
    const Capsule own = moved(body.shapes[s], posed.poses[i]);
    const double reach = body.bounds[s].radius + other.bound.radius;
    if (!is_one && are_apart(center_of(own), other.bound.center, reach, std::min(enough, least))) {
      continue;
    }
    least = std::min(least, distance_to_segment(own.a, own.b, *other.shape) - own.radius);
  }
  return least;
}

std::vector<LinkDistances::PosedShape> LinkDistances::near_shapes(const PosedLinks& posed, int link,
                                                                  const Sphere& ball,
                                                                  double enough) const {
  const Body& body = at(link);
  const Transform& pose = posed.poses[as_index(link)];
  const Vec3 there = pose.inverse() * ball.center;
  std::vector<PosedShape> near;
  for (std::size_t s = 0; s < body.shapes.size(); ++s) {
    const Sphere& bound = body.bounds[s];
    if (are_apart(bound.center, there, bound.radius + ball.radius, enough)) continue;
    const Capsule capsule = moved(body.shapes[s], pose);
    near.push_back({capsule, center_of(capsule), bound.radius});
  }
  return near;
}

double LinkDistances::between_spheres(const PosedLinks& posed, int first, int second,
                                      double enough) const {
  const Body &one = at(first), &two = at(second);
  const auto i = as_index(first), j = as_index(second);
  if (are_apart(posed.centers[i], posed.centers[j], one.bound.radius + two.bound.radius, enough)) {
    return kInfinity;
  }
  const std::vector<PosedShape> others =
      near_shapes(posed, second, {posed.centers[i], one.bound.radius}, enough);
  if (others.empty()) return kInfinity;
  double least = kInfinity;
  for (const PosedShape& p :
       near_shapes(posed, first, {posed.centers[j], two.bound.radius}, enough)) {
    for (const PosedShape& q : others) {
      if (are_apart(p.middle, q.middle, p.reach + q.reach, std::min(enough, least))) continue;
      least = std::min(least, segment_distance(p.capsule.a, p.capsule.b, q.capsule.a, q.capsule.b) -
                                  p.capsule.radius - q.capsule.radius);
    }
  }
  return least;
}

namespace {

/// True if `gap`, of a contact of the link, ends at the center or axis of one of its shapes.
bool is_cut(const LinkDistances& links, int link, double gap) {
  return std::ranges::any_of(links.shapes(link),
                             [&](const Capsule& shape) { return -gap >= shape.radius; });
}

/// Contacts with obstacles: of links that the group moves, or of all other links.
std::vector<Contact> find_scene_contacts(const Robot& robot, const LinkDistances& links,
                                         const PosedLinks& posed, const Scene& scene, double margin,
                                         bool of_moving) {
  const std::vector<ObstacleShape> obstacles = obstacle_shapes(robot, scene);
  std::vector<Contact> contacts;
  for (int link = 0; link < links.link_count(); ++link) {
    if (links.is_moving(link) != of_moving) continue;
    poll_interrupt();
    int touched = -1;
    for (const ObstacleShape& shape : obstacles) {
      const double gap = links.between(posed, link, shape, margin);
      if (!(gap < margin)) continue;
      if (shape.obstacle != touched) {
        touched = shape.obstacle;
        const Obstacle& obstacle = scene.obstacles[as_index(touched)];
        contacts.push_back({robot.links()[as_index(link)].name, obstacle.name, false, gap});
      }
      Contact& contact = contacts.back();
      contact.distance = std::min(contact.distance, gap);
      contact.may_be_deeper = is_cut(links, link, contact.distance);
    }
  }
  return contacts;
}

}  // namespace

std::vector<Contact> find_contacts(const Robot& robot, const LinkDistances& links,
                                   const Scene& scene, std::span<const double> q, double margin) {
  const PosedLinks posed = links.posed(robot.link_poses(q));
  std::vector<Contact> contacts = find_scene_contacts(robot, links, posed, scene, margin, true);
  const auto name = [&](int link) { return robot.links()[as_index(link)].name; };
  int last_polled = -1;
  for (const LinkPair& pair : link_pairs(robot, scene)) {
    if (std::exchange(last_polled, pair.first) != pair.first) poll_interrupt();
    const double gap = links.between(posed, pair, 0);
    if (gap >= 0) continue;
    const bool may_be_deeper = is_cut(links, pair.first, gap) || is_cut(links, pair.second, gap);
    contacts.push_back({name(pair.first), name(pair.second), true, gap, may_be_deeper});
  }
  return contacts;
}

std::vector<Contact> find_fixed_contacts(const Robot& robot, const LinkDistances& links,
                                         const Scene& scene) {
  const Configuration anywhere(as_index(robot.joint_count()), 0.0);
  const PosedLinks posed = links.posed(robot.link_poses(anywhere));
  return find_scene_contacts(robot, links, posed, scene, 0, false);
}

Clearance find_clearance(const LinkDistances& links, const PosedLinks& posed,
                         std::span<const ObstacleShape> obstacles, double within) {
  Clearance nearest{within, -1, -1};
  for (int link = 0; link < links.link_count(); ++link) {
    if (!links.is_moving(link)) continue;
    for (const ObstacleShape& obstacle : obstacles) {
      const double gap = links.between(posed, link, obstacle, nearest.distance);
      if (gap < nearest.distance) nearest = {gap, link, obstacle.obstacle};
    }
  }
  return nearest;
}

}  // namespace mneme::internal
