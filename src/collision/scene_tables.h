// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Builds the kernels' tables of a scene.
#pragma once

#include "collision/tables.h"
#include "mneme/scene.h"

namespace mneme::internal {

/// Errors: an obstacle without shapes, not finite, too far away, or without a positive size.
[[nodiscard]] Result<SceneTables> make_scene_tables(const Scene& scene);

}  // namespace mneme::internal
