// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "base/fail.h"
#include "geometry/parts.h"
#include "geometry/solids.h"
#include "input/elided.h"
#include "scene/compound_files.h"
#include "scene/scene_input.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mneme {
namespace {

tl::unexpected<Error> refuse_edit(std::string_view name, std::string_view what) {
  return fail(ErrorCode::invalid, "obstacle \"{}\": {}",
              internal::elided(name, internal::kLongestName), internal::elided(what));
}

tl::unexpected<Error> refuse_unknown(const Scene& scene, std::string_view name) {
  return refuse_edit(name, fmt::format("there is none of this name in scene \"{}\"", scene.name));
}

template <class Obstacles>
auto* find_in(Obstacles& obstacles, std::string_view name) {
  const auto found = std::ranges::find(obstacles, name, &Obstacle::name);
  return found == obstacles.end() ? nullptr : &*found;
}

/// Removes the rounding that products of rotations accumulate.
void straighten(Shape& shape) {
  std::visit(
      [](auto& own) {
        if constexpr (requires { own.pose; }) {
          Eigen::Matrix3d& rotation = own.pose.rotation;
          if ((rotation.transpose() * rotation).isIdentity(1e-12)) return;
          rotation = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
        }
      },
      shape);
}

}  // namespace

Result<void> internal::check_shapes(const Obstacle& obstacle) {
  for (const Shape& shape : obstacle.shapes) {
    if (const std::string_view flaw = find_flaw(shape); !flaw.empty()) {
      return fail(ErrorCode::invalid, "obstacle '{}': {}", elided(obstacle.name, kLongestName),
                  said_of(shape, flaw));
    }
    const auto* cloud = std::get_if<PointCloud>(&shape);
    if (cloud == nullptr) continue;
    MNEME_TRY(check_point_count(obstacle.name, cloud->parts->list().size()));
  }
  return {};
}

Result<void> check_point_count(std::string_view obstacle, std::size_t points) {
  if (points <= internal::kMaxCloudPoints) return {};
  return fail(ErrorCode::unsupported, "obstacle '{}': expected at most {} points, got {}",
              internal::elided(obstacle, internal::kLongestName), internal::kMaxCloudPoints,
              points);
}

const Obstacle* Scene::find(std::string_view obstacle) const {
  return find_in(obstacles, obstacle);
}

Obstacle* Scene::find(std::string_view obstacle) { return find_in(obstacles, obstacle); }

std::optional<std::size_t> internal::ObstacleNames::find(const std::vector<Obstacle>& obstacles,
                                                         const std::string& name) {
  const bool is_known = data_ == obstacles.data() && size_ == obstacles.size();
  auto found = is_known ? positions_.find(name) : positions_.end();
  // Obstacles may have been replaced, or renamed, at the same place.
  if (!is_known || (found != positions_.end() && obstacles[found->second].name != name)) {
    positions_.clear();
    for (const Obstacle& obstacle : obstacles) {
      positions_.emplace(obstacle.name, positions_.size());
    }
    data_ = obstacles.data();
    size_ = obstacles.size();
    found = positions_.find(name);
  }
  return found == positions_.end() ? std::nullopt : std::optional(found->second);
}

void internal::ObstacleNames::add_last(const std::vector<Obstacle>& obstacles) {
  positions_.emplace(obstacles.back().name, obstacles.size() - 1);
  data_ = obstacles.data();
  size_ = obstacles.size();
}

Result<void> Scene::add(Obstacle obstacle) {
  if (obstacle.name.empty()) return refuse_edit("", "expected a name");
  if (obstacle.shapes.empty()) return refuse_edit(obstacle.name, "expected a shape");
  if (names.find(obstacles, obstacle.name)) {
    return refuse_edit(obstacle.name,
                       "expected a unique name; the scene has an obstacle of this name");
  }
  MNEME_TRY(internal::check_shapes(obstacle));
  obstacles.push_back(std::move(obstacle));
  names.add_last(obstacles);
  return {};
}

Result<void> Scene::add_shape(const std::string& obstacle, Shape shape) {
  const auto found = names.find(obstacles, obstacle);
  if (!found) return add({obstacle, {std::move(shape)}});
  MNEME_TRY(internal::check_shapes({obstacle, {shape}}));
  obstacles[*found].shapes.push_back(std::move(shape));
  return {};
}

void Scene::prepare(std::string_view obstacle) const {
  constexpr double kReach = 2.5;  // metres, with what checkers add
  const auto prepare_shape = [&](const auto& shape) {
    if constexpr (requires { shape.parts; }) {
      const internal::AxisBox region = internal::region_of_interest(shape, kReach);
      static_cast<void>(internal::share_grid(*shape.parts, region));
    }
  };
  const Obstacle* found = find(obstacle);
  if (found == nullptr) return;
  for (const Shape& shape : found->shapes) std::visit(prepare_shape, shape);
}

Result<void> Scene::remove(std::string_view obstacle) {
  const Obstacle* found = find(obstacle);
  if (found == nullptr) return refuse_unknown(*this, obstacle);
  std::erase_if(end_contacts, [&](const EndContact& contact) {
    return contact.first == found->name || contact.second == found->name;
  });
  obstacles.erase(obstacles.begin() + (found - obstacles.data()));
  return {};
}

Result<void> Scene::move(std::string_view obstacle, const Transform& X) {
  Obstacle* found = find(obstacle);
  if (found == nullptr) return refuse_unknown(*this, obstacle);
  if (!X.translation.allFinite() || !internal::is_rotation(X.rotation)) {
    return refuse_edit(obstacle, "expected a rigid motion of finite numbers");
  }
  for (Shape& shape : found->shapes) {
    shape = transformed(X, shape);
    straighten(shape);
  }
  return {};
}

Result<void> Scene::replace_points(std::string_view obstacle, std::size_t first,
                                   std::span<const CloudPoint> points) {
  Obstacle* found = find(obstacle);
  if (found == nullptr) return refuse_unknown(*this, obstacle);
  auto* cloud =
      found->shapes.size() == 1 ? std::get_if<PointCloud>(&found->shapes.front()) : nullptr;
  if (cloud == nullptr) return refuse_edit(obstacle, "expected one cloud of points");
  const std::size_t size = cloud->parts->list().size();
  if (first > size || points.size() > size - first) {
    return refuse_edit(obstacle, fmt::format("expected points {} to {} to be among the cloud's {}",
                                             first, first + points.size(), size));
  }
  for (const CloudPoint& p : points) {
    if (!std::ranges::all_of(p, [](float x) { return std::isfinite(x); })) {
      return refuse_edit(obstacle, "expected finite coordinates");
    }
  }
  internal::PartsAccess::replace(*cloud, first, points);
  return {};
}

}  // namespace mneme
