// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The files that NumPy reads and writes: arrays (.npy), and archives of them (.npz).
#pragma once

#include "mneme/base.h"

#include "store/new_file.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// An array: its type in NumPy's words, such as "<f8", its shape and its numbers.
struct NpyArray {
  std::string type;
  std::vector<std::size_t> shape;
  std::string bytes;
};

/// What stands before the bytes in a file.
[[nodiscard]] std::string npy_header(const NpyArray& array);
/// Errors: parse, if `file` is no array or its size is not that of its shape; without a file name.
[[nodiscard]] Result<NpyArray> parse_npy(std::string_view file);

template <class Number>
inline constexpr const char* kNpyType = nullptr;
template <>
inline constexpr const char* kNpyType<double> = "<f8";
template <>
inline constexpr const char* kNpyType<float> = "<f4";
template <>
inline constexpr const char* kNpyType<std::int32_t> = "<i4";
template <>
inline constexpr const char* kNpyType<std::int64_t> = "<i8";
template <>
inline constexpr const char* kNpyType<std::uint64_t> = "<u8";

/// Only for the types above.
template <class Number>
[[nodiscard]] NpyArray to_npy(std::span<const Number> numbers, std::vector<std::size_t> shape);
template <class Number>
[[nodiscard]] std::vector<Number> from_npy(const NpyArray& array);

/// An array of texts ("<U7"). Each must be UTF-8 without NUL.
[[nodiscard]] NpyArray to_npy(std::span<const std::string> texts);
/// Nothing is said of an array of another type: it has no texts. Errors: parse if a text is none.
[[nodiscard]] Result<std::vector<std::string>> texts_of(const NpyArray& array);

/// The polynomial of zip and Ethernet.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

/// Writes members one after the other, in the form for large archives (zip64). The bytes depend on
/// the members alone.
class ZipWriter {
 public:
  explicit ZipWriter(NewFile& file) : file_(file) {}
  /// `head` and `body` are one member.
  [[nodiscard]] Result<void> add(const std::string& name, std::string_view head,
                                 std::string_view body);
  /// Writes the directory; nothing can be added afterwards.
  [[nodiscard]] Result<void> finish();

 private:
  NewFile& file_;
  std::string directory_;
  std::uint64_t offset_ = 0;
  std::uint64_t count_ = 0;
};

/// The members of an archive by name; views into `archive`. Errors: parse if it is no zip file or
/// damaged; unsupported if a member is compressed. Messages begin with `path`.
[[nodiscard]] Result<std::map<std::string, std::string_view>> read_zip(const std::string& path,
                                                                       std::string_view archive);

}  // namespace mneme::internal
