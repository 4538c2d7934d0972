// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Control-C asks the running command to come to an orderly end; a second one ends the program.
#pragma once

#include <atomic>

namespace mneme::app {

void catch_interrupts();
/// Becomes true at the first interrupt.
[[nodiscard]] const std::atomic<bool>* interrupt_flag();

}  // namespace mneme::app
