// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Points as records of equal fields, after the header of a file.
#pragma once

#include "scene/cloud_file.h"
#include "scene/input.h"

#include <array>
#include <optional>

namespace mneme::internal {

/// A number in a record.
struct CloudField {
  std::string name;
  char kind = 'F';       ///< F: floating point, I: signed, U: unsigned
  std::size_t size = 4;  ///< bytes: 1, 2, 4 or 8
};

struct CloudHeader {
  std::vector<CloudField> fields;
  std::size_t count = 0;  ///< of records
  enum class Data { text, little_endian, big_endian };
  Data data = Data::text;
  bool may_go_on = false;  ///< more than the records may follow
};

/// Takes a file apart, and says where it is wrong.
class CloudText {
 public:
  CloudText(std::string_view bytes, const std::string& source) : rest_(bytes), source_(source) {}

  /// The words of the next line; nothing at the end.
  [[nodiscard]] std::optional<std::vector<std::string_view>> next_line();
  [[nodiscard]] std::string_view rest() const { return rest_; }
  /// Throws InputFailure, which names the line that came last.
  [[noreturn]] void fail(ErrorCode code, const std::string& what) const;
  [[noreturn]] void fail_file(ErrorCode code, const std::string& what) const;
  /// Throws InputFailure unless `word` is a whole number of at most `most`.
  [[nodiscard]] std::size_t read_count(std::string_view word, std::size_t most) const;

 private:
  std::string_view rest_;
  const std::string& source_;
  int line_ = 0;
};

/// Both read up to the first record. They throw InputFailure.
[[nodiscard]] CloudHeader read_ply_header(CloudText& text);
[[nodiscard]] CloudHeader read_pcd_header(CloudText& text);

/// Throws InputFailure.
[[nodiscard]] CloudFile read_records(const CloudHeader& header, CloudText& text);

}  // namespace mneme::internal
