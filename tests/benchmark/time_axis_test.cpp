// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/time_axis.h"

#include "report/report_support.h"

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

}  // namespace
}  // namespace mneme::internal
