// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "commands.h"

namespace mneme::app {

/// mneme scene threaded: random problems of a planar arm threaded through a gap.
void add_scene_threaded(CLI::App& group, Action& action);

}  // namespace mneme::app
