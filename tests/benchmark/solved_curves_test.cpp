// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/solved_curves.h"

#include "benchmark/bench_support.h"
#include "report/svg_writer.h"

#include <sstream>

namespace mneme::internal {
namespace {

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
}

}  // namespace
}  // namespace mneme::internal
