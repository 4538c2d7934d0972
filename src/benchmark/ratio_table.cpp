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

/// The rows as those of one set, whose problems keep the name of theirs.
std::vector<BenchmarkRow> pool(std::span<const BenchmarkRow> rows) {
  std::vector<BenchmarkRow> pooled(rows.begin(), rows.end());
  for (BenchmarkRow& row : pooled) {
    row.problem = row.set + "#" + row.problem;
    row.set = "all";
  }
  return pooled;
}

}  // namespace

std::string to_ratio_table(std::span<const BenchmarkRow> rows, const std::string& baseline) {
  const std::vector<internal::Panel> panels = internal::make_panels(rows, false);
  Lines lines = {{"set", "this", "against", "pairs", "p50", "p95", "p99", "mean", "geometric"}};
  for (const internal::Panel& panel : panels) add_lines(panel, baseline, lines);
  if (panels.size() > 1) {
    add_lines(internal::make_panels(pool(rows), false).front(), baseline, lines);
  }
  return lines.size() == 1 ? "" : internal::text_table(lines, kNameColumns);
}

}  // namespace mneme
