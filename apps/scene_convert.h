// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene convert.
#pragma once

#include "commands.h"

namespace mneme::app {

void add_scene_convert(CLI::App& group, Action& action);

}  // namespace mneme::app
