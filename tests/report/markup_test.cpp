// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/markup.h"
#include "report/report_support.h"

#include <limits>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Markup characters become entities") {
    CHECK(escape_markup("a<b> & \"c\" 'd'") == "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  }

  TEST_CASE("Well-formed UTF-8 of every length stays as it is") {
    const std::string text = "a\xC3\xA9\xE2\x82\xAC\xF0\x9F\xA4\x96\t\n";
    CHECK(clean_text(text) == text);
  }

  TEST_CASE("Bytes that XML cannot hold become replacement characters") {
    const std::string mark = "\xEF\xBF\xBD";
    CHECK(clean_text("\xFF") == mark);
    CHECK(clean_text(std::string_view("\0", 1)) == mark);
    CHECK(clean_text("\x1B[0m") == mark + "[0m");
    CHECK(clean_text("\xC3") == mark);
    CHECK(clean_text("\xC0\xAF") == mark + mark);
    CHECK(clean_text("\xE0\x80\x80") == mark + mark + mark);
    CHECK(clean_text("\xED\xA0\x80") == mark + mark + mark);
    CHECK(clean_text("\xEF\xBF\xBE") == mark + mark + mark);
    CHECK(clean_text("\xF4\x90\x80\x80") == mark + mark + mark + mark);
  }

  TEST_CASE("Text for tables has no line breaks") { CHECK(single_line("a\nb\tc\rd") == "a b c d"); }

  TEST_CASE("Shortening counts characters, not bytes") {
    CHECK(shortened("\xC3\xA9\xC3\xA9\xC3\xA9", 3) == "\xC3\xA9\xC3\xA9\xC3\xA9");
    CHECK(shortened("\xC3\xA9\xC3\xA9\xC3\xA9", 2) == "\xC3\xA9\xE2\x80\xA6");
    CHECK(character_count(shortened("a long name", 5)) == 5);
  }
}

TEST_SUITE("law") {
  TEST_CASE("Any bytes give well-formed XML") {
    Rng rng(1);
    for (int round = 0; round < 2000; ++round) {
      std::string text;
      for (int i = 0; i < 12; ++i) text += static_cast<char>(rng.index(256));
      CAPTURE(round);
      tinyxml2::XMLDocument document;
      const std::string xml =
          "<a b=\"" + escape_markup(text) + "\">" + escape_markup(text) + "</a>";
      CHECK(document.Parse(xml.c_str(), xml.size()) == tinyxml2::XML_SUCCESS);
      CHECK(clean_text(clean_text(text)) == clean_text(text));
    }
  }
}

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
