// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots that come with mneme.
#pragma once

#include "support/planar_memory.h"

#include <string>

namespace mneme::test {

inline Robot known_robot(const std::string& name) {
  auto robot = find_robot(name).and_then([](const std::string& path) { return load_robot(path); });
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return *std::move(robot);
}

}  // namespace mneme::test
