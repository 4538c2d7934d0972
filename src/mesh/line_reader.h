// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading of files of lines of words: STL, OBJ, PCD, and PLY with its header.
#pragma once

#include "base/fail.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

using Words = std::vector<std::string_view>;

/// `text` with small letters for A to Z.
[[nodiscard]] std::string lower_case(std::string_view text);

/// The first characters of a word, for messages.
[[nodiscard]] inline std::string_view excerpt(std::string_view word) { return word.substr(0, 60); }

/// `bytes` without the byte order mark of UTF-8.
[[nodiscard]] inline std::string_view without_mark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return bytes.substr(bytes.starts_with(kMark) ? kMark.size() : 0);
}

/// Splits text into lines of words: after LF, or after CR where there is no LF. Skips a byte order
/// mark. Keeps references to its arguments. Its functions throw
/// InputFailure, which names the source and mostly the line.
class LineReader {
 public:
  LineReader(std::string_view bytes, const std::string& source)
      : rest_(without_mark(bytes)),
        source_(source),
        line_end_(bytes.find('\n') == bytes.npos ? '\r' : '\n') {}

  /// The words of the next line, valid until the next call; null at the end.
  [[nodiscard]] const Words* next_line();
  /// As next_line(), where a file must not end. `what` names what is missing in the message.
  [[nodiscard]] const Words& expect_line(std::string_view what);

  /// The bytes after the lines read so far.
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] const std::string& source() const { return source_; }
  /// The number of the line read last, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

  /// `word` as a whole number of at most `most`.
  [[nodiscard]] std::size_t read_count(std::string_view word, std::size_t most) const;
  /// `word` as a number, which may be nan or infinite; nan if it is out of range.
  [[nodiscard]] double read_number(std::string_view word) const;

  template <class... Args>
  [[noreturn]] void fail(ErrorCode code, fmt::format_string<Args...> what, Args&&... args) const {
    throw_failure(code, "{}:{}: {}", source_, line_,
                  fmt::format(what, std::forward<Args>(args)...));
  }
  template <class... Args>
  [[noreturn]] void fail_file(ErrorCode code, fmt::format_string<Args...> what,
                              Args&&... args) const {
    throw_failure(code, "{}: {}", source_, fmt::format(what, std::forward<Args>(args)...));
  }

 private:
  std::string_view rest_;
  const std::string& source_;
  char line_end_;
  Words words_;
  std::size_t line_ = 0;
};

/// A number type of a file: floating point (F), signed (I) or unsigned (U).
struct NumberType {
  char kind = 'F';
  std::size_t size = 4;  ///< bytes: 1, 2, 4 or 8
};
/// The number of that type at `bytes`.
[[nodiscard]] double read_binary(const char* bytes, NumberType type, bool is_big_endian);

struct PlyProperty {
  std::string name;
  NumberType type;
  bool is_list = false;
  NumberType count_type = {};  ///< of the length of a list
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};
struct PlyHeader {
  enum class Data { text, little_endian, big_endian };
  Data data = Data::text;
  std::vector<PlyElement> elements;  ///< at least one
};

/// True if a file with these bytes is PLY.
[[nodiscard]] bool is_ply(std::string_view bytes);
/// Reads the header, up to the first element.
[[nodiscard]] PlyHeader read_ply_header(LineReader& lines);

}  // namespace mneme::internal
