// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/text.h"
#include "support/support.h"

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

  TEST_CASE("a name is found whatever its case and underscores, or nothing if none is close") {
    const std::vector<std::string> names = {"rrt_connect", "rrt", "prm", "ompl:RRTConnect"};
    CHECK(did_you_mean("RRTConnect", names) == "; did you mean 'rrt_connect'?");
    CHECK(did_you_mean("ompl:rrt-connect", names) == "; did you mean 'ompl:RRTConnect'?");
    CHECK(did_you_mean("rt", names) == "; did you mean 'rrt'?");
    CHECK(did_you_mean("bit_star", names).empty());
    CHECK(did_you_mean("", names).empty());
    CHECK(did_you_mean("c", std::vector<std::string>{"a"}).empty());
    CHECK(did_you_mean("rrt", {}).empty());
  }

  TEST_CASE("names longer than 64 bytes are not compared") {
    const std::string longest(64, 'a'), longer(65, 'a'), huge(1'000'000, 'a');
    CHECK(did_you_mean(longest + "b", std::vector{longest}).empty());
    CHECK(did_you_mean(longest, std::vector{longer}).empty());
    CHECK(did_you_mean(huge, std::vector{huge + "b"}).empty());
    CHECK(did_you_mean(std::string(63, 'a'), std::vector{huge, longer, longest}) ==
          "; did you mean '" + longest + "'?");
    CHECK(close_names("a", {huge, "b"}, 2) == std::vector<std::string>{"b", huge});
    CHECK(close_names(huge, {huge, "b"}, 1) == std::vector{huge});
  }
}

}  // namespace
}  // namespace mneme::test
