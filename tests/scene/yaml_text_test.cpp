// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "scene/yaml.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace mneme::test {
namespace {

const std::string kTextSource = "f";

using internal::Input;

TEST_SUITE("unit") {
  TEST_CASE("numbers are as short as they can be") {
    CHECK(internal::yaml_number(0.1) == "0.1");
    CHECK(internal::yaml_number(3.0) == "3");
    CHECK(internal::yaml_number(-INFINITY) == "-.inf");
    CHECK(internal::yaml_number(NAN) == ".nan");
    CHECK(internal::yaml_numbers(std::vector<double>{1, 2.5}) == "[1, 2.5]");
    CHECK(internal::yaml_numbers({}) == "[]");
  }

  TEST_CASE("texts are quoted where they must be") {
    CHECK(internal::yaml_string("circle_1") == "circle_1");
    CHECK(internal::yaml_string("../robots/a-b.urdf") == "\"../robots/a-b.urdf\"");
    CHECK(internal::yaml_string("null") == "\"null\"");
    CHECK(internal::yaml_string("") == "\"\"");
    CHECK(internal::yaml_string("a: b") == "\"a: b\"");
  }
}

TEST_SUITE("law") {
  TEST_CASE("numbers read back to the same bits") {
    Rng rng(71);
    for (int i = 0; i < 20000; ++i) {
      const double value = (rng.uniform() - 0.5) * std::pow(10.0, rng.uniform(-300, 300));
      const internal::InputValue read = {
          internal::InputValue::Text{internal::yaml_number(value), false}, 1};
      REQUIRE(Input(read, kTextSource).number() == value);
    }
  }

  TEST_CASE("texts read back to the same texts") {
    Rng rng(72);
    std::vector<std::string> texts = {
        "~", "Null", "true", "1.5", "\xc3\xa4\xe2\x82\xac", "\xf0\x9f\xa6\xbe", "a # b", "- a",
        "'", "\"",   "\\",   "\x7f"};
    for (int i = 0; i < 500; ++i) {
      std::string text;
      const std::uint32_t count = rng.index(10);
      for (std::uint32_t j = 0; j < count; ++j) text += static_cast<char>(rng.index(128));
      texts.push_back(text);
    }
    for (const std::string& text : texts) {
      CAPTURE(text);
      const auto read = internal::parse_yaml("k: " + internal::yaml_string(text), "f");
      REQUIRE(Input(read, kTextSource).at("k").text() == text);
    }
  }
}

}  // namespace
}  // namespace mneme::test
