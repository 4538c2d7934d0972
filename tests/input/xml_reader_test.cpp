// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "input/xml_reader.h"
#include "support/support.h"

#include <clocale>
#include <string>
#include <vector>

namespace mneme {
namespace {

using internal::XmlElement;
using internal::XmlReader;
using test::contains;

/// A document `<r a="value"/>` and the reader of it.
struct Fixture {
  explicit Fixture(const std::string& value) : text("<r a=\"" + value + "\"/>") {
    root = &reader.read_root(document, text, "r");
  }
  std::string text;
  tinyxml2::XMLDocument document;
  XmlReader reader{"f"};
  const XmlElement* root = nullptr;
};

/// Returns the error that `read` throws; an empty one if it does not.
Error failure_of(const auto& read) {
  const auto result = internal::without_throwing([&] { static_cast<void>(read()); });
  return result ? Error{} : result.error();
}

std::string fault_of_document(const std::string& text) {
  tinyxml2::XMLDocument document;
  return failure_of([&] { return XmlReader("f").read_root(document, text, "r").Name(); }).message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("numbers are read in all the ways that XML writes them") {
    const std::vector<std::pair<std::string, double>> cases{
        {"1", 1}, {"1.", 1}, {".5", 0.5}, {"-2e-3", -2e-3}, {"+3.25", 3.25}, {"  7\n", 7}};
    for (const auto& [text, expected] : cases) {
      Fixture f(text);
      CAPTURE(f.text);
      CHECK(f.reader.number(*f.root, "a") == expected);
    }
  }

  TEST_CASE("whatever is not one finite number is a fault") {
    for (const char* text : {"", " ", "1,5", "1.5m", "nan", "inf", "-inf", "0x10", "1e999", "+-1",
                             "1 2", "+", "--1", "one", "${pi}"}) {
      Fixture f(text);
      CAPTURE(text);
      const Error failure = failure_of([&] { return f.reader.number(*f.root, "a"); });
      CHECK(contains(failure.message, "f:1: <r>: "));
    }
  }

  TEST_CASE("numbers do not depend on the locale") {
    const std::string old = std::setlocale(LC_NUMERIC, nullptr);
    const char* comma = nullptr;
    for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "fr_FR"}) {
      if (comma == nullptr) comma = std::setlocale(LC_NUMERIC, name);
    }
    if (comma == nullptr) MESSAGE("idle: no locale with a decimal comma is installed");
    Fixture f("1.5");
    CHECK(f.reader.number(*f.root, "a") == 1.5);
    std::setlocale(LC_NUMERIC, old.c_str());
  }

  TEST_CASE("vectors have three numbers") {
    Fixture good("1 -2\t3.5");
    CHECK(good.reader.vector(*good.root, "a", Vec3::Zero()) == Vec3(1, -2, 3.5));
    CHECK(good.reader.vector(*good.root, "b", Vec3(4, 5, 6)) == Vec3(4, 5, 6));
    for (const char* text : {"", "1 2", "1 2 3 4", "1 2 x", "1 nan 3", "1,2,3"}) {
      Fixture bad(text);
      CAPTURE(text);
      const Error failure =
          failure_of([&] { return bad.reader.vector(*bad.root, "a", Vec3::Zero()); });
      CHECK(contains(failure.message, "expected three finite numbers"));
    }
  }

  TEST_CASE("where a number is left for xacro to compute, messages say so") {
    for (const char* text : {"${-pi/2}", "$(arg lower)"}) {
      Fixture f(text);
      const std::string hint = "; let xacro compute it: xacro FILE.xacro > FILE";
      CHECK(failure_of([&] { return f.reader.number(*f.root, "a"); }).message.ends_with(hint));
      CHECK(failure_of([&] {
              return f.reader.vector(*f.root, "a", Vec3::Zero());
            }).message.ends_with(hint));
    }
  }

  TEST_CASE("a fault carries its context") {
    Fixture f("-1");
    f.reader.set_context("link 'x'");
    const Error failure = failure_of([&] { return f.reader.non_negative_number(*f.root, "a"); });
    CHECK(failure.message == "f:1: link 'x': <r>: a is -1, expected 0 or more");
    CHECK(failure.code == ErrorCode::parse);
  }

  TEST_CASE("documents that are not one element of the right name are refused") {
    CHECK(fault_of_document("<r/>").empty());
    CHECK(fault_of_document("<?xml version=\"1.0\"?><!-- c --><r/><!-- c -->").empty());
    CHECK(contains(fault_of_document(""), "f:1: malformed XML: "));
    CHECK(contains(fault_of_document("hello"), "f:1: "));
    CHECK(contains(fault_of_document("\n<s/>"), "f:2: the document is no <r> element"));
    CHECK(contains(fault_of_document("<r/>\n<r/>"), "f:2: there is more than one <r> element"));
    CHECK(contains(fault_of_document("<r/>\n<s/>"), "f:2: expected nothing after </r>, got <s>"));
    CHECK(contains(fault_of_document("<r/><?ros x?>"),
                   "an instruction <?..?> that is not at the beginning"));
    CHECK(contains(fault_of_document("<r>\n</s>"), "f:1: malformed XML: mismatched element"));
    CHECK(contains(fault_of_document("<r a='1' a='2'/>"), "f:1: malformed XML"));
    CHECK(contains(fault_of_document("<r>"), "malformed XML"));
    std::string many = "<r";
    for (int i = 0; i < 100000; ++i) many += " a" + std::to_string(i) + "='1'";
    CHECK(fault_of_document(many + "/>") == "f:1: has an element with more than 100 attributes");
    CHECK(contains(fault_of_document("<r><s/>\n"), "f:1: malformed XML: an element that does not"));
    CHECK(fault_of_document("r: 1") ==
          "f:1: malformed XML: text that no tag follows; expected a <r> element");
    CHECK(fault_of_document(" <r>") == "f:1: malformed XML: mismatched element");
    CHECK(contains(fault_of_document(std::string("<r/>\n\0<x>", 9)), "f:2: a null byte"));
  }

  TEST_CASE("elements nested too deeply are refused") {
    std::string text = "<r>";
    for (int i = 0; i < 100000; ++i) text += "<x>";
    CHECK(contains(fault_of_document(text), "depth exceeded"));
  }
}

}  // namespace mneme
