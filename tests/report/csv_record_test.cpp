// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/csv_record.h"

#include <doctest/doctest.h>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Fields end at commas, lines at line feeds, unless they are quoted") {
    const std::string text = "a,\"b,\"\"c\"\"\nd\",\ne,f\n";
    const auto first = read_csv_record(text, 0);
    REQUIRE(first.has_value());
    CHECK(first->fields == std::vector<std::string>{"a", "b,\"c\"\nd", ""});
    const auto second = read_csv_record(text, first->end);
    REQUIRE(second.has_value());
    CHECK(second->fields == std::vector<std::string>{"e", "f"});
    CHECK(second->end == text.size());
    CHECK_FALSE(read_csv_record(text, second->end).has_value());
  }

  TEST_CASE("A line without an end is none") {
    CHECK_FALSE(read_csv_record("a,b", 0).has_value());
    CHECK_FALSE(read_csv_record("a,\"b\n", 0).has_value());
  }

  TEST_CASE("A number is all of its field") {
    double number = 0;
    CHECK(read_csv_number("1.5e3", number));
    CHECK(number == 1500);
    CHECK_FALSE(read_csv_number("1.5x", number));
    CHECK_FALSE(read_csv_number("", number));
    for (const char* text : {"nan", "inf", "-inf", "-1", "1e400"}) {
      CHECK_FALSE(read_csv_number(text, number));
    }
    int whole = 0;
    CHECK_FALSE(read_csv_number("-1", whole));
    CHECK_FALSE(read_csv_number("1.5", whole));
  }
}

}  // namespace
}  // namespace mneme::internal
