// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"
#include "statistics/figures.h"
#include "report/markup.h"

#include <sstream>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("The same factor is the same distance, and times beyond the ends stay on them") {
    const TimeAxis axis{0.001, 10, 400, 0};
    CHECK(axis.at(0.001) == doctest::Approx(400));
    CHECK(axis.at(0.01) == doctest::Approx(300));
    CHECK(axis.at(10) == doctest::Approx(0));
    CHECK(axis.at(100) == doctest::Approx(0));
    CHECK(axis.at(0) == doctest::Approx(400));
  }

  TEST_CASE("Ticks are 1, 2 and 5 of each decade; on long axes powers of ten alone have labels") {
    const auto ticks = ticks_of({0.001, 10, 0, 1});
    REQUIRE(ticks.size() == 13);
    CHECK(ticks[0].label == "1 ms");
    CHECK(ticks[1].label.empty());
    CHECK(ticks[1].seconds == doctest::Approx(0.002));
    CHECK(ticks[12].label == "10 s");
    const auto few = ticks_of({0.9, 6, 0, 1});
    REQUIRE(few.size() == 3);
    CHECK(few[1].label == "2 s");
  }

  TEST_CASE("Durations have a fitting unit") {
    CHECK(format_duration(20) == "20 s");
    CHECK(format_duration(0.0015) == "1.5 ms");
    CHECK(format_duration(0.99999) == "1 s");
    CHECK(format_duration(1e-5) == "10 \u00b5s");
  }

  TEST_CASE("A document is the figure with its style, well-formed") {
    const std::string text =
        to_document("<svg xmlns=\"http://www.w3.org/2000/svg\">\n<g/>\n</svg>\n");
    const test::SvgReader svg(text);
    CHECK(svg.count("", "style") == 1);
    CHECK(text.find("prefers-color-scheme: dark") != std::string::npos);
  }

  TEST_CASE("Samplers have colours by their order, settings dashes") {
    CHECK(color_class("b", {"a", "b"}) == "color-1");
    CHECK(dash_of(0).empty());
    CHECK_FALSE(dash_of(1).empty());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("Each series has a box, a dot per solved run, a cross per time-out and solved/total") {
    const auto panels = make_panels(test::suite_rows(), false);
    const test::SvgReader svg(box_plot(panels[0], {"gl", "uniform", "halton"}));
    CHECK(svg.count("box", "rect") == 9);
    CHECK(svg.count("median", "line") == 9);
    CHECK(svg.count("series color-1", "circle") == 3 * 18);
    CHECK(svg.count("series color-1", "path") == 3 * 2);
    CHECK(svg.count("series color-0", "path") == 0);
    const auto texts = svg.find("series color-1", "text");
    REQUIRE(texts.size() == 6);
    CHECK(std::string(texts[0]->GetText()) == "18/20");
    CHECK(std::string(texts[1]->GetText()) == "uniform, tuned");
  }

  TEST_CASE("The box reaches from the first to the third quartile on a logarithmic axis") {
    std::vector<BenchmarkRow> rows;
    for (const double time_s : {0.001, 0.01, 0.1, 1.0}) rows.push_back(test::run(time_s));
    const auto panels = make_panels(rows, false);
    const test::SvgReader svg(box_plot(panels[0], {"gl"}));
    const auto box = svg.find("box", "rect");
    REQUIRE(box.size() == 1);
    const auto median = svg.find("median", "line");
    REQUIRE(median.size() == 1);
    const double top = box[0]->DoubleAttribute("y");
    const double bottom = top + box[0]->DoubleAttribute("height");
    // Quartiles by nearest rank are 1 ms, 10 ms and 100 ms.
    CHECK(median[0]->DoubleAttribute("y1") == doctest::Approx((top + bottom) / 2).epsilon(0.001));
  }

  TEST_CASE("What failures leave open is dashed, and a series without success has crosses alone") {
    std::vector<BenchmarkRow> rows = {test::run(0.1), test::run(0.2), test::run(5, false),
                                      test::run(5, false)};
    for (BenchmarkRow& row : rows) row.timeout_s = 5;
    const test::SvgReader half(box_plot(make_panels(rows, false)[0], {"gl"}));
    CHECK(half.count("box open", "rect") == 1);
    CHECK(half.count("median", "line") == 1);
    rows.erase(rows.begin(), rows.begin() + 2);
    const test::SvgReader none(box_plot(make_panels(rows, false)[0], {"gl"}));
    CHECK(none.count("box", "rect") + none.count("box open", "rect") == 0);
    CHECK(none.count("series color-0", "path") == 2);
    CHECK(std::string(none.find("solved bad", "text")[0]->GetText()) == "0/2");
  }

  TEST_CASE("Times of zero and names of any kind are drawn") {
    std::vector<BenchmarkRow> rows = {test::run(0)};
    rows[0].problem = rows[0].planner =
        "<script>\xFF and a name that is far too long for its column";
    const Panel panel = make_panels(rows, false).at(0);
    CHECK(test::SvgReader(box_plot(panel, {"gl"})).count("series color-0", "circle") == 1);
    CHECK(test::SvgReader(solved_curves(panel, {"gl"})).count("color-0", "polyline") == 1);
  }

  TEST_CASE("Names cannot smuggle in markup") {
    std::vector<BenchmarkRow> rows = {test::run(0.1)};
    rows[0].sampler = "<script>";
    rows[0].set = "a & b";
    const test::SvgReader svg(box_plot(make_panels(rows, false)[0], {"<script>"}));
    CHECK(svg.count("", "script") == 0);
  }
}

