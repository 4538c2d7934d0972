// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/input.h"
#include "scene/yaml.h"

#include <doctest/doctest.h>

#include <cmath>

namespace mneme::test {
namespace {

const std::string kSource = "f";

using internal::Input;

/// Applies `read` to the YAML text and returns the message of its failure, or "" if there is none.
template <class Read>
std::string failure(const std::string& yaml, Read&& read) {
  const auto result = internal::without_throwing([&] {
    const auto value = internal::parse_yaml(yaml, "f");
    read(Input(value, kSource));
    return 0;
  });
  return result ? "" : result.error().message;
}

double number(const std::string& yaml) {
  const auto value = internal::parse_yaml(yaml, "f");
  return Input(value, kSource).number();
}

TEST_SUITE("unit") {
  TEST_CASE("numbers are those of YAML") {
    CHECK(number("1") == 1.0);
    CHECK(number("-2.5e-3") == -2.5e-3);
    CHECK(number("+.5") == 0.5);
    CHECK(number("-.inf") == -INFINITY);
    CHECK(std::isnan(number(".nan")));
  }

  TEST_CASE("what only looks like a number is none") {
    for (const char* text : {"nan", "inf", "1.5x", "1 2", "0x10", "'1'", "-", "--1", "1e999",
                             "true", "1,5", "[1]", "~"}) {
      CAPTURE(text);
      const auto message = failure(text, [](const Input& i) { static_cast<void>(i.number()); });
      CHECK(message.substr(0, 26) == "f:1: expected a number, go");
    }
  }

  TEST_CASE("a failure names the way to the value, and the value") {
    const std::string yaml = "x:\n  - {y: [1,\n   abc]}\n";
    CHECK(failure(yaml, [](const Input& i) {
            static_cast<void>(i.at("x").items()[0].at("y").numbers());
          }) == "f:3: key x[0].y[1]: expected a number, got \"abc\"");
  }

  TEST_CASE("finite and positive numbers are told from the others") {
    const auto finite = [](const Input& i) { static_cast<void>(i.finite_number()); };
    const auto positive = [](const Input& i) { static_cast<void>(i.positive_number()); };
    CHECK(failure(".inf", finite) == "f:1: expected a finite number, got .inf");
    CHECK(failure("0", positive) == "f:1: expected a number above 0, got 0");
    CHECK(failure("0", finite).empty());
    CHECK(failure("1e-9", positive).empty());
  }

  TEST_CASE("a list of the wrong length says which length was expected") {
    CHECK(failure("[1, 2]", [](const Input& i) {
            static_cast<void>(i.finite_numbers(3, "x, y, z"));
          }) == "f:1: expected 3 numbers (x, y, z), got a list of 2");
  }

  TEST_CASE("a missing key is named where it was expected") {
    CHECK(failure("a:\n  b: 1", [](const Input& i) { static_cast<void>(i.at("a").at("c")); }) ==
          "f:2: key a: expected the key c, which is missing");
  }

  TEST_CASE("an unknown key is refused with those that are known") {
    CHECK(failure("a: 1\nc: 2", [](const Input& i) {
            i.allow_keys({"a", "b"});
          }) == "f:2: key c: unknown key, expected one of a, b");
  }

  TEST_CASE("maps, lists and texts are not taken for each other") {
    CHECK(failure("[1]", [](const Input& i) { static_cast<void>(i.find("a")); }) ==
          "f:1: expected a map, got a list of 1");
    CHECK(failure("{a: 1}", [](const Input& i) { static_cast<void>(i.items()); }) ==
          "f:1: expected a list, got a map");
    CHECK(failure("{a: 1}", [](const Input& i) { static_cast<void>(i.text()); }) ==
          "f:1: expected a text, got a map");
  }

  TEST_CASE("a long text is cut in the message") {
    CHECK(failure(std::string(1000, 'x'), [](const Input& i) { static_cast<void>(i.number()); }) ==
          "f:1: expected a number, got \"" + std::string(40, 'x') + "...\"");
  }
}

}  // namespace
}  // namespace mneme::test
