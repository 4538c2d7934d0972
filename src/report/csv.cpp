// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/markup.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>

namespace mneme {
namespace {

constexpr std::array kStatuses = {PlanStatus::solved,          PlanStatus::timeout,
                                  PlanStatus::iteration_limit, PlanStatus::cancelled,
                                  PlanStatus::invalid_start,   PlanStatus::invalid_goal};

/// Calls `visit(name, value)` for every column but the texts, in order; they follow the texts.
template <class Row, class Visitor>
void visit_numbers(Row& row, Visitor&& visit) {
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
}

/// One line of fields, and where the next one begins; nothing if the line does not end.
struct Record {
  std::vector<std::string> fields;
  std::size_t end = 0;
};

std::optional<Record> read_record(std::string_view text, std::size_t begin) {
  Record record;
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
    read_number("seed", row.seed);
    read_status(row);
    int is_valid = 0;
    read_number("is_valid", is_valid);
    row.is_path_valid = is_valid == 1;
    visit_numbers(row, [&](const char* name, auto& value) { read_number(name, value); });
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

  template <class T>
  void read_number(const char* name, T& value) {
    const std::string& text = next();
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) note(name, "a number", text);
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

}  // namespace

std::string csv_header() {
  std::string header = "problem,set,planner,sampler,seed,status,is_valid";
  const BenchmarkRow row;
  visit_numbers(row, [&](const char* name, const auto&) { header += fmt::format(",{}", name); });
  return header + "\n";
}

std::string to_csv_line(const BenchmarkRow& row) {
  std::string line = fmt::format("{},{},{},{},{},{},{:d}", internal::escape_csv(row.problem),
                                 internal::escape_csv(row.set), internal::escape_csv(row.planner),
                                 internal::escape_csv(row.sampler), row.seed, to_string(row.status),
                                 row.is_path_valid);
  visit_numbers(row, [&](const char*, const auto& value) { line += fmt::format(",{}", value); });
  return line + "\n";
}

std::string to_csv(std::span<const BenchmarkRow> rows) {
  std::string text = csv_header();
  for (const BenchmarkRow& row : rows) text += to_csv_line(row);
  return text;
}

Result<CsvRuns> parse_csv(std::string_view text, const std::string& source) {
  CsvRuns runs;
  const auto header = read_record(text, 0);
  if (!header) return runs;
  if (text.substr(0, header->end) != csv_header()) {
    return fail(ErrorCode::parse, fmt::format("{}:1: expected the columns {}", source,
                                              csv_header().substr(0, csv_header().size() - 1)));
  }
  runs.complete_bytes = header->end;
  while (const auto record = read_record(text, runs.complete_bytes)) {
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

}  // namespace mneme
