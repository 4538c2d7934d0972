// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/report_support.h"

#include <algorithm>

namespace mneme {
namespace {

int occurrences(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string page() {
  std::vector<BenchmarkRow> rows = {test::run(0.5), test::run(10, false), test::run(1)};
  rows[1].problem = "<img src=x onerror=alert(1)>";
  rows[2].sampler = "uniform & \"more\"";
  const Problem problem = test::gap_problem();
  const std::vector<ReportPicture> pictures = {{"caption <b>", *to_svg(test::picture_of(problem))}};
  return to_html("Title & <tag>", "First.\n\nSecond </p><script>.", rows, pictures);
}

TEST_SUITE("unit") {
  TEST_CASE("The page has a row for every group, the chart and the pictures with captions") {
    const std::string html = page();
    CHECK(occurrences(html, "<tr><td>") == 3);
    CHECK(occurrences(html, "<td>uniform &amp; &quot;more&quot;</td>") == 1);
    CHECK(occurrences(html, "class=\"chart\"") == 1);
    CHECK(occurrences(html, "class=\"row sampler-") == 3);
    CHECK(occurrences(html, "<figure") == 1);
    CHECK(occurrences(html, "<figcaption>caption &lt;b&gt;</figcaption>") == 1);
    CHECK(occurrences(html, "<td class=\"number bad\">0/1</td>") == 1);
    CHECK(occurrences(html, "&gt;10000") >= 4);
  }

  TEST_CASE("Names, title and introduction cannot smuggle in markup") {
    const std::string html = page();
    CHECK(occurrences(html, "<img") == 0);
    CHECK(occurrences(html, "<script") == 0);
    CHECK(occurrences(html, "<td>&lt;img src=x onerror=alert(1)&gt;</td>") == 1);
    CHECK(occurrences(html, "<h1>Title &amp; &lt;tag&gt;</h1>") == 1);
  }

  TEST_CASE("The page needs nothing from elsewhere") {
    const std::string html = page();
    for (const std::string reference :
         {" src=\"", " href=", "url(", "@import", "<link", "<script"}) {
      CAPTURE(reference);
      CHECK(occurrences(html, reference) == 0);
    }
    CHECK(occurrences(html, "http") == occurrences(html, "xmlns=\"http://www.w3.org/2000/svg\""));
  }

  TEST_CASE("The page follows the reader's choice of light or dark") {
    CHECK(page().find("@media (prefers-color-scheme: dark)") != std::string::npos);
  }

  TEST_CASE("The body is well-formed, also without runs and pictures") {
    for (const std::string& html : {page(), to_html("Empty", "", {}, {})}) {
      const auto begin = html.find("<body>");
      const auto end = html.find("</body>");
      REQUIRE(begin != std::string::npos);
      REQUIRE(end != std::string::npos);
      const test::SvgReader body(html.substr(begin, end + 7 - begin));
      CHECK(body.count("", "h1") == 1);
    }
    CHECK(occurrences(to_html("Empty", "", {}, {}), "<table") == 0);
  }
}

}  // namespace
}  // namespace mneme
