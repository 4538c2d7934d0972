// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include <doctest/doctest.h>

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("The machine is told by its processor, threads and system, on one line") {
    const std::string text = describe_machine();
    CHECK(text.find(" hardware threads, ") != std::string::npos);
    CHECK(text.find("Linux ") != std::string::npos);
    CHECK(text.find('\n') == std::string::npos);
    CHECK(describe_build().find("mneme " + std::string(version())) == 0);
  }

  TEST_CASE("Times are UTC in ISO 8601") {
    const std::string time = current_time();
    REQUIRE(time.size() == 20);
    CHECK(time.substr(0, 2) == "20");
    CHECK(time[10] == 'T');
    CHECK(time.back() == 'Z');
  }
}

}  // namespace
}  // namespace mneme
