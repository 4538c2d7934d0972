// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// CSV files (RFC 4180): the columns of a benchmark's rows, and how lines are read.
#pragma once

#include "mneme/benchmark.h"

#include <charconv>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Calls `visit(name, value)` for every column after problem, set, planner, sampler, seed, status
/// and is_valid, in order.
template <class Row, class Visitor>
void visit_columns(Row& row, Visitor&& visit) {
  visit("planning_time_s", row.planning_time_s);
  visit("total_time_s", row.total_time_s);
  visit("retrieval_time_s", row.retrieval_time_s);
  visit("simplification_time_s", row.simplification_time_s);
  visit("verification_time_s", row.verification_time_s);
  visit("iterations", row.iterations);
  visit("states_checked", row.states_checked);
  visit("motions_checked", row.motions_checked);
  visit("nodes", row.nodes);
  visit("path_length", row.path_length);
  visit("components", row.components);
  visit("timeout_s", row.timeout_s);
  visit("setting", row.setting);
  visit("settings", row.settings);
  visit("learning_time_s", row.learning_time_s);
  visit("isa", row.isa);
  visit("machine", row.machine);
  visit("version", row.version);
  visit("started", row.started);
  visit("improvements", row.improvements);
  visit("replayed", row.replayed);
  visit("duration_s", row.duration_s);
}

/// The fields of one line, and where the next one begins.
struct CsvRecord {
  std::vector<std::string> fields;
  std::size_t end = 0;
};
/// The line of `text` that begins at `begin`; nothing if it does not end.
[[nodiscard]] std::optional<CsvRecord> read_csv_record(std::string_view text, std::size_t begin);

/// True if all of `text` is a finite number of 0 or more, as all that we write are; it is then in
/// `value`.
template <class T>
[[nodiscard]] bool read_csv_number(std::string_view text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !(value >= T{0})) return false;
  return !std::floating_point<T> || value <= std::numeric_limits<T>::max();
}

/// "0:11.2 0.0012:9.8": seconds and path lengths.
[[nodiscard]] std::string to_text(const std::vector<Improved>& improvements);
/// False if `text` is not of that form.
[[nodiscard]] bool read_improvements(std::string_view text, std::vector<Improved>& improvements);

}  // namespace mneme::internal
