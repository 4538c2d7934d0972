// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots that come with mneme.
#pragma once

#include "support/planar_memory.h"

#include <string>

namespace mneme::test {

inline Robot known_robot(const std::string& name) {
  return require(load_robot(require(find_robot(name))));
}

}  // namespace mneme::test
