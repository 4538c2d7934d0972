// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "row_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "input_file.h"
#include "output_file.h"

namespace mneme::app {

Result<std::vector<BenchmarkRow>> read_rows(const std::string& path) {
  return read_file(path, kMaxCsvBytes)
      .and_then([&](const std::string& text) { return parse_csv(text, path); })
      .map([](CsvRuns runs) { return std::move(runs.rows); });
}

Result<void> RowFile::open(const std::string& csv, const std::string& sqlite, bool is_resumed) {
  std::error_code missing;
  if (is_resumed && std::filesystem::exists(csv, missing)) {
    Result<std::vector<BenchmarkRow>> rows = read_rows(csv);
    if (!rows) return tl::unexpected(rows.error());
    rows_ = std::move(*rows);
  }
  if (!sqlite.empty()) {
    Result<RunDatabase> database = RunDatabase::open(sqlite, rows_);
    if (!database) return tl::unexpected(database.error());
    database_ = std::move(*database);
  }
  path_ = csv;
  return write_all();
}

Result<void> RowFile::add(const BenchmarkRow& row) {
  rows_.push_back(row);
  if (database_) {
    const Result<void> added = database_->add(row);
    if (!added) return added;
  }
  if (path_.empty()) return {};
  file_ << to_csv_line(row);
  return flush();
}

Result<void> RowFile::replace(std::vector<BenchmarkRow> rows) {
  rows_ = std::move(rows);
  return write_all();
}

Result<void> RowFile::write_all() {
  if (path_.empty()) return {};
  const Result<void> written = write_file(path_, to_csv(rows_));
  if (!written) return written;
  file_ = std::ofstream(path_, std::ios::app);
  return flush();
}

Result<void> RowFile::flush() {
  if (file_.flush()) return {};
  return fail(ErrorCode::io, fmt::format("cannot write '{}': {}", path_, std::strerror(errno)));
}

}  // namespace mneme::app
