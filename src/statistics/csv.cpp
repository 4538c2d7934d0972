// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/csv.h"

#include "mneme/statistics.h"

#include "base/fail.h"
#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <type_traits>
#include <utility>

namespace mneme::internal {

std::optional<CsvRecord> read_csv_record(std::string_view text, std::size_t begin) {
  CsvRecord record;
  std::string field;
  bool is_quoted = false;
  for (std::size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_doubled = is_quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"';
    if (is_doubled) {
      field += text[++i];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && (c == ',' || c == '\n')) {
      record.fields.push_back(std::move(field));
      field.clear();
      if (c == '\n') {
        record.end = i + 1;
        return record;
      }
    } else {
      field += c;
    }
  }
  return std::nullopt;
}

}  // namespace mneme::internal

namespace mneme {
namespace {

constexpr std::array kStatuses = {PlanStatus::solved,          PlanStatus::timeout,
                                  PlanStatus::iteration_limit, PlanStatus::node_limit,
                                  PlanStatus::cancelled,       PlanStatus::invalid_start,
                                  PlanStatus::invalid_goal};

/// Columns added over time: files of older versions end before one of them.
constexpr std::array<std::string_view, 5> kFirstNewColumns = {
    ",setting,", ",improvements,", ",replayed,", ",duration_s,", ",is_warm\n"};

template <class T, class Row>
concept RowOf = std::same_as<std::remove_const_t<T>, Row>;

/// Calls `visit(name, value)` for every column, in order.
template <class Visitor>
void visit_columns(RowOf<BenchmarkRow> auto& row, Visitor&& visit) {
  visit("problem", row.problem);
  visit("set", row.set);
  visit("planner", row.planner);
  visit("sampler", row.sampler);
  visit("seed", row.seed);
  visit("status", row.status);
  visit("is_valid", row.is_path_valid);
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
  visit("is_warm", row.is_warm);
}
template <class Visitor>
void visit_columns(RowOf<MemoryRow> auto& row, Visitor&& visit) {
  visit("name", row.name);
  visit("primitives", row.primitives);
  visit("components", row.components);
  visit("bytes", row.bytes);
  visit("learning_time_s", row.learning_time_s);
}

std::string csv_field(const std::string& text) { return internal::escape_csv(text); }
std::string csv_field(PlanStatus status) { return std::string(to_string(status)); }
std::string csv_field(bool is_true) { return is_true ? "1" : "0"; }
/// "0:11.2 0.0012:9.8": seconds and path lengths.
std::string csv_field(const std::vector<Improved>& improvements) {
  std::string text;
  for (const Improved& path : improvements) {
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", path.time_s, path.path_length);
  }
  return text;
}
template <class T>
std::string csv_field(T number) {
  return fmt::format("{}", number);
}

// Each is false for texts that csv_field() does not write.
bool read_field(const std::string& text, std::string& value) {
  value = text;
  return true;
}
bool read_field(const std::string& text, PlanStatus& value) {
  const auto status = std::ranges::find(
      kStatuses, text, [](PlanStatus known) { return std::string(to_string(known)); });
  if (status != kStatuses.end()) value = *status;
  return status != kStatuses.end();
}
bool read_field(const std::string& text, bool& value) {
  value = text == "1";
  return text == "0" || text == "1";
}
bool read_field(const std::string& text, std::vector<Improved>& value) {
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view pair = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
    const std::size_t colon = pair.find(':');
    Improved& path = value.emplace_back();
    if (colon == pair.npos || !internal::read_csv_number(pair.substr(0, colon), path.time_s) ||
        !internal::read_csv_number(pair.substr(colon + 1), path.path_length)) {
      return false;
    }
  }
  return true;
}
template <class T>
bool read_field(const std::string& text, T& number) {
  return internal::read_csv_number(text, number);
}

template <class T>
constexpr std::string_view expected_of() {
  if constexpr (std::same_as<T, PlanStatus>) return "a status";
  if constexpr (std::same_as<T, bool>) return "0 or 1";
  if constexpr (std::same_as<T, std::vector<Improved>>) {
    return "SECONDS:LENGTH pairs of numbers of 0 or more";
  }
  return std::integral<T> ? "a whole number of 0 or more" : "a finite number of 0 or more";
}

template <class Row>
std::string header_of() {
  std::string header;
  const Row row;
  visit_columns(row, [&](std::string_view name, const auto&) {
    header += fmt::format("{}{}", header.empty() ? "" : ",", name);
  });
  return header + "\n";
}

template <class Row>
std::string line_of(const Row& row) {
  std::string line;
  visit_columns(row, [&](std::string_view, const auto& value) { line += csv_field(value) + ","; });
  line.back() = '\n';
  return line;
}

template <class Row>
std::string text_of(std::span<const Row> rows) {
  std::string text = header_of<Row>();
  for (const Row& row : rows) text += line_of(row);
  return text;
}

/// The row of a line; the last columns may be missing.
template <class Row>
Result<Row> read_row(const std::vector<std::string>& fields) {
  Row row;
  std::string fault;
  auto field = fields.begin();
  visit_columns(row, [&]<class T>(std::string_view name, T& value) {
    if (field == fields.end()) return;
    if (!read_field(*field, value) && fault.empty()) {
      fault = fmt::format("column {}: expected {}, got \"{}\"", name, expected_of<T>(), *field);
    }
    ++field;
  });
  if (!fault.empty()) return fail(ErrorCode::parse, fault);
  return row;
}

/// The complete lines below a header that `is_header` accepts; `end` becomes their size in bytes.
template <class Row, class IsHeader>
Result<std::vector<Row>> read_rows_of(std::string_view text, const std::string& source,
                                      IsHeader&& is_header, std::size_t& end) {
  std::vector<Row> rows;
  const auto header = internal::read_csv_record(text, 0);
  if (!header) return rows;
  if (!is_header(text.substr(0, header->end))) {
    const std::string columns = header_of<Row>();
    return fail(ErrorCode::parse, "{}:1: expected the columns {}", source,
                columns.substr(0, columns.size() - 1));
  }
  end = header->end;
  while (const auto record = internal::read_csv_record(text, end)) {
    const std::string place = fmt::format("{}: line {}: ", source, rows.size() + 2);
    if (record->fields.size() != header->fields.size()) {
      return fail(ErrorCode::parse, "{}expected {} fields, got {}", place, header->fields.size(),
                  record->fields.size());
    }
    Result<Row> row = read_row<Row>(record->fields);
    if (!row) return fail(ErrorCode::parse, "{}{}", place, row.error().message);
    rows.push_back(*std::move(row));
    end = record->end;
  }
  return rows;
}

}  // namespace

std::string csv_header() { return header_of<BenchmarkRow>(); }
std::string to_csv_line(const BenchmarkRow& row) { return line_of(row); }
std::string to_csv(std::span<const BenchmarkRow> rows) { return text_of(rows); }
std::string to_csv(std::span<const MemoryRow> rows) { return text_of(rows); }

Result<CsvRuns> parse_csv(std::string_view text, const std::string& source) {
  const std::string columns = csv_header();
  const auto is_header = [&](std::string_view line) {
    return line == columns || std::ranges::any_of(kFirstNewColumns, [&](std::string_view column) {
             return line == columns.substr(0, columns.find(column)) + "\n";
           });
  };
  CsvRuns runs;
  runs.rows = MNEME_TRY(read_rows_of<BenchmarkRow>(text, source, is_header, runs.complete_bytes));
  for (BenchmarkRow& row : runs.rows) row.is_solved = row.status == PlanStatus::solved;
  return runs;
}

Result<std::vector<MemoryRow>> parse_memory_csv(std::string_view text, const std::string& source) {
  const auto is_header = [](std::string_view line) { return line == header_of<MemoryRow>(); };
  std::size_t end = 0;
  return read_rows_of<MemoryRow>(text, source, is_header, end);
}

}  // namespace mneme
