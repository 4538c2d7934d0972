// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/chart.h"

#include "report/report_support.h"

#include <cmath>

namespace mneme::internal {
namespace {

using test::run;

std::vector<RunGroup> two_samplers() {
  std::vector<BenchmarkRow> rows = {run(0.001), run(0.001), run(0.01), run(0.1), run(10, false)};
  for (std::size_t i = 2; i < rows.size(); ++i) rows[i].sampler = "uniform";
  return group_runs(rows);
}

TEST_SUITE("unit") {
  TEST_CASE("Every group is a row with its names and solved of total") {
    const test::SvgReader svg(time_chart(two_samplers()));
    const auto first = svg.find("row sampler-0", "text");
    REQUIRE(first.size() == 4);
    CHECK(std::string(first[0]->GetText()) == "S1");
    CHECK(std::string(first[3]->GetText()) == "2/2");
    const auto second = svg.find("row sampler-1", "text");
    REQUIRE(second.size() == 3);
    CHECK(std::string(second[1]->GetText()) == "uniform");
    CHECK(std::string(second[2]->GetText()) == "2/3");
  }

  TEST_CASE("The axis is logarithmic: the same factor is the same distance") {
    const test::SvgReader svg(time_chart(two_samplers()));
    const auto lines = svg.find("grid", "line");
    REQUIRE(lines.size() == 5);  // 1 ms to 10 s
    const double step = lines[1]->DoubleAttribute("x1") - lines[0]->DoubleAttribute("x1");
    CHECK(step > 0);
    CHECK(lines[4]->DoubleAttribute("x1") ==
          doctest::Approx(lines[0]->DoubleAttribute("x1") + 4 * step));
    const auto bars = svg.find("bar", "rect");
    REQUIRE(bars.size() == 1);
    CHECK(bars[0]->DoubleAttribute("x") == doctest::Approx(lines[0]->DoubleAttribute("x1")));
  }

  TEST_CASE("A bar whose end is a failure is marked as censored") {
    const test::SvgReader svg(time_chart(two_samplers()));
    const auto bars = svg.find("bar censored", "rect");
    REQUIRE(bars.size() == 1);
    const auto lines = svg.find("grid", "line");
    CHECK(bars[0]->DoubleAttribute("x") == doctest::Approx(lines[2]->DoubleAttribute("x1")));
    CHECK(bars[0]->DoubleAttribute("x") + bars[0]->DoubleAttribute("width") ==
          doctest::Approx(lines[4]->DoubleAttribute("x1")));
  }

  TEST_CASE("Times of zero and names of any kind are drawn") {
    std::vector<BenchmarkRow> rows = {run(0)};
    rows[0].problem = "<script>\xFF and a name that is far too long for its column";
    const test::SvgReader svg(time_chart(group_runs(rows)));
    CHECK(svg.count("row sampler-0", "rect") == 1);
  }

  TEST_CASE("Without runs there is no chart") { CHECK(time_chart({}).empty()); }
}

}  // namespace
}  // namespace mneme::internal
