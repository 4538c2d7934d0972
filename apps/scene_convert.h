// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene convert.
#pragma once

#include <string>

#include "mneme/scene.h"

#include "commands.h"

namespace mneme::app {

/// Text of a scene file; the frame, if there is one, as a remark.
[[nodiscard]] std::string to_scene_yaml(const FramedScene& scene);

void add_scene_convert(CLI::App& group, Action& action);

}  // namespace mneme::app
