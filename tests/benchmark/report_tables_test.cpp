// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/report_tables.h"

#include "benchmark/bench_support.h"

namespace mneme::internal {
namespace {

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
