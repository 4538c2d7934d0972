// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/csv_record.h"

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