std::vector<Point> points_of(const tinyxml2::XMLElement* element) {
  std::istringstream text(element->Attribute("points"));
  std::vector<Point> points;
  char comma = 0;
  for (Point p; text >> p.x >> comma >> p.y;) points.push_back(p);
  return points;
}

TEST_SUITE("unit") {
  TEST_CASE("There is a curve per series and a legend entry per sampler") {
    const auto panels = make_panels(test::suite_rows(), false);
    const test::SvgReader svg(solved_curves(panels[0], {"gl", "uniform", "halton"}));
    CHECK(svg.count("", "polyline") == 9);
    CHECK(svg.count("legend color-1", "line") == 1);
  }

  TEST_CASE("A curve rises by one run at each success, never falls, and ends at the limit") {
    const auto panels = make_panels(test::suite_rows(), false);
    const test::SvgReader svg(solved_curves(panels[0], {"gl", "uniform", "halton"}));
    for (const auto* curve : svg.find("", "polyline")) {
      const auto points = points_of(curve);
      REQUIRE(points.size() >= 4);
      for (std::size_t i = 1; i < points.size(); ++i) {
        CHECK(points[i].x >= points[i - 1].x);
        CHECK(points[i].y <= points[i - 1].y);
      }
    }
    const auto gl = points_of(svg.find("color-0", "polyline")[0]);
    const auto uniform = points_of(svg.find("color-1", "polyline")[0]);
    CHECK(gl.size() == 2 * 20 + 2);
    CHECK(uniform.size() == 2 * 18 + 2);
    CHECK((gl.front().y - gl.back().y) * 18 / 20 ==
          doctest::Approx(uniform.front().y - uniform.back().y).epsilon(0.001));
    CHECK(gl.back().x == doctest::Approx(uniform.back().x));
  }

  TEST_CASE("A series of invalid problems alone has no curve") {
    std::vector<BenchmarkRow> rows = {test::run(1, false)};
    rows[0].status = PlanStatus::invalid_goal;
    const test::SvgReader svg(solved_curves(make_panels(rows, false)[0], {"gl"}));
    CHECK(svg.count("", "polyline") == 0);
  }

  TEST_CASE("Mean lengths fall at each improvement by its share of the run's first path") {
    std::vector<BenchmarkRow> rows = {test::run(1), test::run(1), test::run(1),
                                      test::run(9, false)};
    rows[0].improvements = {{0, 10}, {0.001, 5}};
    rows[1].improvements = {{0, 4}, {0.002, 3}, {0.1, 2}};
    rows[3].improvements = {{0, 4}, {0.0001, 1}};
    const test::SvgReader svg(length_curves(make_panels(rows, false)[0], {"gl"}));
    const auto curves = svg.find("color-0", "polyline");
    REQUIRE(curves.size() == 1);
    const auto points = points_of(curves[0]);
    REQUIRE(points.size() == 8);
    // From 100 % to 75, 62.5 and 50 %: two runs, whatever others do that were not improved.
    const double fall = points.back().y - points.front().y;
    CHECK(points[2].y - points[0].y == doctest::Approx(fall / 2).epsilon(0.01));
    CHECK(points[4].y - points[0].y == doctest::Approx(fall * 3 / 4).epsilon(0.01));
    CHECK(points[7].x >= points[6].x);
    CHECK(std::string(svg.find("", "title")[0]->GetText()) ==
          "rrt_connect, gl: 2 runs, 50.0 % of the first length at the end");
  }

  TEST_CASE("Where nothing was improved there are no curves of lengths") {
    std::vector<BenchmarkRow> rows = {test::run(1), test::run(1)};
    CHECK(length_curves(make_panels(rows, false)[0], {"gl"}).empty());
    rows[0].improvements = {{0, 10}};
    CHECK(length_curves(make_panels(rows, false)[0], {"gl"}).empty());
  }
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_SUITE("unit") {
  TEST_CASE("Times have a line per series, and failures bound what they touch") {
    const auto panels = make_panels(test::suite_rows(), false);
    const std::string html = time_table(panels[0]);
    const test::SvgReader table(html);
    CHECK(table.count("", "tr") == 10);
    CHECK(has(html, "<td class=\"number bad\">18/20/20</td>"));
    CHECK(has(html, "&gt;20000"));
    CHECK(has(html, "data-seconds=\"20\""));
  }

  TEST_CASE("Ratios are marked as bounds, or open where both medians failed") {
    std::vector<BenchmarkRow> rows = {test::run(1), test::run(9, false)};
    rows[1].sampler = "uniform";
    rows[0].timeout_s = rows[1].timeout_s = 9;
    const auto bound = make_panels(rows, false);
    CHECK(has(ratio_table(compare_series(bound[0], "uniform")), "≥ 9.00"));
    CHECK(has(ratio_table(compare_series(bound[0], "gl")), "≤ 0.11"));
    rows[0].planning_time_s = 0.009;
    const auto far = make_panels(rows, false);
    CHECK(has(ratio_table(compare_series(far[0], "gl")), "≤ 0.001 ("));
    rows[0].is_solved = rows[0].is_path_valid = false;
    const auto open = make_panels(rows, false);
    CHECK(has(ratio_table(compare_series(open[0], "uniform")), ">open<"));
    CHECK(ratio_table({}).empty());
  }

  TEST_CASE("Settings and memories are told") {
    CHECK(has(settings_table(test::suite_rows()), "range=0.5 memory=grid"));
    const std::vector<MemoryRow> memories = {{"grid<", 800, 5, 2500, 1.25}};
    const std::string html = memory_table(memories);
    CHECK(has(html, "grid&lt;"));
    CHECK(test::SvgReader(html).count("", "tr") == 2);
  }
}

}  // namespace

}  // namespace mneme::internal
