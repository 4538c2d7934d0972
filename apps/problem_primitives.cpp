// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "problem_primitives.h"

#include "console.h"

#include <fmt/format.h>

namespace mneme::app {

std::string describe(const Scene& scene, const LocalPrimitive& primitive, std::size_t index) {
  if (primitive.is_whole_query) return fmt::format("query to goal {}", index + 1);
  std::string names;
  for (const int obstacle : primitive.obstacles) {
    names += names.empty() ? "" : " and ";
    names += printable(scene.obstacles.at(static_cast<std::size_t>(obstacle)).name);
  }
  return names;
}

std::string_view unit_of_error(const LocalPrimitive& primitive) {
  return primitive.is_whole_query ? "rad^2" : "m^2";
}

}  // namespace mneme::app
