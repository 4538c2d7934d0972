// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Arrays of NumPy's format .npy, little-endian and in C order.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <cstdint>
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

}  // namespace mneme::internal
