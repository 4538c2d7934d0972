// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/installation.h"

#include <doctest/doctest.h>

namespace mneme {

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

}  // namespace mneme
