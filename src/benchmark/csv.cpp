// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/csv.h"

#include "mneme/benchmark.h"
#include "mneme/report.h"

#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
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

std::string to_text(const std::vector<Improved>& improvements) {
  std::string text;
  for (const Improved& path : improvements) {
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", path.time_s, path.path_length);
  }
  return text;
}

bool read_improvements(std::string_view text, std::vector<Improved>& improvements) {
  improvements.clear();
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(pair.size() + 1, text.size()));
    const std::size_t colon = pair.find(':');
    Improved& path = improvements.emplace_back();
    if (colon == pair.npos || !read_csv_number(pair.substr(0, colon), path.time_s) ||
        !read_csv_number(pair.substr(colon + 1), path.path_length)) {
      return false;
    }
  }
  return true;
}

}  // namespace mneme::internal

namespace mneme {
namespace {

constexpr std::array kStatuses = {PlanStatus::solved,          PlanStatus::timeout,
                                  PlanStatus::iteration_limit, PlanStatus::node_limit,
                                  PlanStatus::cancelled,       PlanStatus::invalid_start,
                                  PlanStatus::invalid_goal};

/// Files of older versions end before one of them.
constexpr std::array<std::string_view, 4> kFirstNewColumns = {",setting,", ",improvements,",
                                                              ",replayed,", ",duration_s\n"};

std::string csv_field(const std::string& text) { return internal::escape_csv(text); }
std::string csv_field(const std::vector<Improved>& all) { return internal::to_text(all); }
template <class T>
std::string csv_field(T number) {
  return fmt::format("{}", number);
}

/// Reads the fields of one line, and remembers the first that is wrong.
class RowReader {
 public:
  explicit RowReader(const std::vector<std::string>& fields) : fields_(fields) {}

  BenchmarkRow read() {
    BenchmarkRow row;
    row.problem = next();
    row.set = next();
    row.planner = next();
    row.sampler = next();
    read("seed", row.seed);
    read_status(row);
    read_is_valid(row);
    internal::visit_columns(row, [&](const char* name, auto& value) {
      if (position_ < fields_.size()) read(name, value);
    });
    return row;
  }
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  const std::string& next() { return fields_[position_++]; }

  void read_status(BenchmarkRow& row) {
    const std::string& name = next();
    for (const PlanStatus status : kStatuses) {
      if (to_string(status) != name) continue;
      row.status = status;
      row.is_solved = status == PlanStatus::solved;
      return;
    }
    note("status", "a status", name);
  }

  void read_is_valid(BenchmarkRow& row) {
    const std::string& text = next();
    row.is_path_valid = text == "1";
    if (text != "0" && text != "1") note("is_valid", "0 or 1", text);
  }

  void read(const char*, std::string& value) { value = next(); }
  void read(const char* name, std::vector<Improved>& value) {
    const std::string& text = next();
    if (internal::read_improvements(text, value)) return;
    note(name, "SECONDS:LENGTH pairs of numbers of 0 or more", text);
  }
  template <class T>
  void read(const char* name, T& value) {
    const std::string& text = next();
    if (internal::read_csv_number(text, value)) return;
    note(name, std::integral<T> ? "a whole number of 0 or more" : "a finite number of 0 or more",
         text);
  }

  void note(const char* column, const char* expected, const std::string& text) {
    if (fault_.empty()) {
      fault_ = fmt::format("column {}: expected {}, got \"{}\"", column, expected, text);
    }
  }

  const std::vector<std::string>& fields_;
  std::size_t position_ = 0;
  std::string fault_;
};

constexpr std::string_view kHeader = "name,primitives,components,bytes,learning_time_s\n";

}  // namespace

std::string csv_header() {
  std::string header = "problem,set,planner,sampler,seed,status,is_valid";
  const BenchmarkRow row;
  internal::visit_columns(
      row, [&](const char* name, const auto&) { header += fmt::format(",{}", name); });
  return header + "\n";
}

std::string to_csv_line(const BenchmarkRow& row) {
  std::string line = fmt::format("{},{},{},{},{},{},{:d}", internal::escape_csv(row.problem),
                                 internal::escape_csv(row.set), internal::escape_csv(row.planner),
                                 internal::escape_csv(row.sampler), row.seed, to_string(row.status),
                                 row.is_path_valid);
  internal::visit_columns(row,
                          [&](const char*, const auto& value) { line += "," + csv_field(value); });
  return line + "\n";
}

std::string to_csv(std::span<const BenchmarkRow> rows) {
  std::string text = csv_header();
  for (const BenchmarkRow& row : rows) text += to_csv_line(row);
  return text;
}

Result<CsvRuns> parse_csv(std::string_view text, const std::string& source) {
  CsvRuns runs;
  const auto header = internal::read_csv_record(text, 0);
  if (!header) return runs;
  const std::string columns = csv_header();
  const std::string_view first_line = text.substr(0, header->end);
  const bool is_old = std::ranges::any_of(kFirstNewColumns, [&](std::string_view column) {
    return first_line == columns.substr(0, columns.find(column)) + "\n";
  });
  if (first_line != columns && !is_old) {
    return fail(ErrorCode::parse, fmt::format("{}:1: expected the columns {}", source,
                                              columns.substr(0, columns.size() - 1)));
  }
  runs.complete_bytes = header->end;
  while (const auto record = internal::read_csv_record(text, runs.complete_bytes)) {
    const std::size_t line = runs.rows.size() + 2;
    if (record->fields.size() != header->fields.size()) {
      return fail(ErrorCode::parse,
                  fmt::format("{}: line {}: expected {} fields, got {}", source, line,
                              header->fields.size(), record->fields.size()));
    }
    RowReader reader(record->fields);
    runs.rows.push_back(reader.read());
    if (!reader.fault().empty()) {
      return fail(ErrorCode::parse, fmt::format("{}: line {}: {}", source, line, reader.fault()));
    }
    runs.complete_bytes = record->end;
  }
  return runs;
}

std::string to_csv(std::span<const MemoryRow> rows) {
  std::string text(kHeader);
  for (const MemoryRow& row : rows) {
    text += fmt::format("{},{},{},{},{}\n", internal::escape_csv(row.name), row.primitives,
                        row.components, row.bytes, row.learning_time_s);
  }
  return text;
}

Result<std::vector<MemoryRow>> parse_memory_csv(std::string_view text, const std::string& source) {
  if (!text.starts_with(kHeader)) {
    return fail(ErrorCode::parse, fmt::format("{}:1: expected the columns {}", source,
                                              kHeader.substr(0, kHeader.size() - 1)));
  }
  std::vector<MemoryRow> rows;
  std::size_t at = kHeader.size();
  while (const auto record = internal::read_csv_record(text, at)) {
    const auto& fields = record->fields;
    MemoryRow row;
    const bool is_read = fields.size() == 5 &&
                         internal::read_csv_number(fields[1], row.primitives) &&
                         internal::read_csv_number(fields[2], row.components) &&
                         internal::read_csv_number(fields[3], row.bytes) &&
                         internal::read_csv_number(fields[4], row.learning_time_s);
    if (!is_read) {
      return fail(ErrorCode::parse,
                  fmt::format("{}: line {}: expected a name and four numbers of 0 or more", source,
                              rows.size() + 2));
    }
    row.name = fields[0];
    rows.push_back(std::move(row));
    at = record->end;
  }
  return rows;
}

}  // namespace mneme
