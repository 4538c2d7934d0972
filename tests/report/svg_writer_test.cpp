// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/svg_writer.h"

#include "report/report_support.h"

#include <limits>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Numbers are short") {
    CHECK(short_number(1.0) == "1");
    CHECK(short_number(100) == "100");
    CHECK(short_number(1.2345) == "1.23");
    CHECK(short_number(1.2345, 3) == "1.234");
    CHECK(short_number(0.5, 0) == "0");
    CHECK(short_number(20, 0) == "20");
    CHECK(short_number(-0.0001) == "0");
    CHECK(short_number(1.50) == "1.5");
    CHECK(short_number(std::numeric_limits<double>::quiet_NaN()) == "0");
  }

  TEST_CASE("Points are pairs with commas") {
    const std::vector<Point> points = {{1, 2}, {-0.25, 3.333333}};
    CHECK(short_points(points) == "1,2 -0.25,3.33");
  }

  TEST_CASE("Elements nest and close in order") {
    SvgWriter svg;
    svg.open("svg", {{"class", "a"}});
    svg.open("g");
    svg.element("circle", {{"r", "1"}});
    svg.close();
    svg.text_element("text", {}, "x < y");
    svg.close();
    CHECK(svg.str() ==
          "<svg class=\"a\">\n<g>\n<circle r=\"1\"/>\n</g>\n<text>x &lt; y</text>\n</svg>\n");
  }

  TEST_CASE("Attribute values are escaped") {
    SvgWriter svg;
    svg.element("a", {{"title", "\"<&"}});
    const test::SvgReader reader(svg.str());
    CHECK(std::string(reader.root()->Attribute("title")) == "\"<&");
  }
}

}  // namespace
}  // namespace mneme::internal
