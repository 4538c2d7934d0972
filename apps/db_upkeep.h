// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme db verify, merge, export, import and compact.
#pragma once

#include "commands.h"

namespace mneme::app {

/// Adds the subcommands to `group`.
void add_db_upkeep(CLI::App& group, Action& action);

}  // namespace mneme::app
