// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "input/elided.h"
#include "input/input.h"
#include "input/tree_builder.h"
#include "support/support.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

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
  TEST_CASE("a tab before a word of YAML and a null byte are named, with the line") {
    const std::string message = failure("a:\n  b: 1\n\tc: 2\n", [](const Input&) {});
    CHECK_MESSAGE(message.find("f:3: expected spaces before the first word") == 0, message);
    const std::string null = failure(std::string("a: 1\nb: 2\0", 10), [](const Input&) {});
    CHECK(null == "f:2: a null byte is no YAML");
    CHECK(number(std::string("\xff\xfe\x31\0", 4)) == 1.0);  // UTF-16
  }

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

  TEST_CASE("whole numbers are exact up to 2^64 - 1") {
    const auto whole = [](const std::string& yaml) {
      const auto value = internal::parse_yaml(yaml, "f");
      return Input(value, kSource).whole_number();
    };
    CHECK(whole("0") == 0U);
    CHECK(whole("9007199254740993") == 9007199254740993U);
    CHECK(whole("+9007199254740993") == 9007199254740993U);
    CHECK(whole("18446744073709551615") == ~std::uint64_t{0});
    CHECK(whole("1e3") == 1000U);
    CHECK(whole("5.0") == 5U);
    for (const char* text : {"-1", "0.5", "18446744073709551616", "1e30", ".inf", ".nan"}) {
      CAPTURE(text);
      CHECK_FALSE(whole(text).has_value());
    }
    CHECK(failure("'1'", [](const Input& i) { static_cast<void>(i.whole_number()); }) ==
          "f:1: expected a number, got \"1\"");
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

  TEST_CASE("a message quotes begin and end of a long key, name or number") {
    const auto number = [](const Input& i) { static_cast<void>(i.number()); };
    const std::string key(1'000'000, 'k'), digits = "0." + std::string(1'000'000, '1');
    const std::string shown = std::string(67, 'k') + "..." + std::string(33, 'k');
    CHECK(failure(key + ": 1\n", [](const Input& i) { i.allow_keys({"a"}); }) ==
          "f:1: key " + shown + ": unknown key, expected one of a");
    CHECK(failure(key + ": {b: x}\n", [&](const Input& i) {
            number(i.entries()[0].second.at("b"));
          }) == "f:1: key " + shown + ".b: expected a number, got \"x\"");
    CHECK(failure(key + ": 1\n" + key + ": 2\n", [](const Input&) {}) ==
          "f:2: key " + shown + ": expected once, got a second time");
    CHECK(failure(digits, [](const Input& i) { static_cast<void>(i.text_or("a", "")); }).size() <
          200);
    const std::string message = failure("1", [&](const Input& i) {
      i.fail(ErrorCode::invalid, "there is no link {}; name another", key);
    });
    CHECK(message.size() < 5000);
    CHECK(message.starts_with("f:1: there is no link kkk"));
    CHECK(message.ends_with("kkk; name another"));
  }

  TEST_CASE("an error of JSON quotes long texts and numbers in part") {
    const std::string digits(1'000'000, '1');
    for (const std::string& json : {"[" + digits + "]", "[" + digits + "x]", "[\"" + digits}) {
      const auto result =
          internal::without_throwing([&] { return internal::parse_json(json, kSource); });
      REQUIRE_FALSE(result.has_value());
      CHECK(result.error().message.starts_with("f:1: expected JSON: "));
      CHECK(result.error().message.size() < 1000);
    }
  }

  TEST_CASE("a text is not cut within a character") {
    CHECK(internal::elided("123456", 6) == "123456");
    CHECK(internal::elided("1234567", 6) == "1234...67");
    CHECK(internal::elided("123\xc3\xa4-\xc3\xa4\x37", 6) == "123...7");
  }
}

using internal::InputValue;
using internal::TreeBuilder;

