// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/link_solid.h"

#include "mneme/check.h"

#include "base/as_index.h"
#include "geometry/solid_distance.h"
#include "robot/link_shapes.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {

LinkSolid::LinkSolid(const Link& link, const Transform& X_WL) : shapes_(shapes_of(link, X_WL)) {
  if (!link.cover) return;
  const auto cover_end = shapes_.begin() + std::ssize(link.spheres);
  shapes_.erase(cover_end - link.cover->sphere_count, cover_end);
  surfaces_.push_back(std::get<Mesh>(transformed(X_WL, link.cover->surface)));
}

double LinkSolid::distance_to(const Shape& shape) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& own : shapes_) {
    least = std::min(least, distance_to_segment(own.a, own.b, shape) - own.radius);
  }
  for (const Mesh& surface : surfaces_) {
    least = std::min(least, distance_to_solid(surface, shape));
  }
  return std::max(0.0, least);
}

double LinkSolid::distance_to(const LinkSolid& other) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& shape : other.shapes_) least = std::min(least, distance_to(shape));
  for (const Mesh& surface : other.surfaces_) least = std::min(least, distance_to(surface));
  // A surface says nothing of what lies inside of it.
  for (const Mesh& surface : surfaces_) least = std::min(least, other.distance_to(surface));
  return least;
}

}  // namespace mneme::internal

namespace mneme {

std::optional<CoveredContact> look_behind_covers(const Robot& robot, const Scene& scene,
                                                 std::span<const double> q,
                                                 const Contact& contact) {
  const std::vector<Transform> poses = robot.link_poses(q);
  CoveredContact result;
  const auto solid_of = [&](const std::string& name) {
    const int i = robot.find_link(name).value();
    const Link& link = robot.links()[internal::as_index(i)];
    result.covers += link.cover ? 1 : 0;
    result.excess += link.cover ? link.cover->excess : 0;
    return internal::LinkSolid(link, poses[internal::as_index(i)]);
  };
  const internal::LinkSolid solid = solid_of(contact.link);
  if (contact.is_self) {
    const internal::LinkSolid other = solid_of(contact.other);
    if (result.covers == 0) return std::nullopt;
    result.distance = solid.distance_to(other);
    return result;
  }
  if (result.covers == 0) return std::nullopt;
  result.distance = std::numeric_limits<double>::infinity();
  for (const Shape& shape : scene.find(contact.other)->shapes) {
    result.distance = std::min(result.distance, solid.distance_to(shape));
  }
  return result;
}

}  // namespace mneme
