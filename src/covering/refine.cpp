// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/refine.h"

#include <algorithm>
#include <array>
#include <limits>

namespace mneme::internal {
namespace {

constexpr int kRounds = 8;
constexpr double kFirstStep = 0.02;
constexpr double kLastStep = 0.0005;

using Pieces = std::vector<const Element*>;

double reach_from(const Vec3& center, const Pieces& pieces) {
  double reach = 0;
  for (const Element* piece : pieces) {
    // The ball around a piece tells most of those apart that are not the farthest.
    if ((piece->bound.center - center).norm() + piece->bound.radius <= reach) continue;
    reach = std::max(reach, piece->reach_from(center));
  }
  return reach;
}

/// Each piece goes to the sphere that holds it with most room to spare.
std::vector<Pieces> share_out(std::span<const Sphere> spheres, std::span<const Element> elements) {
  std::vector<Pieces> shares(spheres.size());
  for (const Element& element : elements) {
    std::size_t owner = 0;
    double most_room = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double distance = (element.bound.center - spheres[i].center).norm();
      if (spheres[i].radius - distance <= most_room) continue;
      const double room = spheres[i].radius - element.reach_from(spheres[i].center);
      if (room <= most_room) continue;
      most_room = room;
      owner = i;
    }
    shares[owner].push_back(&element);
  }
  return shares;
}

/// Descends along the axes from `center` with shrinking steps.
Sphere fit(const Vec3& start, const Pieces& pieces, const SolidModel& solid) {
  const auto rate = [&](const Vec3& center) {
    return reach_from(center, pieces) - solid.depth(center);
  };
  Vec3 center = start;
  double least = rate(center);
  for (double step = kFirstStep; step >= kLastStep; step *= 0.5) {
    for (bool has_moved = true; has_moved;) {
      has_moved = false;
      for (int i = 0; i < 6; ++i) {
        const Vec3 next = center + (i % 2 == 0 ? step : -step) * Vec3::Unit(i / 2);
        const double stick_out = rate(next);
        if (stick_out >= least - 0.01 * step) continue;
        least = stick_out;
        center = next;
        has_moved = true;
      }
    }
  }
  return {center, reach_from(center, pieces)};
}

}  // namespace

std::vector<Sphere> refine(std::vector<Sphere> spheres, std::span<const Element> elements,
                           const SolidModel& solid) {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Pieces> shares = share_out(spheres, elements);
    std::vector<Sphere> next;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      if (!shares[i].empty()) next.push_back(fit(spheres[i].center, shares[i], solid));
    }
    spheres = std::move(next);
  }
  return spheres;
}

}  // namespace mneme::internal
