// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Small robots in small scenes, with a question for a planner in each, and an exact check of
/// paths.
#pragma once

#include "support/planar_memory.h"

#include <cmath>

namespace mneme::test {

struct World {
  std::string name;
  Robot robot;
  Scene scene;
  PlanQuery query;
};

inline CollisionChecker make_checker(const Robot& robot, const Scene& scene,
                                     const CheckerSettings& settings) {
  return require(CollisionChecker::make(robot, scene, settings));
}
inline CollisionChecker make_checker(const World& world, const CheckerSettings& settings = {}) {
  return make_checker(world.robot, world.scene, settings);
}

inline Robot thick_arm(const std::vector<double>& lengths) { return planar_arm(lengths, 0.02); }

/// Adds a link that hangs on the latest one by a joint at `offset`.
inline void add_link(Robot::Parts& parts, JointType type, const Vec3& offset, const Vec3& axis,
                     double limit, const std::vector<Sphere>& spheres) {
  const int child = static_cast<int>(parts.links.size());
  Link link;
  link.name = "link_" + std::to_string(child);
  link.spheres = spheres;
  Joint joint;
  joint.name = "joint_" + std::to_string(child);
  joint.type = type;
  joint.parent_link = child - 1;
  joint.child_link = child;
  joint.origin.translation = offset;
  joint.axis = axis;
  joint.lower = -limit;
  joint.upper = limit;
  parts.links.push_back(link);
  parts.joints.push_back(joint);
}

inline Robot make_small_robot(Robot::Parts parts) { return require(make_robot(std::move(parts))); }

/// An arm in space: a turning column, a shoulder, an elbow and a wrist, made of spheres.
inline Robot spatial_arm() {
  const auto spheres = [](double length, double radius) {
    std::vector<Sphere> result;
    for (double x = 0.1; x < length; x += 0.1) result.push_back({Vec3(x, 0, 0), radius});
    return result;
  };
  Robot::Parts parts;
  parts.name = "spatial_arm";
  parts.links.push_back({.name = "base", .spheres = {{Vec3(0, 0, -0.1), 0.1}}});
  add_link(parts, JointType::continuous, Vec3(0, 0, 0.3), Vec3::UnitZ(), kPi,
           {{Vec3::Zero(), 0.1}});
  add_link(parts, JointType::revolute, Vec3(0, 0, 0.1), Vec3::UnitY(), 2, spheres(0.6, 0.06));
  add_link(parts, JointType::revolute, Vec3(0.6, 0, 0), Vec3::UnitY(), 2.5, spheres(0.5, 0.05));
  add_link(parts, JointType::continuous, Vec3(0.5, 0, 0), Vec3::UnitX(), kPi,
           {{Vec3(0.05, 0.05, 0), 0.05}});
  return make_small_robot(std::move(parts));
}

/// A ball of radius 0.1 m that three prismatic joints move, each within 2 m of the middle.
inline Robot gantry() {
  Robot::Parts parts;
  parts.name = "gantry";
  parts.links.push_back({.name = "rail"});
  add_link(parts, JointType::prismatic, Vec3::Zero(), Vec3::UnitX(), 2, {});
  add_link(parts, JointType::prismatic, Vec3::Zero(), Vec3::UnitY(), 2, {});
  add_link(parts, JointType::prismatic, Vec3::Zero(), Vec3::UnitZ(), 2, {{Vec3::Zero(), 0.1}});
  return make_small_robot(std::move(parts));
}

inline Obstacle make_box(const std::string& name, const Vec3& least, const Vec3& most) {
  Box box;
  box.pose.translation = 0.5 * (least + most);
  box.half_extents = 0.5 * (most - least);
  return {name, {box}};
}

inline Obstacle make_ball(const std::string& name, const Vec3& center, double radius) {
  return {name, {Sphere{center, radius}}};
}

/// A wall across the gantry's room at x = 0, with a square hole of `width` in its middle.
inline Scene wall_with_hole(double width) {
  const double half = 0.5 * width;
  Scene scene{"wall", {}};
  scene.obstacles = {make_box("left", {-0.1, half, -3}, {0.1, 3, 3}),
                     make_box("right", {-0.1, -3, -3}, {0.1, -half, 3}),
                     make_box("above", {-0.1, -half, half}, {0.1, half, 3}),
                     make_box("below", {-0.1, -half, -3}, {0.1, half, -half})};
  return scene;
}

/// Two posts where no state of an arm that swings straight from start to goal is checked, with
/// coarse_states(): only bounds on its motion keep it from passing through them.
inline World posts_between_states() {
  World world{"posts", spatial_arm(), {}, {{0, 0.3, 0.2, 0}, {{2.75, 0.3, 0.2, 0}}}};
  for (const double angle : {7.5 * 2.75 / 16, 12.5 * 2.75 / 16}) {
    const Vec3 foot(0.85 * std::cos(angle), 0.85 * std::sin(angle), -1);
    world.scene.obstacles.push_back(make_box("post", foot, foot + Vec3(0.001, 0.001, 2)));
  }
  return world;
}

inline CheckerSettings coarse_states() {
  CheckerSettings coarse;
  coarse.resolution = 4;
  return coarse;
}

/// Three robots of the plane, one of space and one that slides; each in an empty scene, beside one
/// obstacle, and reaching through a gap.
inline std::vector<World> small_worlds() {
  const Robot arm2 = thick_arm({1, 1}), arm3 = thick_arm({1, 0.8, 0.6}), arm8 = planar8();
  const Robot spatial = spatial_arm(), slider = gantry();
  const Configuration bent8 = {2.5, 0.3, 0.3, -0.3, 0.4, -0.2, 0.3, 0.1};
  const Configuration straight8(8, 0.0);
  const Scene empty;
  return {
      {"arm2 empty", arm2, empty, {{2.5, 0.5}, {{0, 0}}}},
      {"arm2 obstacle", arm2, make_circle_scene("", {{1.2, 1.2, 0.3}}), {{1.6, -0.5}, {{0, 0}}}},
      {"arm2 gap",
       arm2,
       make_circle_scene("", {{1.5, 0.75, 0.35}, {1.5, -0.75, 0.35}}),
       {{2.5, 0.5}, {{0, 0}}}},
      {"arm3 empty", arm3, empty, {{2.5, 0.5, -1}, {{0, 0, 0}}}},
      {"arm3 obstacle",
       arm3,
       make_circle_scene("", {{1.2, 1.2, 0.3}}),
       {{1.6, -0.5, 0.3}, {{0, 0, 0}}}},
      {"arm3 gap",
       arm3,
       make_circle_scene("", {{1.8, 0.6, 0.35}, {1.8, -0.6, 0.35}}),
       {{2.5, 0.5, -1}, {{0, 0, 0}}}},
      {"planar8 empty", arm8, empty, {bent8, {straight8}}},
      {"planar8 obstacle", arm8, make_circle_scene("", {{4, 4, 1.5}}), {straight8, {bent8}}},
      {"planar8 gap",
       arm8,
       make_circle_scene("", {{10.5, 1.5, 1}, {10.5, -1.5, 1}}),
       {straight8, {bent8}}},
      {"spatial empty", spatial, empty, {{3, -1, 1, 0}, {{0, 0.2, 0.2, 1}}}},
      {"spatial obstacle",
       spatial,
       {"", {make_box("post", {0.3, 0.3, -1}, {0.5, 0.5, 2})}},
       {{1.6, 0, 0.5, 3}, {{0, 0.2, 0.2, -3}}}},
      {"spatial gap",
       spatial,
       {"", {make_ball("left", {0.8, 0.4, 0.3}, 0.25), make_ball("right", {0.8, -0.4, 0.3}, 0.25)}},
       {{2, -0.5, 1, 0}, {{0, 0.1, 0, 0}}}},
      {"gantry empty", slider, empty, {{-1.5, 1, 0}, {{1.5, -1, 1}}}},
      {"gantry obstacle",
       slider,
       {"", {make_box("block", {-0.5, -1, -1}, {0.5, 1, 1})}},
       {{-1.5, 0.5, 0}, {{1.5, -0.5, 0.2}}}},
      {"gantry gap", slider, wall_with_hole(0.6), {{-1.5, 1, 0}, {{1.5, -1, 1}}}},
  };
}

/// planar8 whose first link stands between the posts of a ring around the base. At the start it
/// points one way, at the goal the other: nothing leads there.
inline World locked_arm() {
  std::vector<std::array<double, 3>> ring;
  for (int i = 0; i < 18; ++i) {
    const double angle = i * kPi / 9;
    if (i != 0 && i != 9) ring.push_back({0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.2});
  }
  return {
      "locked",
      planar8(),
      make_circle_scene("ring", ring),
      {{-kPi, 0.5, 0.2, -0.3, 0.4, -0.2, 0.3, 0.1}, {{0, 0.3, 0.3, -0.3, 0.4, -0.2, 0.3, 0.1}}}};
}

/// The ball of the gantry; the goal is in a closed box.
inline World boxed_goal() {
  return {"boxed",
          gantry(),
          {"box",
           {make_box("east", {0.7, -0.5, -0.5}, {0.8, 0.5, 0.5}),
            make_box("west", {0.2, -0.5, -0.5}, {0.3, 0.5, 0.5}),
            make_box("north", {0.2, 0.4, -0.5}, {0.8, 0.5, 0.5}),
            make_box("south", {0.2, -0.5, -0.5}, {0.8, -0.4, 0.5}),
            make_box("top", {0.2, -0.5, 0.4}, {0.8, 0.5, 0.5}),
            make_box("bottom", {0.2, -0.5, -0.5}, {0.8, 0.5, -0.4})}},
          {{-1, 0, 0}, {{0.5, 0, 0}}}};
}

inline std::string to_text(std::span<const double> q) {
  std::stringstream text;
  text.precision(17);
  for (const double value : q) text << (text.tellp() > 0 ? ", " : "") << value;
  return "[" + text.str() + "]";
}

/// Returns a flaw of a motion, found in double precision by code that shares nothing with the
/// kernels, at `refinement` times the checker's resolution; nothing if it is free.
inline std::optional<std::string> motion_flaw(const CollisionChecker& checker,
                                              const Configuration& from, const Configuration& to,
                                              double refinement = 10) {
  const Robot& robot = checker.robot();
  const Configuration delta = robot.difference(from, to);
  const double length = robot.distance(from, to);
  const int count =
      std::max(1, static_cast<int>(std::ceil(length * refinement / checker.resolution())));
  for (int i = 0; i <= count; ++i) {
    Configuration q = from;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * i / count;
    for (const Contact& contact : checker.contacts(q)) {
      return contact.link + " touches " + contact.other + " at " + to_text(q) + " by " +
             std::to_string(contact.distance);
    }
  }
  return std::nullopt;
}

/// The same of a path, and whether its configurations are within the limits.
inline std::optional<std::string> path_flaw(const CollisionChecker& checker, const Path& path,
                                            double refinement = 10) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (auto flaw = checker.robot().describe_violation(path[i], "waypoint")) return flaw;
    if (i == 0) continue;
    if (auto flaw = motion_flaw(checker, path[i - 1], path[i], refinement)) {
      return "motion " + std::to_string(i - 1) + ": " + *flaw;
    }
  }
  return std::nullopt;
}

/// A random configuration without contact.
inline Configuration random_free_configuration(const CollisionChecker& checker, Rng& rng) {
  for (int i = 0; i < 100000; ++i) {
    Configuration q = random_configuration(checker.robot(), rng);
    if (checker.is_valid(std::span<const double>(q)) && checker.contacts(q).empty()) return q;
  }
  FAIL("no free configuration in 100000 tries");
  return {};
}

}  // namespace mneme::test
