// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/scene_image.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {

PrimitiveKey circles_of(const Scene& scene) {
  PrimitiveKey circles;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        circles.insert(circles.end(), {sphere->center.x(), sphere->center.y(), sphere->radius});
      }
    }
  }
  return circles;
}

double mean_direction(const PrimitiveKey& circles) {
  double x = 0, y = 0;
  for (std::size_t i = 0; i + 2 < circles.size(); i += 3) {
    x += circles[i];
    y += circles[i + 1];
  }
  return std::atan2(y, x);
}

std::vector<float> draw_image(const PrimitiveKey& circles, int cells, double half_extent) {
  const double side = 2 * half_extent / cells;
  std::vector<float> image;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const double x = (column + 0.5) * side - half_extent;
      const double y = (row + 0.5) * side - half_extent;
      double inside = 0;
      for (std::size_t i = 0; i + 2 < circles.size(); i += 3) {
        const double distance = std::hypot(x - circles[i], y - circles[i + 1]) - circles[i + 2];
        inside = std::max(inside, std::clamp(0.5 - distance / side, 0.0, 1.0));
      }
      image.push_back(static_cast<float>(inside));
    }
  }
  return image;
}

}  // namespace mneme::internal
