// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::InputValue;

std::string yaml_failure(const std::string& yaml) {
  const auto result =
      internal::without_throwing([&] { return internal::parse_yaml(yaml, "f.yaml"); });
  return result ? "" : result.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("values carry their lines, from 1") {
    const InputValue value = internal::parse_yaml("a: 1\nb:\n  - x\n  - {c: 2}\n", "f");
    const auto& map = std::get<InputValue::Map>(value.content);
    CHECK(map[0].value.line == 1);
    const auto& list = std::get<InputValue::List>(map[1].value.content);
    CHECK(list[0].line == 3);
    CHECK(list[1].line == 4);
  }

  TEST_CASE("a value that was left out is nothing, at the line of its key") {
    const InputValue value = internal::parse_yaml("a: 1\nb:\n", "f");
    const auto& entry = std::get<InputValue::Map>(value.content)[1];
    CHECK(std::holds_alternative<std::monostate>(entry.value.content));
    CHECK(entry.value.line == 2);
  }

  TEST_CASE("an empty text is nothing") {
    CHECK(std::holds_alternative<std::monostate>(internal::parse_yaml("", "f").content));
    CHECK(std::holds_alternative<std::monostate>(internal::parse_yaml("# remark\n", "f").content));
  }

  TEST_CASE("malformed text is refused with file, line and reason") {
    CHECK(yaml_failure("a: 1\nb: [1, 2\nc: 3\n").substr(0, 24) == "f.yaml:3: expected YAML:");
    CHECK(yaml_failure("a: 1\n\tb: 2\n").substr(0, 9) == "f.yaml:2:");
    CHECK(yaml_failure("a: *nowhere\n").substr(0, 24) == "f.yaml:1: expected YAML:");
  }

  TEST_CASE("a doubled key is refused") {
    CHECK(yaml_failure("a: 1\nb: 2\na: 3\n") == "f.yaml:3: key a: expected once, got a second time");
  }

  TEST_CASE("a key that is no text is refused") {
    CHECK(yaml_failure("[1, 2]: 3\n") == "f.yaml:1: expected a key that is a text");
  }

  TEST_CASE("a second document is refused") {
    CHECK(yaml_failure("a: 1\n---\nb: 2\n") ==
          "f.yaml:2: expected the end of the text after one YAML document");
  }

  TEST_CASE("deep nesting is refused, however it is written") {
    const std::string depth = "nested at most 64 deep";
    CHECK(yaml_failure(std::string(100, '[') + std::string(100, ']')).find(depth) != std::string::npos);
    CHECK_FALSE(yaml_failure(std::string(100000, '[')).empty());
    std::string dashes;
    for (int i = 0; i < 20000; ++i) dashes += "- ";
    CHECK_FALSE(yaml_failure(dashes + "1").empty());
  }

  TEST_CASE("an alias stands for the anchored value") {
    const InputValue value = internal::parse_yaml("a: &x [1, {b: 2}]\nc: *x\nd: &x 3\ne: *x", "f");
    const auto& map = std::get<InputValue::Map>(value.content);
    CHECK(std::get<InputValue::List>(map[1].value.content).size() == 2);
    CHECK(map[1].value.line == 2);
    CHECK(std::get<InputValue::Text>(map[3].value.content).text == "3");
    CHECK(yaml_failure("&a [*a]") == "f.yaml:1: expected an alias of a value that has ended");
  }

  TEST_CASE("stray brackets after or before the document are refused") {
    for (const char* text : {"]", "a: 1\n]", "}}", "[1] 2", "{a: 1} ]"}) {
      CAPTURE(text);
      CHECK(yaml_failure(text).substr(0, 7) == "f.yaml:");
    }
    CHECK(yaml_failure("--- {a: 1}\n...\n# remark\n").empty());
  }

  TEST_CASE("aliases that expand to too many values are refused") {
    std::string bomb = "a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n";
    for (int i = 1; i <= 8; ++i) {
      const std::string last = "*a" + std::to_string(i - 1);
      bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
      for (int j = 0; j < 10; ++j) bomb += last + (j < 9 ? ", " : "]\n");
    }
    CHECK(yaml_failure(bomb).find("expected at most 4000000 values") != std::string::npos);
  }
}

}  // namespace
}  // namespace mneme::test
