// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme robot spheres: covers the geometry of a robot with spheres, once and for all.
#pragma once

#include "commands.h"

namespace mneme::app {

/// Adds the subcommand to `mneme robot`.
void add_robot_spheres(CLI::App& group, Action& action);

}  // namespace mneme::app
