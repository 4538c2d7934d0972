// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/near_pairs.h"

#include "geometry/solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace mneme::internal {
namespace {

/// The axis-aligned box around the bounding spheres of an obstacle's shapes.
struct Bounds {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());
  int index = 0;
};

std::vector<Bounds> bound_all(const Scene& scene) {
  std::vector<Bounds> result;
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    const Obstacle& obstacle = scene.obstacles[i];
    Bounds bounds;
    bounds.index = static_cast<int>(i);
    for (const Shape& shape : obstacle.shapes) {
      const Sphere ball = bounding_sphere(shape);
      bounds.lower = bounds.lower.cwiseMin(ball.center - Vec3::Constant(ball.radius));
      bounds.upper = bounds.upper.cwiseMax(ball.center + Vec3::Constant(ball.radius));
    }
    result.push_back(bounds);
  }
  return result;
}

/// The axis along which lower bounds differ most, for a sparse sweep.
Eigen::Index longest_axis(const std::vector<Bounds>& all) {
  Vec3 least = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 most = -least;
  for (const Bounds& bounds : all) {
    least = least.cwiseMin(bounds.lower);
    most = most.cwiseMax(bounds.lower);
  }
  Eigen::Index axis = 0;
  (most - least).maxCoeff(&axis);
  return axis;
}

struct Boxed {
  template <class Solid>
  Shape operator()(const Solid& solid) const {
    return solid;
  }
  template <class Part>
  Shape operator()(const CompoundShape<Part>& compound) const {
    return oriented_box(compound);
  }
};

bool are_near(const Bounds& a, const Bounds& b, double gap) {
  return (a.lower.array() <= b.upper.array() + gap).all() &&
         (b.lower.array() <= a.upper.array() + gap).all();
}

}  // namespace

std::optional<Scene> with_boxed_compounds(const Scene& scene) {
  const auto has_compound = [](const Obstacle& obstacle) {
    return std::ranges::any_of(obstacle.shapes, is_compound);
  };
  if (scene.obstacles.size() < 2 || std::ranges::none_of(scene.obstacles, has_compound)) return {};
  Scene boxed = scene;
  for (Obstacle& obstacle : boxed.obstacles) {
    for (Shape& shape : obstacle.shapes) shape = std::visit(Boxed{}, shape);
  }
  return boxed;
}

Result<std::vector<std::pair<int, int>>> find_near_pairs(const Scene& scene, double gap,
                                                         std::size_t most) {
  std::vector<std::pair<int, int>> pairs;
  if (scene.obstacles.empty()) return pairs;
  std::vector<Bounds> all = bound_all(scene);
  const Eigen::Index axis = longest_axis(all);
  std::ranges::sort(all, {}, [&](const Bounds& bounds) { return bounds.lower[axis]; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double end = all[i].upper[axis] + gap;
    for (std::size_t j = i + 1; j < all.size() && all[j].lower[axis] <= end; ++j) {
      if (!are_near(all[i], all[j], gap)) continue;
      pairs.emplace_back(std::minmax(all[i].index, all[j].index));
      if (pairs.size() > most) {
        return fail(ErrorCode::unsupported,
                    fmt::format("scene '{}': more than {} pairs of its {} obstacles are within {} "
                                "m of each other; lower max-gap or plan without memory",
                                scene.name, most, scene.obstacles.size(), gap));
      }
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

double obstacle_distance(const Obstacle& a, const Obstacle& b, double most) {
  double least = std::numeric_limits<double>::infinity();
  for (const Shape& first : a.shapes) {
    const Sphere around_first = bounding_sphere(first);
    for (const Shape& second : b.shapes) {
      const Sphere around = bounding_sphere(second);
      const double bound =
          (around.center - around_first.center).norm() - around.radius - around_first.radius;
      if (bound <= most) least = std::min(least, distance(first, second));
    }
  }
  return least;
}

}  // namespace mneme::internal
