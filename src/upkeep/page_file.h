// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading the rows of an SQLite file without SQLite: what a leaf of a table holds can be read
/// whatever became of the schema and of the pages that lead to it, and no statement of a stranger's
/// is ever run. The format is that of https://www.sqlite.org/fileformat2.html.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// A value of a row; bytes are views into its record.
struct Field {
  enum class Kind { null, integer, real, text, blob };
  Kind kind = Kind::null;
  std::int64_t integer = 0;
  std::span<const std::byte> bytes;

  [[nodiscard]] std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
};

/// A row of whichever table.
struct LeafRecord {
  std::int64_t id = 0;
  std::vector<Field> fields;
  std::vector<std::byte> payload;
};

/// Where a record stands.
struct RecordPlace {
  std::int64_t page = 0;  ///< from 1
  int cell = 0;
};

/// A file that nobody writes. Not thread-safe.
class PageFile {
 public:
  static constexpr std::size_t kPageSize = 8192;  ///< unless the header names another one

  /// Errors: io.
  [[nodiscard]] static Result<PageFile> open(const std::string& path);

  using Visitor = std::function<void(const LeafRecord&, RecordPlace)>;
  /// Visits every record of every leaf that can be read, in order of pages. Errors: io.
  [[nodiscard]] Result<void> visit_records(const Visitor& visit);
  /// Reads the record again that was visited at `place`. Errors: io; corrupt if there is none.
  [[nodiscard]] Result<void> read_record(RecordPlace place, LeafRecord& record);

 private:
  struct Close {
    void operator()(const int* file) const;
  };
  /// Reads a page, the last one filled up with zeros. False if the file has no such page.
  Result<bool> read_page(std::int64_t page, std::vector<std::byte>& bytes);
  /// The record of a cell of `leaf_`. False if it cannot be one.
  Result<bool> read_cell(int cell, LeafRecord& record);
  /// Adds what a record has on pages of its own, until it has `size` bytes.
  Result<bool> read_overflow(std::int64_t page, std::size_t size, LeafRecord& record);
  [[nodiscard]] std::size_t header_at() const { return leaf_page_ == 1 ? 100 : 0; }
  /// -1 if the page is no leaf of a table.
  [[nodiscard]] int cell_count() const;

  std::string path_;
  std::unique_ptr<const int, Close> file_;
  std::int64_t bytes_ = 0;
  std::int64_t overflow_budget_ = 0;  ///< bytes of further pages that may still be read
  std::size_t page_size_ = kPageSize;
  std::int64_t leaf_page_ = 0;
  std::vector<std::byte> leaf_;
  std::vector<std::byte> overflow_;
};

}  // namespace mneme::internal
