// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/markup.h"

#include "report/report_support.h"

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

  TEST_CASE("CSV fields are quoted only where they must be") {
    CHECK(escape_csv("plain name") == "plain name");
    CHECK(escape_csv("a,b") == "\"a,b\"");
    CHECK(escape_csv("say \"hi\"") == "\"say \"\"hi\"\"\"");
    CHECK(escape_csv("two\nlines") == "\"two\nlines\"");
    CHECK(escape_csv("") == "");
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

}  // namespace
}  // namespace mneme::internal
