// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "support/environment.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <cctype>
#include <filesystem>
#include <string>

namespace mneme {

using test::contains;
using test::require;
using test::require_error;

TEST_SUITE("unit") {
  TEST_CASE("the version is three numbers joined by dots") {
    const std::string text(version());
    int dots = 0;
    for (const char c : text) {
      dots += c == '.' ? 1 : 0;
      CHECK((c == '.' || std::isdigit(static_cast<unsigned char>(c)) != 0));
    }
    CHECK(dots == 2);
    CHECK(contains(test::read_file(test::source_file("CMakeLists.txt")), "VERSION " + text));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("data lies beside the bin or lib that a file is installed in") {
    CHECK(internal::shared_data_of("/usr/bin/mneme") == "/usr/share/mneme");
    CHECK(internal::shared_data_of("/opt/x/lib/python3/dist-packages/mneme/_mneme.so") ==
          "/opt/x/share/mneme");
    CHECK(internal::shared_data_of("/home/bin/y/bin/mneme") == "/home/bin/y/share/mneme");
    CHECK(internal::shared_data_of("/home/me/mneme/build/release/mneme").empty());
    CHECK(internal::shared_data_of("bin/mneme").empty());
    CHECK(internal::shared_data_of("").empty());
    CHECK(internal::shared_data_of("/").empty());
  }
}

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

TEST_SUITE("unit") {
  TEST_CASE("problems that came with mneme are found by name") {
    CHECK(load_problem(require(find_scene("planar/threaded_b2.yaml"))).has_value());
  }

  TEST_CASE("an unknown scene is an error that names the directories") {
    for (const char* name : {"planar/no_such.yaml", "planar", ""}) {
      const Error error = require_error(find_scene(name));
      CHECK(error.code == ErrorCode::io);
      CHECK(contains(error.message, "/scenes"));
    }
  }
}

}  // namespace
}  // namespace mneme

namespace mneme::test {
TEST_SUITE("unit") {
  TEST_CASE("the cache stands where the environment says, if that is an absolute path") {
    const EnvironmentVariable home("HOME", "/home/me");
    {
      const EnvironmentVariable cache("XDG_CACHE_HOME", "/var/cache/me");
      CHECK(internal::cache_directory() == "/var/cache/me/mneme");
    }
    for (const char* none : {"", "relative"}) {
      const EnvironmentVariable cache("XDG_CACHE_HOME", none);
      CHECK(internal::cache_directory() == "/home/me/.cache/mneme");
    }
  }

  TEST_CASE("without a home there is no cache") {
    const EnvironmentVariable cache("XDG_CACHE_HOME", "");
    const EnvironmentVariable home("HOME", "");
    CHECK(internal::cache_directory().empty());
  }
}

}  // namespace mneme::test
