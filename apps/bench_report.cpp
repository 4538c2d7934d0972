// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "bench_output.h"
#include "commands.h"
#include "console.h"
#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>

namespace mneme::app {
namespace {

namespace fs = std::filesystem;

struct ReportRun {
  std::vector<std::string> csv_files;
  std::string out = "report.html";
  ReportOptions options;
  bool is_json = false;
};

using Json = nlohmann::ordered_json;

struct ExportRun {
  std::vector<std::string> csv_files;
  std::string log_directory;
};

Result<std::vector<BenchmarkRow>> read_all(const std::vector<std::string>& paths) {
  std::vector<BenchmarkRow> rows;
  for (const std::string& path : paths) {
    std::vector<BenchmarkRow> read = MNEME_TRY(read_rows(path));
    std::ranges::move(read, std::back_inserter(rows));
  }
  if (rows.empty()) {
    return fail(ErrorCode::invalid, fmt::format("'{}' has no runs", paths.front()));
  }
  return rows;
}

/// The memories beside the CSV files, each once.
Result<std::vector<MemoryRow>> memories_beside(const std::vector<std::string>& paths) {
  std::vector<MemoryRow> all;
  for (const std::string& path : paths) {
    const std::string beside = (fs::path(path).parent_path() / "memories.csv").string();
    std::vector<MemoryRow> read = MNEME_TRY(read_memories(beside));
    for (MemoryRow& row : read) {
      std::erase_if(all, [&](const MemoryRow& r) { return r.name == row.name; });
      all.push_back(std::move(row));
    }
  }
  return all;
}

Json to_json(const TimeRatio& ratio) {
  return {{"value", ratio.value},
          {"low", ratio.low},
          {"high", ratio.high},
          {"is_at_least", ratio.is_at_least},
          {"is_at_most", ratio.is_at_most}};
}

Json to_json(const std::vector<SeriesRatio>& ratios) {
  Json all = Json::array();
  for (const auto& [set, other, reference, ratio] : ratios) {
    all.push_back({{"set", set},
                   {"this", other},
                   {"against", reference},
                   {"pairs", ratio.pairs},
                   {"p50", to_json(ratio.p50)},
                   {"p95", to_json(ratio.p95)},
                   {"p99", to_json(ratio.p99)},
                   {"mean", to_json(ratio.mean)},
                   {"geometric", to_json(ratio.geometric)}});
  }
  return all;
}

Result<ExitCode> run_report(const ReportRun& run) {
  std::vector<ReadFile> inputs;
  add_files("a file of runs", run.csv_files, inputs);
  MNEME_TRY(check_outputs(std::array{run.out}, inputs));
  const auto rows = MNEME_TRY(read_all(run.csv_files));
  const auto memories = MNEME_TRY(memories_beside(run.csv_files));
  const BenchmarkReport report = make_benchmark_report(rows, memories, run.options);
  MNEME_TRY(write_report(run.out, report));
  const std::vector<SeriesRatio> ratios = compare_series(rows, run.options.baseline);
  if (run.is_json) {
    Json json = summary_json(rows);
    json["ratios"] = to_json(ratios);
    print_json(json);
    return ExitCode::done;
  }
  fmt::print("{}: {} with {}\n", run.out, counted(rows.size(), "run", "runs"),
             counted(report.figures.size(), "figure", "figures"));
  if (!ratios.empty()) {
    fmt::print("\nHow much faster, with 95 % intervals:\n{}", to_table(ratios));
  }
  return ExitCode::done;
}

Result<ExitCode> run_export(const ExportRun& run) {
  const auto rows = MNEME_TRY(read_all(run.csv_files));
  MNEME_TRY(write_ompl_logs(run.log_directory, rows));
  return ExitCode::done;
}

}  // namespace

void add_bench_report(CLI::App& bench, Action& action) {
  const auto made = std::make_shared<ReportRun>();
  CLI::App& report =
      add_command(bench, action, "report", "Make an HTML page and SVG figures from runs",
                  "bench report runs.csv -o report.html", made, run_report);
  report.add_option("CSV", made->csv_files, "files of 'bench run'")->required();
  report.add_option("-o,--output", made->out,
                    "page to write (default report.html), with its figures next to it");
  report.add_option("--title", made->options.title, "title of the page");
  report.add_option("--baseline", made->options.baseline,
                    "sampler to compare the others with (default uniform)");
  report.add_flag("--by-problem", made->options.by_problem,
                  "a figure for each problem instead of each set");
  add_json(report, made->is_json);

  const auto logs = std::make_shared<ExportRun>();
  CLI::App& to_logs = add_command(bench, action, "export", "Write runs for other programs",
                                  "bench export runs.csv --ompl-logs logs\n"
                                  "  ompl_benchmark_statistics logs/*.log -d runs.db",
                                  logs, run_export);
  to_logs.add_option("CSV", logs->csv_files, "files of 'bench run'")->required();
  to_logs
      .add_option("--ompl-logs", logs->log_directory,
                  "directory for logs that ompl_benchmark_statistics reads, one per problem")
      ->required();
}

}  // namespace mneme::app
