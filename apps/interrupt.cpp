// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "interrupt.h"

#include <csignal>
#include <mutex>

namespace mneme::app {
namespace {

std::atomic<bool> is_interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers need a lock-free flag");

extern "C" void remember_interrupt(int) { is_interrupted = true; }

}  // namespace

void catch_interrupts() {
  static std::once_flag is_caught;
  std::call_once(is_caught, [] {
    struct sigaction handler = {};
    handler.sa_handler = remember_interrupt;
    handler.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    sigaction(SIGINT, &handler, nullptr);
  });
}

const std::atomic<bool>* interrupt_flag() {
  catch_interrupts();
  return &is_interrupted;
}

}  // namespace mneme::app
