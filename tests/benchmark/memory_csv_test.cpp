// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include <doctest/doctest.h>

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("What was written of memories reads back") {
    const std::vector<MemoryRow> rows = {{"a, \"b\"", 800, 105838, 5200000, 13.25},
                                         {"c", 0, 0, 1, 0}};
    const std::string text = to_csv(rows);
    const auto read = parse_memory_csv(text, "m.csv");
    REQUIRE(read.has_value());
    CHECK(to_csv(*read) == text);
    CHECK((*read)[0].components == 105838);
    CHECK((*read)[0].learning_time_s == 13.25);
  }

  TEST_CASE("Files of other columns and broken lines are refused") {
    CHECK(parse_memory_csv("x\n", "m.csv").error().message.find("m.csv:1: expected the columns") ==
          0);
    const std::string text = to_csv(std::vector<MemoryRow>{{"a", 1, 2, 3, 4}});
    CHECK(parse_memory_csv(text + "b,1,x,3,4\n", "m.csv").error().message ==
          "m.csv: line 3: expected a name and four numbers of 0 or more");
    for (const char* time : {"nan", "inf", "-1"}) {
      CHECK_FALSE(parse_memory_csv(text + "b,1,2,3," + time + "\n", "m.csv").has_value());
    }
    CHECK(parse_memory_csv(text + "b,1\n", "m.csv").error().message.find("line 3") !=
          std::string::npos);
  }
}

}  // namespace
}  // namespace mneme
