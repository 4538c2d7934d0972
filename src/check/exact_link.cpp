// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/check.h"

#include "base/as_index.h"
#include "check/link_distances.h"
#include "geometry/solids.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {

ExactLink::ExactLink(const Link& link) : shapes_(shapes_of(link)) {
  if (!link.approximation) return;
  shapes_.erase(shapes_.end() - link.approximation->capsule_count, shapes_.end());
  const auto spheres_end = shapes_.begin() + std::ssize(link.spheres);
  shapes_.erase(spheres_end - link.approximation->sphere_count, spheres_end);
  surfaces_.push_back(link.approximation->surface);
}

double ExactLink::distance_to(const Shape& shape) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& own : shapes_) {
    least = std::min(least, distance_to_segment(own.a, own.b, shape) - own.radius);
  }
  for (const Mesh& surface : surfaces_) {
    least = std::min(least, distance_to_solid(surface, shape));
  }
  return std::max(0.0, least);
}

double ExactLink::distance_to(const ExactLink& other, const Transform& X_LO, double enough) const {
  // The limit must be positive, so that a contact is found, not cut off.
  constexpr double kSome = 1e-3;
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& shape : other.shapes_) {
    least = std::min(least, distance_to(transformed(X_LO, shape)));
  }
  for (const Mesh& theirs : other.surfaces_) {
    const Mesh surface = std::get<Mesh>(transformed(X_LO, theirs));
    for (const Capsule& shape : shapes_) least = std::min(least, distance_to_solid(surface, shape));
    for (const Mesh& own : surfaces_) {
      least = std::min(least, distance_between_solids(own, surface, enough + kSome));
    }
  }
  return least;
}

bool ExactLink::may_enclose(const Shape& shape) const {
  return std::ranges::any_of(
      surfaces_, [&](const Mesh& surface) { return internal::may_enclose(surface, shape); });
}

bool ExactLink::may_enclose(const ExactLink& other, const Transform& X_LO) const {
  const auto encloses = [&](const auto& shape) { return may_enclose(transformed(X_LO, shape)); };
  return !surfaces_.empty() && (std::ranges::any_of(other.shapes_, encloses) ||
                                std::ranges::any_of(other.surfaces_, encloses));
}

}  // namespace mneme::internal

namespace mneme {

std::optional<ExactContact> find_exact_contact(const Robot& robot, const Scene& scene,
                                               std::span<const double> q, const Contact& contact) {
  using internal::as_index, internal::ExactLink;
  const std::vector<Transform> poses = robot.link_poses(q);
  ExactContact result;
  const Obstacle* obstacle = scene.find(contact.other);
  const bool is_other_known =
      contact.is_self ? robot.find_link(contact.other).has_value() : obstacle != nullptr;
  if (!robot.find_link(contact.link) || !is_other_known) return std::nullopt;
  const auto look_at = [&](const std::string& name) {
    const std::size_t link = as_index(*robot.find_link(name));
    const std::optional<SphereApproximation>& approximation = robot.links()[link].approximation;
    result.approximated_links += approximation ? 1 : 0;
    result.excess += approximation ? approximation->excess : 0;
    return link;
  };
  const std::size_t link = look_at(contact.link);
  const std::size_t other = contact.is_self ? look_at(contact.other) : link;
  if (result.approximated_links == 0) return std::nullopt;
  const ExactLink exact(robot.links()[link]);
  const Transform X_LW = poses[link].inverse();
  if (contact.is_self) {
    result.distance = exact.distance_to(ExactLink(robot.links()[other]), X_LW * poses[other],
                                        std::numeric_limits<double>::infinity());
    return result;
  }
  result.distance = std::numeric_limits<double>::infinity();
  for (const Shape& shape : obstacle->shapes) {
    result.distance = std::min(result.distance, exact.distance_to(transformed(X_LW, shape)));
  }
  return result;
}

}  // namespace mneme
