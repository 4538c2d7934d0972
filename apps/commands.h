// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The subcommands. To add one: cmd_<verb>.cpp, a declaration here, a call in main.cpp.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "exit_codes.h"

namespace mneme::app {

/// What remains to be done once the command line is parsed. An error becomes a message and an exit
/// code.
using Action = std::function<Result<ExitCode>()>;

// Each adds its flags to the program; if it is the subcommand chosen, parsing sets `action`.
void add_demo(CLI::App& program, Action& action);
void add_plan(CLI::App& program, Action& action);
void add_learn(CLI::App& program, Action& action);
void add_db(CLI::App& program, Action& action);
void add_robot(CLI::App& program, Action& action);
void add_scene(CLI::App& program, Action& action);
void add_bench(CLI::App& program, Action& action);
void add_view(CLI::App& program, Action& action);
void add_doctor(CLI::App& program, Action& action);
void add_completion(CLI::App& program, Action& action);
void add_manual(CLI::App& program, Action& action);

}  // namespace mneme::app
