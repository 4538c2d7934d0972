// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/installation.h"
#include "support/environment.h"

#include <doctest/doctest.h>

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
