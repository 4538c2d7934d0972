// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace mneme::internal {
namespace {

using Key = std::array<int, 3>;
using Groups = std::map<Key, Element>;

Key key_of(const Vec3& point, double size) {
  const Vec3 cell = (point / size).array().floor();
  return {static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())};
}

/// A ball around the mean of the balls' centres.
Sphere bound(std::span<const Sphere> balls) {
  Sphere result;
  for (const Sphere& ball : balls) result.center += ball.center / static_cast<double>(balls.size());
  for (const Sphere& ball : balls) {
    result.radius = std::max(result.radius, (ball.center - result.center).norm() + ball.radius);
  }
  return result;
}

/// True if the sphere about the same centre that is smaller by `margin` holds the point.
bool holds(const Sphere& sphere, const Vec3& point, double margin) {
  const double reach = sphere.radius - margin;
  return reach >= 0 && (point - sphere.center).squaredNorm() <= reach * reach;
}

void drop_equal(std::vector<Sphere>& balls) {
  const auto key = [](const Sphere& s) {
    return std::array{s.center.x(), s.center.y(), s.center.z(), s.radius};
  };
  std::ranges::sort(balls, {}, key);
  const auto are_equal = [&](const Sphere& a, const Sphere& b) { return key(a) == key(b); };
  balls.erase(std::unique(balls.begin(), balls.end(), are_equal), balls.end());
}

void add_to(std::vector<Element>& elements, Groups groups) {
  for (auto& [key, element] : groups) {
    drop_equal(element.balls);
    element.bound = bound(element.balls);
    elements.push_back(std::move(element));
  }
}

}  // namespace

double Element::reach_from(const Vec3& center) const {
  double reach = 0;
  for (const Sphere& ball : balls) {
    reach = std::max(reach, (ball.center - center).norm() + ball.radius);
  }
  return reach;
}

bool Element::is_within(const Sphere& sphere) const {
  if (!holds(sphere, bound.center, 0)) return false;
  if (holds(sphere, bound.center, bound.radius)) return true;
  return std::ranges::all_of(
      balls, [&](const Sphere& ball) { return holds(sphere, ball.center, ball.radius); });
}

std::vector<Element> make_elements(const TriangleMesh& mesh, const SolidModel& solid, double size) {
  Groups surface;
  for (const Triangle& t : subdivide(mesh, size)) {
    std::vector<Sphere>& balls = surface[key_of(t.centroid(), size)].balls;
    for (const Vec3& corner : {t.a, t.b, t.c}) balls.push_back({corner, 0});
  }
  Groups inside;
  const double half_diagonal = 0.5 * std::sqrt(3.0) * solid.cell_size();
  for (const SolidModel::Cell& cell : solid.inner_cells()) {
    inside[key_of(cell.center, size)].balls.push_back(
        {cell.center, cell.is_whole ? half_diagonal : 0.0});
  }
  std::vector<Element> elements;
  add_to(elements, std::move(surface));
  add_to(elements, std::move(inside));
  return elements;
}

}  // namespace mneme::internal
