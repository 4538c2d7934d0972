// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Spheres of a cover moved and shrunk until they stick out less.
#pragma once

#include <span>
#include <vector>

#include "covering/elements.h"

namespace mneme::internal {

/// The same cover with each sphere shrunk to the pieces that need it and moved to where it sticks
/// out least, in turns. What `spheres` hold stays held; a sphere that nothing needs is dropped.
[[nodiscard]] std::vector<Sphere> refine(std::vector<Sphere> spheres,
                                         std::span<const Element> elements,
                                         const SolidModel& solid);

}  // namespace mneme::internal
