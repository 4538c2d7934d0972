// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace mneme {
namespace {

using test::contains;

/// Texts between `begin` and `end`, in order.
std::vector<std::string> pieces(const std::string& text, const std::string& begin,
                                const std::string& end) {
  std::vector<std::string> found;
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1)) {
    const auto first = at + begin.size();
    found.push_back(text.substr(first, text.find(end, first) - first));
  }
  return found;
}

/// The lines of a CSV file without quotes, by column.
std::vector<std::map<std::string, std::string>> split_csv(const std::string& csv) {
  std::istringstream lines(csv);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::vector<std::string> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(cell);
    if (line.ends_with(',')) values.emplace_back();
    if (names.empty()) {
      names = values;
      continue;
    }
    REQUIRE(values.size() == names.size());
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < values.size(); ++i) row[names[i]] = values[i];
  }
  return rows;
}

/// The times of one planner and sampler, failures as infinite, sorted; recomputed from the text.
std::vector<double> times_of(const std::vector<std::map<std::string, std::string>>& rows,
                             const std::string& planner, const std::string& sampler) {
  std::vector<double> times;
  for (const auto& row : rows) {
    if (row.at("planner") != planner || row.at("sampler") != sampler) continue;
    const bool is_success = row.at("status") == "solved" && row.at("is_valid") == "1";
    times.push_back(is_success ? std::stod(row.at("planning_time_s")) : INFINITY);
  }
  std::ranges::sort(times);
  return times;
}

