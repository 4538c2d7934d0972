// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Control-C asks a command that heeds it to come to an orderly end; a second one ends the program.
#pragma once

#include <atomic>

namespace mneme::app {

/// From now on the caller heeds interrupt_flag(). Until the first call an interrupt ends the
/// program.
void catch_interrupts();
/// Becomes true at the first interrupt; catches interrupts if that was not asked for before.
[[nodiscard]] const std::atomic<bool>* interrupt_flag();

}  // namespace mneme::app
