// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_output.h"

#include "console.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

namespace mneme::app {
namespace {

constexpr double kInterval = 0.25;
/// The bar, and the line that the cursor stands in.
constexpr int kLinesBelow = 2;

winsize terminal_size() {
  winsize size{};
  ioctl(STDERR_FILENO, TIOCGWINSZ, &size);
  if (size.ws_col == 0) size.ws_col = 80;
  if (size.ws_row == 0) size.ws_row = 24;
  return size;
}

/// The bytes of `line` that hold its first `width` characters.
std::string_view cut(std::string_view line, int width) {
  int characters = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_start = (static_cast<unsigned char>(line[i]) & 0xC0U) != 0x80U;
    if (is_start && ++characters > width) return line.substr(0, i);
  }
  return line;
}

/// The first lines of `table`, each cut to `width` columns; a last line says how many are missing.
std::string fit_table(std::string_view table, int width, int height) {
  std::vector<std::string_view> lines;
  while (!table.empty()) {
    const std::size_t end = std::min(table.find('\n'), table.size());
    lines.push_back(table.substr(0, end));
    table.remove_prefix(std::min(end + 1, table.size()));
  }
  std::string text;
  const std::size_t room = static_cast<std::size_t>(std::max(height, 2));
  const bool fits = lines.size() <= room;
  const std::size_t shown = fits ? lines.size() : room - 1;
  for (std::size_t i = 0; i < shown; ++i) text += fmt::format("{}\n", cut(lines[i], width));
  if (!fits)
    text += fmt::format("{}\n", cut(fmt::format("... {} more", lines.size() - shown), width));
  return text;
}

/// to_table() without control characters in names.
std::string printable_table(std::vector<SetSummary> summaries) {
  for (SetSummary& summary : summaries) {
    summary.set = printable(summary.set);
    summary.setting = printable(summary.setting);
  }
  return to_table(summaries);
}

/// A table of results that grows on a terminal, or a line every few seconds. Not thread-safe.
class LiveTable {
 public:
  explicit LiveTable(std::size_t total) : total_(static_cast<std::int64_t>(total)) {}
  LiveTable(const LiveTable&) = delete;
  LiveTable& operator=(const LiveTable&) = delete;
  /// Removes the table.
  ~LiveTable() { erase(); }

  /// Shows `rows`, the last of which has just come. Cheap to call often.
  void update(std::span<const BenchmarkRow> rows) {
    const BenchmarkRow& last = rows.back();
    const std::string detail = fmt::format("{}#{} {}", printable(last.set), printable(last.problem),
                                           to_string(last.status));
    if (is_terminal_ && since_shown_.elapsed_s() > kInterval) {
      since_shown_ = {};
      draw(rows);
    }
    progress_.update(static_cast<std::int64_t>(rows.size()), total_, detail);
  }

 private:
  void draw(std::span<const BenchmarkRow> rows) {
    const winsize size = terminal_size();
    erase();
    const std::string table = fit_table(printable_table(summarize_sets(rows)), size.ws_col - 1,
                                        size.ws_row - kLinesBelow);
    fmt::print(stderr, "{}", table);
    std::fflush(stderr);
    lines_ = static_cast<int>(std::count(table.begin(), table.end(), '\n'));
  }
  void erase() {
    if (lines_ == 0) return;
    // Back over the bar and up to the first line of the table, then clear all below.
    fmt::print(stderr, "\r\033[{}A\033[J", lines_);
    lines_ = 0;
  }

  std::int64_t total_;
  Progress progress_{"planning"};  ///< for what is no terminal, and the bar below the table
  bool is_terminal_ = has_terminal();
  int lines_ = 0;  ///< of the table that is shown
  Stopwatch since_shown_;
};

using Json = nlohmann::ordered_json;

Json to_json(const SetSummary& summary) {
  return {{"set", summary.set},
          {"planner", summary.planner},
          {"sampler", summary.sampler},
          {"setting", summary.setting},
          {"solved", summary.times.solved},
          {"valid", summary.valid},
          {"total", summary.total},
          {"invalid_paths", summary.invalid_paths},
          {"planning_p50_s", summary.times.p50},
          {"planning_mean_s", summary.times.mean},
          {"planning_p95_s", summary.times.p95},
          {"planning_p99_s", summary.times.p99},
          {"planning_max_s", summary.times.max},
          {"total_p50_s", summary.total_times.p50},
          {"total_p95_s", summary.total_times.p95},
          {"total_p99_s", summary.total_times.p99},
          {"total_max_s", summary.total_times.max},
          {"iterations_p50", summary.iterations_p50},
          {"states_p50", summary.states_p50},
          {"simplification_p50_s", summary.simplification_p50_s},
          {"path_length_mean", summary.path_length_mean},
          {"duration_mean_s", summary.duration_mean_s}};
}

/// "cage#7" once for each problem whose ends are invalid.
std::vector<std::string> invalid_problems(const std::vector<BenchmarkRow>& rows) {
  std::vector<std::string> names;
  for (const BenchmarkRow& row : rows) {
    const std::string name = row.set + "#" + row.problem;
    const bool is_new = std::find(names.begin(), names.end(), name) == names.end();
    if (is_invalid_problem(row) && is_new) names.push_back(name);
  }
  return names;
}

}  // namespace

OnRows show_rows() {
  return [table = std::shared_ptr<LiveTable>()](auto rows, std::size_t total) mutable {
    if (!table) table = std::make_shared<LiveTable>(total);
    table->update(rows);
  };
}

nlohmann::ordered_json summary_json(const std::vector<BenchmarkRow>& rows) {
  Json sets = Json::array();
  for (const SetSummary& summary : summarize_sets(rows)) sets.push_back(to_json(summary));
  return {{"runs", rows.size()},
          {"timing", describe_timing(rows)},
          {"isa", to_string(default_isa())},
          {"sets", sets},
          {"invalid", invalid_problems(rows)}};
}

void print_bench_results(const std::vector<BenchmarkRow>& rows, bool is_json) {
  if (is_json) {
    print_json(summary_json(rows));
    return;
  }
  fmt::print("{}", printable_table(summarize_sets(rows)));
  fmt::print("timing: {}\n", describe_timing(rows));
  if (const auto invalid = invalid_problems(rows); !invalid.empty()) {
    fmt::print("invalid start or goal, excluded: {}\n",
               printable(fmt::format("{}", fmt::join(invalid, ", "))));
  }
}

ExitCode judge_rows(const std::vector<BenchmarkRow>& rows) {
  const auto wrong = std::count_if(rows.begin(), rows.end(), [](const BenchmarkRow& row) {
    return row.is_solved && !row.is_path_valid;
  });
  if (wrong == 0) return ExitCode::done;
  print_error(fmt::format("{} failed the exact check at ten times the resolution",
                          counted(wrong, "path", "paths")));
  return ExitCode::failure;
}

}  // namespace mneme::app
