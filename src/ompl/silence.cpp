// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/silence.h"

#include <ompl/util/Console.h>

#include <mutex>

namespace mneme::ompl {
namespace {

std::mutex mutex;
int count = 0;
::ompl::msg::OutputHandler* previous = nullptr;

}  // namespace

Silence::Silence() {
  const std::lock_guard lock(mutex);
  if (count++ > 0) return;
  previous = ::ompl::msg::getOutputHandler();
  ::ompl::msg::noOutputHandler();
}

Silence::~Silence() {
  const std::lock_guard lock(mutex);
  if (--count == 0) ::ompl::msg::useOutputHandler(previous);
}

}  // namespace mneme::ompl
