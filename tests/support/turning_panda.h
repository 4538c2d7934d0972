// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A Panda whose last joint turns without limits.
#pragma once

#include "support/support.h"

#include <string>

namespace mneme::test {

/// Writes panda.urdf and panda.srdf into the directory.
inline void write_turning_panda(const TemporaryDirectory& directory) {
  std::string urdf = read_file(source_file("robots/panda.urdf"));
  const std::string last = "panda_joint7\" type=\"revolute";
  REQUIRE(contains(urdf, last));
  urdf.replace(urdf.find(last), last.size(), "panda_joint7\" type=\"continuous");
  write_file(directory / "panda.urdf", urdf);
  write_file(directory / "panda.srdf", read_file(source_file("robots/panda.srdf")));
}

}  // namespace mneme::test
