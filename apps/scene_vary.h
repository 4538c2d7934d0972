// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene vary.
#pragma once

#include "commands.h"

namespace mneme::app {

void add_scene_vary(CLI::App& group, Action& action);

}  // namespace mneme::app