/// The message with which `build` fails.
template <class Build>
std::string build_failure(Build&& build) {
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
    CHECK(build_failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::List{});
            tree.count(2, 3);
          }).empty());
    CHECK(build_failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::List{});
            tree.count(2, 4);
          }) == "f:2: expected at most 4 values");
  }

  TEST_CASE("a value where a key must stand, and a doubled key, are refused") {
    CHECK(build_failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::Map{});
            tree.open(2, InputValue::List{});
          }) == "f:2: expected text as the key of a map");
    CHECK(build_failure([](TreeBuilder& tree) {
            tree.open(1, InputValue::Map{});
            tree.set_key(1, "k");
            tree.open(1, 1.0);
            tree.close();
            tree.set_key(2, "k");
          }) == "f:2: key k: expected once, got a second time");
  }
}

/// Equal contents on equal lines.
bool same_value(const InputValue& a, const InputValue& b) {
  if (a.line != b.line || a.content.index() != b.content.index()) return false;
  if (const auto* text = std::get_if<InputValue::Text>(&a.content)) {
    const auto& other = std::get<InputValue::Text>(b.content);
    return text->text == other.text && text->is_quoted == other.is_quoted;
  }
  if (const auto* list = std::get_if<InputValue::List>(&a.content)) {
    return std::ranges::equal(*list, std::get<InputValue::List>(b.content), same_value);
  }
  if (const auto* map = std::get_if<InputValue::Map>(&a.content)) {
    return std::ranges::equal(*map, std::get<InputValue::Map>(b.content),
                              [](const auto& x, const auto& y) {
                                return x.key == y.key && same_value(x.value, y.value);
                              });
  }
  return true;
}

std::string random_inline(Rng& rng) {
  static const std::vector<std::string> kValues = {
      "a", "-1.5e3", "\"q: r\"", "'s'", "[]", "[1, [x, {k: v}]]", "{a: 1, \"b\": [2]}", "x/y.z"};
  return kValues[rng.index(static_cast<std::uint32_t>(kValues.size()))] +
         (rng.index(4) == 0 ? "  # remark\n" : "\n");
}

