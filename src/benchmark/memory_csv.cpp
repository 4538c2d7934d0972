// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "report/csv_record.h"
#include "report/markup.h"

#include <fmt/format.h>

namespace mneme {
namespace {

constexpr std::string_view kHeader = "name,primitives,components,bytes,learning_time_s\n";

}  // namespace

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
