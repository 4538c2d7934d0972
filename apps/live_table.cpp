// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "live_table.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

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

}  // namespace

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

std::string printable_table(std::vector<SetSummary> summaries) {
  for (SetSummary& summary : summaries) {
    summary.set = printable(summary.set);
    summary.setting = printable(summary.setting);
  }
  return to_table(summaries);
}

LiveTable::LiveTable(std::size_t total)
    : total_(static_cast<std::int64_t>(total)),
      progress_("planning"),
      is_terminal_(has_terminal()) {}

LiveTable::~LiveTable() { erase(); }

void LiveTable::update(std::span<const BenchmarkRow> rows) {
  const BenchmarkRow& last = rows.back();
  const std::string detail =
      fmt::format("{}#{} {}", printable(last.set), printable(last.problem), to_string(last.status));
  const Clock::time_point now = Clock::now();
  if (is_terminal_ && std::chrono::duration<double>(now - shown_).count() > kInterval) {
    shown_ = now;
    draw(rows);
  }
  progress_.update(static_cast<std::int64_t>(rows.size()), total_, detail);
}

void LiveTable::draw(std::span<const BenchmarkRow> rows) {
  const winsize size = terminal_size();
  erase();
  const std::string table =
      fit_table(printable_table(summarize_sets(rows)), size.ws_col - 1, size.ws_row - kLinesBelow);
  fmt::print(stderr, "{}", table);
  std::fflush(stderr);
  lines_ = static_cast<int>(std::count(table.begin(), table.end(), '\n'));
}

void LiveTable::erase() {
  if (lines_ == 0) return;
  // Back over the bar and up to the first line of the table, then clear all below.
  fmt::print(stderr, "\r\033[{}A\033[J", lines_);
  lines_ = 0;
}

}  // namespace mneme::app
