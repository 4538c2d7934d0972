// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A link's solids as one surface.
#pragma once

#include "covering/triangle_mesh.h"

namespace mneme::internal {

/// The triangles of all solids of `link`, in its frame. Errors name the link, and the mesh file if
/// that is wrong: see read_mesh; solids that are not finite or have no surface.
[[nodiscard]] Result<TriangleMesh> link_surface(const Link& link);

}  // namespace mneme::internal