int occurrences(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// A page with an introduction and a picture, whose names would be markup if they could.
std::string illustrated_page() {
  std::vector<BenchmarkRow> rows = {test::run(0.5), test::run(10, false), test::run(1)};
  rows[1].problem = "<img src=x onerror=alert(1)>";
  rows[1].timeout_s = 10;
  rows[2].sampler = "uniform & \"more\"";
  const Problem problem = test::gap_problem();
  ReportOptions options;
  options.title = "Title & <tag>";
  options.introduction = "First.\n\nSecond </p><script>.";
  options.pictures = {{"caption <b>", *to_svg(test::picture_of(problem))}};
  options.by_problem = true;
  return make_benchmark_report(rows, {}, options).html;
}

TEST_SUITE("oracle") {
  TEST_CASE("The numbers of a report of 3 x 3 x 20 runs are those of the CSV file") {
    const auto rows = test::suite_rows();
    const std::string html = make_benchmark_report(rows, {}, {}).html;
    const auto table = pieces(html, "<table class=\"times\">", "</table>");
    REQUIRE(table.size() == 1);
    const auto csv = split_csv(to_csv(rows));
    const auto lines = pieces(table[0], "<tr><td>", "</tr>");
    REQUIRE(lines.size() == 9);
    for (const std::string& line : lines) {
      const std::string planner = line.substr(0, line.find('<'));
      const std::string sampler = pieces(line, "</td><td>", "<").front();
      CAPTURE(planner);
      CAPTURE(sampler);
      const auto times = times_of(csv, planner, sampler);
      REQUIRE(times.size() == 20);
      const auto solved = std::ranges::count_if(times, [](double t) { return std::isfinite(t); });
      CHECK(contains(line, ">" + std::to_string(solved) + "/20/20<"));
      const auto cells = pieces(line, "data-value=\"", "\"");
      REQUIRE(cells.size() == 4);
      const std::size_t ranks[] = {9, 18, 19, 19};
      for (std::size_t i = 0; i < 4; ++i) {
        const double expected = std::isfinite(times[ranks[i]]) ? times[ranks[i]] : 20;
        CHECK(std::stod(cells[i]) == expected);
      }
    }
  }

  TEST_CASE("Paired ratios are those recomputed from the CSV file") {
    const auto rows = test::suite_rows();
    const std::string html = make_benchmark_report(rows, {}, {}).html;
    const auto table = pieces(html, "<table class=\"ratios\">", "</table>");
    REQUIRE(table.size() == 1);
    const auto lines = pieces(table[0], "<tr><td>", "</tr>");
    REQUIRE(lines.size() == 6);
    const auto csv = split_csv(to_csv(rows));
    const auto median = [&](const std::string& planner, const std::string& sampler) {
      return times_of(csv, planner, sampler)[9];
    };
    CHECK(lines[0].starts_with("rrt_connect, gl, tuned<"));
    CHECK(std::stod(pieces(lines[0], "data-value=\"", "\"")[0]) ==
          doctest::Approx(median("rrt_connect", "uniform") / median("rrt_connect", "gl")));
    CHECK(lines[3].starts_with("prm, halton, tuned<"));
    CHECK(std::stod(pieces(lines[3], "data-value=\"", "\"")[0]) ==
          doctest::Approx(median("prm", "uniform") / median("prm", "halton")));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("The page says how many paths failed the check, and on which machine it ran") {
    const std::string html = make_benchmark_report(test::suite_rows(), {}, {}).html;
    CHECK(contains(html,
                   "180 runs: 173 solved, 6 without a path, 1 with a path that failed the check"));
    CHECK(contains(html, "Machine: a machine. Kernels: avx2. Built: mneme 1 with g++ 12."));
    CHECK(contains(html, "timed cold, started 2026-01-31T12:00:00Z"));
  }

  TEST_CASE("The page needs nothing from elsewhere and its body is well-formed") {
    const std::vector<MemoryRow> memories = {{"grid", 1, 2, 3, 4}};
    const BenchmarkReport report = make_benchmark_report(test::suite_rows(), memories, {});
    const std::string& html = report.html;
    for (const std::string reference : {" src=\"", "url(", "@import", "<link", "<script", "<img"}) {
      CAPTURE(reference);
      CHECK(!contains(html, reference));
    }
    const auto begin = html.find("<body>");
    const test::SvgReader body(html.substr(begin, html.find("</body>") + 7 - begin));
    CHECK(body.count("", "svg") == 1);
    REQUIRE(report.figures.size() == 1);
    CHECK(report.figures[0].name == "1_scenario_solved");
    for (const ReportFigure& figure : report.figures) {
      CHECK(test::SvgReader(figure.svg).count("", "style") == 1);
    }
  }

  TEST_CASE("Where paths were improved there is a figure of their lengths, and a sentence on it") {
    auto rows = test::suite_rows();
    CHECK(!contains(make_benchmark_report(rows, {}, {}).html, "Lengths are"));
    rows[0].improvements = {{0, 10}, {0.001, 5}};
    const BenchmarkReport report = make_benchmark_report(rows, {}, {});
    REQUIRE(report.figures.size() == 2);
    CHECK(report.figures[1].name == "1_scenario_lengths");
    CHECK(contains(report.html, "Lengths are"));
  }

  TEST_CASE("A page has figures and rows for every problem, and the pictures with captions") {
    const std::string html = illustrated_page();
    CHECK(pieces(html, "<table class=\"times\">", "</table>").size() == 2);
    CHECK(occurrences(html, "class=\"plot curves\"") == 2);
    auto compared = test::suite_rows();
    for (std::size_t i = 0; i < compared.size(); i += 2) compared[i].set = "other";
    const std::string two = make_benchmark_report(compared, {}, {}).html;
    CHECK(occurrences(two, "<h3>Paired ratios</h3>") == 2);
    CHECK(occurrences(two, "Ratios above 1 mean") == 1);
    CHECK(occurrences(html, "<td>uniform &amp; &quot;more&quot;</td>") == 1);
    CHECK(occurrences(html, "<figure class") == 1);
    CHECK(occurrences(html, "<figcaption>caption &lt;b&gt;</figcaption>") == 1);
    CHECK(html.find("First.\n\nSecond") < html.find("<figure class"));
    CHECK(occurrences(html, "<td class=\"number bad\">0/1/1</td>") == 1);
    CHECK(occurrences(html, "&gt;10000") == 4);
  }

  TEST_CASE("Names, title and introduction cannot smuggle in markup") {
    const std::string html = illustrated_page();
    CHECK(occurrences(html, "<img") == 0);
    CHECK(occurrences(html, "<script") == 0);
    CHECK(occurrences(html, ">&lt;img src=x onerror=alert(1)&gt;</h2>") == 1);
    CHECK(occurrences(html, "<title>Title &amp; &lt;tag&gt;</title>") == 1);
    CHECK(occurrences(html, "<h1>Title &amp; &lt;tag&gt;</h1>") == 1);
  }

  TEST_CASE("A page with pictures needs nothing from elsewhere and follows light or dark") {
    const std::string html = illustrated_page();
    for (const std::string reference : {" src=\"", "url(", "@import", "<link", "<script"}) {
      CAPTURE(reference);
      CHECK(occurrences(html, reference) == 0);
    }
    CHECK(occurrences(html, " href=") == occurrences(html, " href=\"#"));
    CHECK(occurrences(html, "http") == occurrences(html, "xmlns=\"http://www.w3.org/2000/svg\""));
    CHECK(contains(html, "@media (prefers-color-scheme: dark)"));
    CHECK(html.ends_with("</body>\n</html>\n"));
  }

  TEST_CASE("The body is well-formed, also without runs and pictures") {
    ReportOptions empty;
    empty.title = "Empty";
    const std::string nothing = make_benchmark_report({}, {}, empty).html;
    for (const std::string& html : {illustrated_page(), nothing}) {
      const auto begin = html.find("<body>");
      const auto end = html.find("</body>");
      REQUIRE(begin != std::string::npos);
      REQUIRE(end != std::string::npos);
      const test::SvgReader body(html.substr(begin, end + 7 - begin));
      CHECK(body.count("", "h1") == 1);
    }
    CHECK(occurrences(nothing, "<table") == 0);
  }

  TEST_CASE("Rows of older files, which name no machine, have a report too") {
    const std::vector<BenchmarkRow> rows = {test::run(1)};
    CHECK(contains(make_benchmark_report(rows, {}, {}).html, "not recorded"));
    CHECK(make_benchmark_report({}, {}, {}).figures.empty());
  }
}

}  // namespace
}  // namespace mneme
