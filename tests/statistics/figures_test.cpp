// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"
#include "statistics/figures.h"
#include "report/markup.h"

#include <sstream>

namespace mneme::internal {
namespace {

using test::contains;

TEST_SUITE("unit") {
  TEST_CASE("The same factor is the same distance, and times beyond the ends stay on them") {
    const TimeAxis axis{0.001, 10, 400};
    CHECK(axis.at(0.001) == doctest::Approx(0));
    CHECK(axis.at(0.01) == doctest::Approx(100));
    CHECK(axis.at(10) == doctest::Approx(400));
    CHECK(axis.at(100) == doctest::Approx(400));
    CHECK(axis.at(0) == doctest::Approx(0));
  }

  TEST_CASE("Ticks are 1, 2 and 5 of each decade; on long axes powers of ten alone have labels") {
    const auto ticks = ticks_of({0.001, 10});
    REQUIRE(ticks.size() == 13);
    CHECK(ticks[0].label == "1 ms");
    CHECK(ticks[1].label.empty());
    CHECK(ticks[1].seconds == doctest::Approx(0.002));
    CHECK(ticks[12].label == "10 s");
    const auto few = ticks_of({0.9, 6});
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
    CHECK(contains(text, "prefers-color-scheme: dark"));
  }

  TEST_CASE("Samplers have colours by their order, settings dashes") {
    CHECK(color_class("b", {"a", "b"}) == "color-1");
    CHECK(dash_of(0) == "none");
    CHECK(dash_of(1) != "none");
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

  TEST_CASE("Times of zero and names of any kind are drawn, and names are no markup") {
    std::vector<BenchmarkRow> rows = {test::run(0)};
    rows[0].problem = rows[0].planner =
        "<script>\xFF and a name that is far too long for its column";
    rows[0].sampler = "<script>";
    rows[0].set = "a & b";
    const test::SvgReader svg(solved_curves(make_panels(rows, false).at(0), {"<script>"}));
    CHECK(svg.count("color-0", "polyline") == 1);
    CHECK(svg.count("", "script") == 0);
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

  TEST_CASE("A dot is open if a median is a failure, and not if just half of the runs succeed") {
    std::vector<BenchmarkRow> rows(8, test::run(1));
    for (std::size_t i = 0; i < 4; ++i) rows[i].sampler = "uniform";
    const auto open_dots = [&] {
      const test::SvgReader svg(difficulty_figure(make_panels(rows, true), "uniform", "gl"));
      return svg.count("box open", "circle");
    };
    rows[6] = rows[7] = test::run(20, false);
    CHECK(open_dots() == 0);
    rows[5] = rows[7];
    CHECK(open_dots() == 1);
  }
}

}  // namespace

}  // namespace mneme::internal