/// A map or list of YAML in blocks, with values of all kinds.
std::string random_block(Rng& rng, int depth, std::size_t indent) {
  const bool is_map = rng.index(2) == 0;
  std::string text;
  for (std::uint32_t i = 0, count = 1 + rng.index(3); i < count; ++i) {
    text += std::string(indent, ' ') + (is_map ? "k" + std::to_string(i) + ":" : "-");
    const std::uint32_t kind = depth > 3 ? 0 : rng.index(3);
    if (kind == 0) text += " " + random_inline(rng);
    if (kind == 1) text += "\n" + random_block(rng, depth + 1, indent + 1 + rng.index(3));
    if (kind == 2 && is_map) text += "\n\n" + random_block(rng, depth + 1, indent + 2);
    if (kind == 2 && !is_map)
      text += " " + random_block(rng, depth + 1, indent + 2).substr(indent + 2);
  }
  return text;
}

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

  TEST_CASE("truth is spelled as YAML 1.1 and ROS spell it") {
    const auto read = [](const std::string& text) {
      return internal::without_throwing([&] {
        const InputValue value = internal::parse_yaml("a: " + text, "f");
        const std::string source = "f";
        return internal::Input(value, source).at("a").boolean();
      });
    };
    for (const char* yes : {"true", "True", "TRUE", "yes", "Yes", "on"}) CHECK(read(yes) == true);
    for (const char* no : {"false", "False", "no", "NO", "off"}) CHECK(read(no) == false);
    for (const char* other : {"1", "y", "'yes'", "maybe", "[true]", ""}) {
      CAPTURE(other);
      CHECK_FALSE(read(other).has_value());
    }
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
    CHECK(yaml_failure("a: 1\nb: 2\na: 3\n") ==
          "f.yaml:3: key a: expected once, got a second time");
  }

  TEST_CASE("a key that is no text is refused") {
    CHECK(yaml_failure("[1, 2]: 3\n") == "f.yaml:1: expected text as the key of a map");
  }

  TEST_CASE("simple text is parsed as the whole of YAML is, with lines") {
    const std::vector<std::string> texts = {
        "a: 1\nb: [1, 2.5, -3e2]\n",
        "# head\n\na:\n  b: x  # note\n  c:\n  - 1\n  - {d: 2, e: [3, 4]}\nf: \"q: #\"\n",
        "- - 1\n  - 2\n- a: 1\n  b: 2\n-\n  c: 3\n-   d: 4\n    e: 5\n",
        "a:\n- 1\n- 2\nb: {x: 1,\n  y: [2,\n 3]}\n",
        "{\"a\": [1, \"two\", {\"b\":3}], 'c': 'd e'}",
        "[]\n",
        "a: {}\nb:\n    - name: n\n      size: [1]\n    - name: m\n      size: [2]",
    };
    for (const std::string& text : texts) {
      CAPTURE(text);
      const auto simple = require(internal::parse_simple_yaml(text, "f", 1000));
      // The end marker is beyond the subset.
      CHECK(same_value(simple, internal::parse_yaml(text + "\n...\n", "f")));
    }
    for (const char* text :
         {"",          "a:\n",           "a: b c\n",    "a: ~",       "a: null",
          "&x 1",      "a: !degrees 1",  "a: |\n  b",   "--- 1",      "a: 1\n...",
          "a: x\n  y", "[1, 2,]",        "{a:1}",       "[a: 1]",     "a: \"\\n\"",
          "\ta: 1",    "- 1\n  - 2",     "a: 1\n b: 2", "a: '",       "a: 'x''y'",
          "? a",       "a: [1, # c\n2]", "a: b:",       "\xc3\xa4: 1"}) {
      CAPTURE(text);
      CHECK_FALSE(internal::parse_simple_yaml(text, "f", 1000).has_value());
    }
  }

  TEST_CASE("random blocks are parsed as the whole of YAML is") {
    Rng rng(11);
    for (int repetition = 0; repetition < 500; ++repetition) {
      const std::string text = random_block(rng, 0, 0);
      CAPTURE(text);
      const auto simple = require(internal::parse_simple_yaml(text, "f", 100'000));
      REQUIRE(same_value(simple, internal::parse_yaml(text + "...\n", "f")));
    }
  }

  TEST_CASE("a second document with contents is refused, an empty one is not") {
    const std::string refusal =
        ": expected the end of the text after one YAML document (ros2 topic echo --once prints "
        "one)";
    CHECK(yaml_failure("a: 1\n---\nb: 2\n") == "f.yaml:3" + refusal);
    CHECK(yaml_failure("a: 1\n---\n[]\n") == "f.yaml:3" + refusal);
    CHECK(yaml_failure("a: 1\n---\n---\nb: 2\n") == "f.yaml:4" + refusal);
    CHECK(yaml_failure("a: 1\n---\n").empty());
    CHECK(yaml_failure("---\na: 1\n---\n---\n").empty());
    const InputValue value = internal::parse_yaml("a: 1\n---\n", "f");
    CHECK(std::get<InputValue::Map>(value.content).size() == 1);
  }

  TEST_CASE("angles may be tagged, other tags are refused by name") {
    const std::string source = "f.yaml";
    const InputValue value = internal::parse_yaml(
        "[!degrees 30, !radians 0.5, !degrees \"-90\", !!float 2, !!str 3]", source);
    const std::vector<internal::Input> items =
        internal::Input(value, source).taking_angles().items();
    CHECK(items[0].number() == doctest::Approx(0.5235987755982988).epsilon(1e-15));
    CHECK(items[1].number() == 0.5);
    CHECK(items[2].number() == doctest::Approx(-1.5707963267948966).epsilon(1e-15));
    CHECK(items[3].number() == 2);
    CHECK_FALSE(items[4].is_number());
    const std::string expected = "; expected !degrees or !radians before a number, or no tag";
    CHECK(yaml_failure("a: !millimetres 3") == "f.yaml:1: unknown tag !millimetres" + expected);
    CHECK(yaml_failure("a:\n  !degrees [1, 2]") ==
          "f.yaml:2: expected one number after !degrees, got a list");
    CHECK(yaml_failure("a: !!python/tuple {}") ==
          "f.yaml:1: unknown tag tag:yaml.org,2002:python/tuple" + expected);
    CHECK(yaml_failure("a: !degrees x") ==
          "f.yaml:1: expected a number or an expression such as pi/6 after !degrees, got \"x\"");
  }

  TEST_CASE("a number that is no angle refuses tags of angles") {
    const std::string source = "f.yaml";
    for (const char* text : {"!degrees 90", "!radians pi/2", "deg(90)", "rad(pi/2)"}) {
      const InputValue value =
          internal::parse_yaml(fmt::format("a:\n  - {0}\nb: {0}", text), source);
      const internal::Input input(value, source);
      CHECK_FALSE(input.at("b").is_number());
      const auto positive =
          internal::without_throwing([&] { return input.at("b").positive_number(); });
      const auto list =
          internal::without_throwing([&] { return input.at("a").finite_numbers(1, "a length"); });
      const std::string got = ": expected a number, got an angle of 1.5708 rad, which this is not";
      REQUIRE((!positive && !list));
      CHECK(positive.error().message == "f.yaml:3: key b" + got);
      CHECK(list.error().message == "f.yaml:2: key a[0]" + got);
      CHECK(input.taking_angles(false).at("b").taking_angles().number() ==
            doctest::Approx(std::numbers::pi / 2));
    }
  }

  TEST_CASE("angles may be expressions of numbers and pi") {
    const double pi = std::numbers::pi;
    const std::vector<std::pair<std::string, double>> angles = {
        {"!radians pi/6", pi / 6},
        {"!radians -pi", -pi},
        {"!radians 2*pi/3", 2 * pi / 3},
        {"!radians \"1.5 * pi - 1\"", 1.5 * pi - 1},
        {"!degrees 360/8", pi / 4},
        {"rad(pi/2)", pi / 2},
        {"deg(2*45)", pi / 2},
        {"!radians (pi + 1) / 2", (pi + 1) / 2},
        {"!radians -(1 - 2e-1)*2", -1.6},
        {"!radians .5*pi", pi / 2}};
    const std::string source = "f";
    for (const auto& example : angles) {
      const InputValue value = internal::parse_yaml("a: " + example.first, source);
      CHECK_MESSAGE(internal::Input(value, source).taking_angles().at("a").number() ==
                        doctest::Approx(example.second).epsilon(1e-15),
                    example.first);
    }
    for (const char* text : {"pi pi", "2**3", "1/0", "pi/", "(pi", "inf", "2 pi", "", "pie"}) {
      CHECK_MESSAGE(contains(yaml_failure(fmt::format("a: !radians \"{}\"", text)), "such as pi/6"),
                    text);
    }
    CHECK_FALSE(yaml_failure("a: !radians \"" + std::string(100000, '-') + "1\"").empty());
    const InputValue plain = internal::parse_yaml("a: pi/2", source);
    CHECK_FALSE(internal::Input(plain, source).at("a").is_number());
  }

  TEST_CASE("deep nesting is refused, however it is written") {
    const std::string depth = "nested at most 64 deep";
    CHECK(contains(yaml_failure(std::string(100, '[') + std::string(100, ']')), depth));
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
    CHECK(yaml_failure("&a [*a]") ==
          "f.yaml:1: expected an alias outside of the value that it names");
  }

  TEST_CASE("a merge key adds the entries of maps, own entries win") {
    const std::string text =
        "a: &a {x: 1, y: 2}\nb: &b {x: 3, z: 4}\nc: {<<: *a, y: 5}\nd: {<<: [*a, *b]}\n"
        "e: &e {<<: *a}\nf: {<<: *e}\n";
    const InputValue value = internal::parse_yaml(text, "f");
    const std::string source = "f";
    const internal::Input input(value, source);
    CHECK(input.at("c").entries().size() == 2);
    CHECK(input.at("c").at("x").number() == 1);
    CHECK(input.at("c").at("y").number() == 5);
    CHECK(input.at("d").entries().size() == 3);
    CHECK(input.at("d").at("x").number() == 1);
    CHECK(input.at("d").at("z").number() == 4);
    CHECK(input.at("f").at("y").number() == 2);
    CHECK(yaml_failure("a: &a 1\nb: {<<: *a}") ==
          "f.yaml:2: key <<: expected a map or a list of maps");
  }

  TEST_CASE("a tag of an angle is one of a number, not of a list") {
    const InputValue angle = internal::parse_yaml("a: deg(180)\nb: rad(2)\nc: deg(x)", "f");
    const auto& map = std::get<InputValue::Map>(angle.content);
    using Angle = InputValue::Angle;
    CHECK(std::get<Angle>(map[0].value.content).radians == doctest::Approx(std::numbers::pi));
    CHECK(std::get<Angle>(map[1].value.content).radians == 2);
    CHECK(std::get<InputValue::Text>(map[2].value.content).text == "deg(x)");
    CHECK(yaml_failure("a: !degrees [30]") ==
          "f.yaml:1: expected one number after !degrees, got a list");
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
    CHECK(contains(yaml_failure(bomb), "expected at most 4000000 values"));
  }

  TEST_CASE("copies for anchors and aliases count, with keys and long texts") {
    const auto repeated = [](const std::string& text, int count) {
      std::string all;
      for (int i = 0; i < count; ++i) all += text;
      return all;
    };
    const std::string refusal = "expected at most 4000000 values, with a copy for each anchor";
    const std::string text = "a: &a '" + std::string(64'000, 'x') + "'\nb:\n  [";
    CHECK(yaml_failure(text + repeated("*a, ", 100) + "1]").empty());
    const std::string message = yaml_failure(text + repeated("*a, ", 4000) + "1]");
    CHECK_MESSAGE(message.starts_with("f.yaml:3: " + refusal), message);
    CHECK_MESSAGE(message.ends_with("or put less into the anchored values"), message);
    // Lists within lists, each anchored, are copied once for each level.
    std::string nested;
    for (int i = 0; i < 50; ++i) nested += fmt::format("&a{} [", i);
    const std::string end(50, ']');
    CHECK(yaml_failure(nested + repeated("1, ", 1000) + end).empty());
    CHECK(contains(yaml_failure(nested + repeated("1, ", 100'000) + end), refusal));
    std::string merged = "a: &a {";
    for (int i = 0; i < 1000; ++i) merged += fmt::format("k{}: 1, ", i);
    merged += "}\nb: {<<: [";
    CHECK(yaml_failure(merged + repeated("*a, ", 1000) + "]}").empty());
    CHECK(contains(yaml_failure(merged + repeated("*a, ", 2000) + "]}"), refusal));
  }
}

const std::string kTextSource = "f";

TEST_SUITE("unit") {
  TEST_CASE("numbers are as short as they can be") {
    CHECK(internal::yaml_number(0.1) == "0.1");
    CHECK(internal::yaml_number(3.0) == "3");
    CHECK(internal::yaml_number(-INFINITY) == "-.inf");
    CHECK(internal::yaml_number(NAN) == ".nan");
    CHECK(internal::yaml_flow(std::vector<double>{1, 2.5}) == "[1, 2.5]");
    CHECK(internal::yaml_flow(std::vector<double>()) == "[]");
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
