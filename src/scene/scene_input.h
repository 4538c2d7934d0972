// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A scene as it stands in a scene file, or inside a problem file.
#pragma once

#include <string>

#include "mneme/scene.h"
#include "scene/input.h"

namespace mneme::internal {

/// Throws InputFailure. `default_name` is the name of a scene that gives none.
[[nodiscard]] Scene read_scene(const Input& input, const std::string& default_name);

}  // namespace mneme::internal
