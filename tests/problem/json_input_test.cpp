// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "problem/compact_file.h"

#include <doctest/doctest.h>

#include <cstdint>

namespace mneme::test {
namespace {

const std::string kSource = "f";

using internal::Input;
using internal::InputValue;

std::string failure(const std::string& json) {
  const auto result =
      internal::without_throwing([&] { return internal::parse_json(json, "f.json"); });
  return result ? "" : result.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("values are read with their types") {
    const InputValue value =
        internal::parse_json(R"({"a": [1, -2, 0.5, 1e3], "b": "1", "c": null, "d": true})", "f");
    const Input input(value, kSource);
    CHECK(input.at("a").numbers() == std::vector<double>{1, -2, 0.5, 1000});
    CHECK(input.at("b").text() == "1");
    CHECK(input.entries().size() == 4);
    const auto number = internal::without_throwing([&] { return input.at("b").number(); });
    REQUIRE_FALSE(number.has_value());
    CHECK(number.error().message == "f:1: key b: expected a number, got \"1\"");
  }

  TEST_CASE("every kind of value carries its line") {
    const InputValue value =
        internal::parse_json("{\n\"a\":\n1\n,\n\"b\":\n\"x\",\"c\":[\n2\n,3\n]\n}", "f");
    const auto& map = std::get<InputValue::Map>(value.content);
    CHECK(value.line == 1);
    CHECK(map[0].value.line == 3);
    CHECK(map[1].value.line == 6);
    CHECK(map[2].value.line == 6);
    const auto& list = std::get<InputValue::List>(map[2].value.content);
    CHECK(list[0].line == 7);
    CHECK(list[1].line == 8);
  }

  TEST_CASE("malformed text is refused with file, line and reason") {
    CHECK(failure("{\n\"a\": [1, 2,\n}").substr(0, 44) ==
          "f.json:3: expected JSON: syntax error while ");
    CHECK(failure("").substr(0, 25) == "f.json:1: expected JSON: ");
    CHECK(failure("[1] 2").substr(0, 25) == "f.json:1: expected JSON: ");
    CHECK(failure("[NaN]").substr(0, 25) == "f.json:1: expected JSON: ");
    CHECK(failure("[1,\n\n1e999]") == "f.json:3: expected JSON: number overflow parsing '1e999'");
    CHECK(failure("[\"\xff\"]").substr(0, 25) == "f.json:1: expected JSON: ");
  }

  TEST_CASE("doubled keys and deep nesting are refused") {
    CHECK(failure("{\"a\": 1,\n\"a\": 2}") == "f.json:2: key a: expected once, got a second time");
    CHECK(failure(std::string(100000, '[')) == "f.json:1: expected values nested at most 64 deep");
    std::string objects;
    for (int i = 0; i < 1000; ++i) objects += "{\"a\":";
    CHECK(failure(objects) == "f.json:1: expected values nested at most 64 deep");
  }
}

TEST_SUITE("law") {
  TEST_CASE("any bytes are read or refused with the file's name") {
    Rng rng(91);
    const std::string letters = "{}[]\",:01e-. \nabtrue";
    for (int i = 0; i < 5000; ++i) {
      std::string bytes;
      const std::uint32_t count = rng.index(40);
      for (std::uint32_t j = 0; j < count; ++j) {
        bytes += i % 3 == 0 ? static_cast<char>(rng.index(256))
                            : letters[rng.index(static_cast<std::uint32_t>(letters.size()))];
      }
      INFO("seed 91, case " << i);
      const std::string message = failure(bytes);
      REQUIRE((message.empty() || message.rfind("f.json:", 0) == 0));
    }
  }
}

}  // namespace
}  // namespace mneme::test
