// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/environment.h"
#include "support/support.h"

#include <filesystem>

namespace mneme {
namespace {

namespace fs = std::filesystem;

TEST_SUITE("unit") {
  TEST_CASE("installations of XDG_DATA_DIRS come last") {
    const test::TemporaryDirectory shared;
    fs::create_directories(shared / "mneme/robots");
    const test::EnvironmentVariable variable("XDG_DATA_DIRS", "relative:/nowhere:" + (shared / ""));
    const std::vector<std::string> directories = data_directories();
    REQUIRE(directories.size() >= 2);
    CHECK(fs::equivalent(directories.back(), shared / "mneme"));
  }

  TEST_CASE("a program of the build tree finds the robots and scenes of the source tree") {
    const std::vector<std::string> directories = data_directories();
    REQUIRE_FALSE(directories.empty());
    CHECK(fs::equivalent(directories.front(), test::source_file("")));
    for (const std::string& directory : directories) CHECK(fs::is_directory(directory));
    CHECK(fs::is_regular_file(directories.front() + "/scenes/planar/grid.yaml"));
  }
}

}  // namespace
}  // namespace mneme
