// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/compact_file.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::close_names;
using internal::edit_distance;

TEST_SUITE("unit") {
  TEST_CASE("edits are insertions, deletions and replacements, whatever the case") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("abc", "") == 3);
    CHECK(edit_distance("", "ab") == 2);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("S1", "s1") == 0);
  }

  TEST_CASE("the closest names come first, and ties keep their order") {
    CHECK(close_names("s2", {"S1", "B2", "S2", "long name"}, 3) ==
          std::vector<std::string>{"S2", "S1", "B2"});
    CHECK(close_names("x", {"a"}, 3) == std::vector<std::string>{"a"});
    CHECK(close_names("x", {}, 3).empty());
  }
}

}  // namespace
}  // namespace mneme::test
