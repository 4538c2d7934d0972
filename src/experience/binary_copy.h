// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The binary format of PostgreSQL's COPY.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mneme::internal {

/// Rows as a COPY in binary format wants them.
class BinaryCopy {
 public:
  BinaryCopy();
  /// Begins a row of `column_count` values, which must follow.
  BinaryCopy& row(int column_count);
  BinaryCopy& add(std::int64_t value);
  BinaryCopy& add(std::string_view text);
  BinaryCopy& add(std::span<const std::byte> bytes);
  /// All rows with the end mark; nothing can be added afterwards.
  [[nodiscard]] const std::string& finish();

 private:
  void append_big_endian(std::uint64_t value, int bytes);
  std::string data_;
};

}  // namespace mneme::internal
