// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/contacts.h"

#include <algorithm>
#include <limits>

#include "robot/link_shapes.h"

namespace mneme::internal {
namespace {

double distance_to_obstacle(const std::vector<Capsule>& link, const Obstacle& obstacle) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& own : link) {
    for (const Shape& shape : obstacle.shapes) {
      least = std::min(least, distance_to_segment(own.a, own.b, shape) - own.radius);
    }
  }
  return least;
}

double distance_between(const std::vector<Capsule>& first, const std::vector<Capsule>& second) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& p : first) {
    for (const Capsule& q : second) {
      least = std::min(least, segment_distance(p.a, p.b, q.a, q.b) - p.radius - q.radius);
    }
  }
  return least;
}

void add_obstacle_contacts(const std::vector<Capsule>& shapes, const std::string& link,
                           const Scene& scene, double margin, std::vector<Contact>& contacts) {
  for (const Obstacle& obstacle : scene.obstacles) {
    const double gap = distance_to_obstacle(shapes, obstacle);
    if (gap < margin) contacts.push_back({link, obstacle.name, false, gap});
  }
}

}  // namespace

std::vector<Contact> find_contacts(const Robot& robot, const Scene& scene,
                                   std::span<const double> q, double margin) {
  const std::vector<Transform> poses = robot.link_poses(q);
  std::vector<std::vector<Capsule>> shapes;
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Link& link = robot.links()[i];
    shapes.push_back(shapes_of(link, poses[i]));
    add_obstacle_contacts(shapes.back(), link.name, scene, margin, contacts);
  }
  for (const auto& [a, b] : robot.self_pairs()) {
    const double gap =
        distance_between(shapes[static_cast<std::size_t>(a)], shapes[static_cast<std::size_t>(b)]);
    if (gap < 0) {
      contacts.push_back({robot.links()[static_cast<std::size_t>(a)].name,
                          robot.links()[static_cast<std::size_t>(b)].name, true, gap});
    }
  }
  return contacts;
}

double least_distance(std::span<const Capsule> shapes, const Scene& scene) {
  double least = std::numeric_limits<double>::infinity();
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      const Sphere bound = bounding_sphere(shape);
      for (const Capsule& own : shapes) {
        const double away = (0.5 * (own.a + own.b) - bound.center).norm() -
                            0.5 * (own.b - own.a).norm() - own.radius - bound.radius;
        if (away >= least) continue;
        least = std::min(least, distance_to_segment(own.a, own.b, shape) - own.radius);
      }
    }
  }
  return least;
}

}  // namespace mneme::internal
