// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The projection of points onto solids.
#pragma once

#include "mneme/geometry.h"

namespace mneme::internal {

/// The point of a solid that is nearest to `p`: `p` itself inside.
[[nodiscard]] Vec3 nearest_point(const Vec3& p, const Shape& shape);

}  // namespace mneme::internal
