// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/tree_builder.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::InputValue;
using internal::TreeBuilder;

/// The message with which `build` fails.
template <class Build>
std::string failure(Build&& build) {
  const auto result = internal::without_throwing([&] {
    TreeBuilder tree("f", 4);
    build(tree);
    return 0;
  });
  return result ? "" : result.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("values that are opened within others are put into them") {
    TreeBuilder tree("f", 100);
    tree.open(1, InputValue::Map{});
    CHECK(tree.is_key_next());
    tree.set_key(2, "k");
    CHECK_FALSE(tree.is_key_next());
    CHECK(tree.key_line() == 2);
    tree.open(2, InputValue::List{});
    CHECK_FALSE(tree.key_line());
    tree.open(3, 7.0);
    CHECK(tree.close().line == 3);
    tree.close();
    tree.close();
    const InputValue root = tree.take();
    const auto& map = std::get<InputValue::Map>(root.content);
    REQUIRE(map.size() == 1);
    CHECK(map[0].key == "k");
    CHECK(std::get<InputValue::List>(map[0].value.content).size() == 1);
  }

  TEST_CASE("a tree of more values than allowed is refused") {
    CHECK(failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::List{});
            tree.count(2, 3);
          }).empty());
    CHECK(failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::List{});
            tree.count(2, 4);
          }) == "f:2: expected at most 4 values");
  }

  TEST_CASE("a value where a key must stand, and a doubled key, are refused") {
    CHECK(failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::Map{});
            tree.open(2, InputValue::List{});
          }) == "f:2: expected a key that is a text");
    CHECK(failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::Map{});
            tree.set_key(1, "k");
            tree.open(1, 1.0);
            tree.close();
            tree.set_key(2, "k");
          }) == "f:2: key k: expected once, got a second time");
  }
}

}  // namespace
}  // namespace mneme::test
