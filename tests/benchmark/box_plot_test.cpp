// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/box_plot.h"

#include "benchmark/bench_support.h"

#include <algorithm>

namespace mneme::internal {
namespace {

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

  TEST_CASE("Names cannot smuggle in markup") {
    std::vector<BenchmarkRow> rows = {test::run(0.1)};
    rows[0].sampler = "<script>";
    rows[0].set = "a & b";
    const test::SvgReader svg(box_plot(make_panels(rows, false)[0], {"<script>"}));
    CHECK(svg.count("", "script") == 0);
  }
}

}  // namespace
}  // namespace mneme::internal
