// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"
#include "statistics/panels.h"
#include "statistics/tables.h"

namespace mneme::internal {
namespace {

using test::contains;

std::string ratios_of(const Panel& panel, const std::string& baseline) {
  return to_html(ratio_table(compare_series(panel, baseline)), "ratios");
}

TEST_SUITE("unit") {
  TEST_CASE("Names are aligned left and numbers right, by characters") {
    Table table{1, {"name", "ms"}, {}};
    table.lines.push_back({{"\xC3\xA4", false, {}}, {"1000", false, {}}});
    CHECK(to_text(table) == "name    ms\n\xC3\xA4     1000\n");
  }

  TEST_CASE("Ratios are written with their interval and what they bound") {
    CHECK(format_ratio({27.12, 4.8, 133, false, false}) == "27.1 (4.80 to 133)");
    CHECK(format_ratio({0.0123, 0.01, 0.5, true, false}) == "≥ 0.012 (0.01 to 0.50)");
    CHECK(format_ratio({2, 1, 3, false, true}) == "≤ 2.00 (1.00 to 3.00)");
    CHECK(format_ratio({2, 1, 3, true, true}) == "open");
  }

  TEST_CASE("Ranks agree with the definition for small and large counts") {
    CHECK(nearest_rank(50, 1) == 1);
    CHECK(nearest_rank(50, 3) == 2);
    CHECK(nearest_rank(95, 10) == 10);
    CHECK(nearest_rank(95, 100) == 95);
    CHECK(nearest_rank(99, 1000) == 990);
    CHECK(nearest_rank(100, 7) == 7);
  }

  TEST_CASE("Milliseconds keep three significant digits") {
    CHECK(format_ms(0.0000123) == "0.01");
    CHECK(format_ms(0.001234) == "1.23");
    CHECK(format_ms(0.01234) == "12.3");
    CHECK(format_ms(0.1234) == "123");
    CHECK(format_ms(10) == "10000");
  }

  TEST_CASE("Times have a line per series, and failures bound what they touch") {
    const auto panels = make_panels(test::suite_rows(), false);
    const std::vector<SetSummary> summaries(panels[0].series.begin(), panels[0].series.end());
    const std::string html =
        to_html(summary_table(summaries, {"planner", "solved/valid/total", "max ms"}), "times");
    const test::SvgReader table(html);
    CHECK(table.count("", "tr") == 10);
    CHECK(contains(html, "<td class=\"number bad\">18/20/20</td>"));
    CHECK(contains(html, "&gt;20000"));
    CHECK(contains(html, "data-value=\"20\""));
  }

  TEST_CASE("Ratios are marked as bounds, or open where both medians failed") {
    std::vector<BenchmarkRow> rows = {test::run(1), test::run(9, false)};
    rows[1].sampler = "uniform";
    rows[0].timeout_s = rows[1].timeout_s = 9;
    const auto bound = make_panels(rows, false);
    CHECK(contains(ratios_of(bound[0], "uniform"), "≥ 9.00"));
    CHECK(contains(ratios_of(bound[0], "gl"), "≤ 0.11"));
    rows[0].planning_time_s = 0.009;
    const auto far = make_panels(rows, false);
    CHECK(contains(ratios_of(far[0], "gl"), "≤ 0.001 ("));
    rows[0].is_solved = rows[0].is_path_valid = false;
    const auto open = make_panels(rows, false);
    CHECK(contains(ratios_of(open[0], "uniform"), ">open<"));
    CHECK(to_html(ratio_table({}), "ratios").empty());
  }

  TEST_CASE("Settings and memories have tables") {
    CHECK(
        contains(to_html(settings_table(test::suite_rows()), "settings"), "range=0.5 memory=grid"));
    const std::vector<MemoryRow> memories = {{"grid<", 800, 5, 2500, 1.25}};
    const std::string html = to_html(memory_table(memories), "memories");
    CHECK(contains(html, "grid&lt;"));
    CHECK(test::SvgReader(html).count("", "tr") == 2);
  }
}

}  // namespace

}  // namespace mneme::internal
