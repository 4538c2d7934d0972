// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/base.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace mneme::bench {

/// Returns the value, or prints the error and ends the program.
template <class Value>
Value take(Result<Value> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "error: %s\n", result.error().message.c_str());
  std::exit(1);
}

}  // namespace mneme::bench
