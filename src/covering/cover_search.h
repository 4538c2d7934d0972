// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Few of many spheres that together hold all pieces: set cover.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mneme/base.h"

#include "covering/elements.h"

namespace mneme::internal {

/// Spheres about points on the solid's medial axis and on its surface, each as large as it may be
/// to stick out by at most `excess`: about any other point, such a sphere lies within one of these.
/// `medial_balls` are those of the solid.
[[nodiscard]] std::vector<Sphere> propose_spheres(const SolidModel& solid,
                                                  std::vector<Sphere> medial_balls,
                                                  std::span<const Element> elements, double excess,
                                                  Rng& rng);

/// A small subset of `proposals` that holds all `elements`: greedy, then improved by taking some
/// spheres away and covering what is bare again, until `effort` steps (about a nanosecond each) are
/// done. A piece that no proposal holds gets a sphere of its own. Deterministic given `rng`.
[[nodiscard]] std::vector<Sphere> choose_spheres(std::vector<Sphere> proposals,
                                                 std::span<const Element> elements,
                                                 std::int64_t effort, Rng& rng);

}  // namespace mneme::internal
