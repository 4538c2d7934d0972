// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/comparisons.h"
#include "benchmark/panels.h"
#include "mneme/benchmark.h"
#include "report/text_table.h"

namespace mneme {
namespace {

constexpr std::size_t kNameColumns = 3;
using Lines = std::vector<std::vector<std::string>>;

void add_lines(const internal::Panel& panel, const std::string& baseline, Lines& lines) {
  for (const auto& [kind, other, reference, ratio] : internal::compare_series(panel, baseline)) {
    lines.push_back({panel.name, internal::series_name(*other), internal::series_name(*reference),
                     std::to_string(ratio.pairs), internal::format_ratio(ratio.p50),
                     internal::format_ratio(ratio.p95), internal::format_ratio(ratio.p99),
                     internal::format_ratio(ratio.mean), internal::format_ratio(ratio.geometric)});
  }
}

/// Every series of every set in one panel; rows keep their set, which tells problems apart.
internal::Panel pool(std::vector<internal::Panel> panels) {
  internal::Panel all{"all", {}, 0};
  for (internal::Panel& panel : panels) {
    for (internal::Series& series : panel.series) {
      const auto same = std::ranges::find_if(all.series, [&](const internal::Series& s) {
        return s.planner == series.planner && s.sampler == series.sampler &&
               s.setting == series.setting;
      });
      if (same == all.series.end())
        all.series.push_back(std::move(series));
      else
        std::ranges::move(series.rows, std::back_inserter(same->rows));
    }
  }
  return all;
}

}  // namespace

std::string to_ratio_table(std::span<const BenchmarkRow> rows, const std::string& baseline) {
  std::vector<internal::Panel> panels = internal::make_panels(rows, false);
  Lines lines = {{"set", "this", "against", "pairs", "p50", "p95", "p99", "mean", "geometric"}};
  for (const internal::Panel& panel : panels) add_lines(panel, baseline, lines);
  if (panels.size() > 1) add_lines(pool(std::move(panels)), baseline, lines);
  return lines.size() == 1 ? "" : internal::text_table(lines, kNameColumns);
}

}  // namespace mneme
