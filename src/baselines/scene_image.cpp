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
  const auto coordinate = [&](int cell) { return (cell + 0.5) * side - half_extent; };
  const auto cell_of = [&](double x) {
    return static_cast<int>(std::clamp((x + half_extent) / side, 0.0, static_cast<double>(cells)));
  };
  std::vector<float> image(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  for (std::size_t i = 0; i + 2 < circles.size(); i += 3) {
    const double x = circles[i], y = circles[i + 1], radius = circles[i + 2];
    const double reach = radius + side;  // no centre of a cell beyond is inside
    const int last_column = std::min(cells - 1, cell_of(x + reach));
    const int last_row = std::min(cells - 1, cell_of(y + reach));
    for (int row = cell_of(y - reach); row <= last_row; ++row) {
      for (int column = cell_of(x - reach); column <= last_column; ++column) {
        const double distance = std::hypot(coordinate(column) - x, coordinate(row) - y) - radius;
        const double inside = std::clamp(0.5 - distance / side, 0.0, 1.0);
        float& cell = image[static_cast<std::size_t>(row) * static_cast<std::size_t>(cells) +
                            static_cast<std::size_t>(column)];
        cell = std::max(cell, static_cast<float>(inside));
      }
    }
  }
  return image;
}

}  // namespace mneme::internal
