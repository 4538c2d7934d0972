// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/npy_array.h"

#include "base/utf8.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

namespace mneme::internal {
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";

template <class Number>
void swap_to_little_endian([[maybe_unused]] std::string& bytes) {
  if constexpr (std::endian::native == std::endian::big) {
    for (std::size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(Number)));
    }
  }
}

template <class Number>
std::string little_endian(std::span<const Number> numbers) {
  std::string bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
  swap_to_little_endian<Number>(bytes);
  return bytes;
}

template <class Number>
std::vector<Number> numbers_of(std::string bytes) {
  swap_to_little_endian<Number>(bytes);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

/// What follows `key` in the header's dictionary.
std::string_view value_of(std::string_view dictionary, std::string_view key) {
  const std::size_t at = dictionary.find(fmt::format("'{}':", key));
  if (at == std::string_view::npos) return {};
  std::string_view value = dictionary.substr(at + key.size() + 3);
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value;
}

std::optional<std::vector<std::size_t>> parse_shape(std::string_view text) {
  if (!text.starts_with('(')) return std::nullopt;
  text = text.substr(1, text.find(')') - 1);
  std::vector<std::size_t> shape;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(", "), text.size()));
    if (text.empty()) return shape;
    std::size_t size = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    if (error != std::errc()) return std::nullopt;
    shape.push_back(size);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
}

/// Bytes of one element, or 0 of a type that is none of ours.
std::size_t element_size(std::string_view type) {
  if (type.size() < 3 || type[0] != '<') return 0;
  std::size_t size = 0;
  const auto [end, error] = std::from_chars(type.data() + 2, type.data() + type.size(), size);
  if (error != std::errc() || end != type.data() + type.size() || size > 1'000'000) return 0;
  if (type[1] == 'U') return 4 * size;
  return size <= 8 ? size : 0;
}

/// Bytes of an array of `shape`, or nothing if they are too many to count.
std::optional<std::size_t> byte_count(std::size_t element, const std::vector<std::size_t>& shape) {
  std::size_t bytes = element;
  for (const std::size_t size : shape) {
    if (__builtin_mul_overflow(bytes, size, &bytes)) return std::nullopt;
  }
  return bytes;
}

/// The dictionary of a header and what follows it.
std::optional<std::pair<std::string_view, std::string_view>> split(std::string_view file) {
  if (!file.starts_with(kNpyMagic) || file.size() < 12) return std::nullopt;
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(file[i])}; };
  const bool is_first_version = byte(6) == 1;
  const std::size_t begin = is_first_version ? 10 : 12;
  std::size_t size = byte(8) | (byte(9) << 8);
  if (!is_first_version) size |= (byte(10) << 16) | (byte(11) << 24);
  if (byte(6) > 3 || size > file.size() - begin) return std::nullopt;
  return std::pair(file.substr(begin, size), file.substr(begin + size));
}

}  // namespace

std::string npy_header(const NpyArray& array) {
  // The parentheses of a tuple with one element have a comma, those of one with none are empty.
  const std::string shape =
      fmt::format("({}{})", fmt::join(array.shape, ", "), array.shape.size() == 1 ? "," : "");
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", array.type, shape);
  constexpr std::size_t kPrefix = 10;
  constexpr std::size_t kAlignment = 64;
  const std::size_t used = (kPrefix + text.size() + 1) % kAlignment;
  text.append((kAlignment - used) % kAlignment, ' ');
  text += '\n';
  return fmt::format("{}{}{}{}{}{}", kNpyMagic, '\x01', '\0', static_cast<char>(text.size() & 0xff),
                     static_cast<char>(text.size() >> 8), text);
}

Result<NpyArray> parse_npy(std::string_view file) {
  const auto parts = split(file);
  if (!parts) return fail(ErrorCode::parse, "is no NumPy array");
  const auto& [dictionary, bytes] = *parts;
  NpyArray array;
  std::string_view type = value_of(dictionary, "descr");
  if (type.starts_with('\'')) array.type = type.substr(1, type.find('\'', 1) - 1);
  const auto shape = parse_shape(value_of(dictionary, "shape"));
  const std::size_t element = element_size(array.type);
  if (!shape || element == 0) {
    return fail(ErrorCode::parse, fmt::format("has a header that says '{}'; expected a "
                                              "little-endian array of numbers or texts",
                                              storable_text(dictionary)));
  }
  array.shape = *shape;
  if (array.shape.size() > 1 && !value_of(dictionary, "fortran_order").starts_with("False")) {
    return fail(ErrorCode::parse, "is in Fortran order; expected C order");
  }
  if (byte_count(element, array.shape) != bytes.size()) {
    return fail(ErrorCode::parse,
                fmt::format("holds {} bytes, which is not what its shape says", bytes.size()));
  }
  array.bytes = bytes;
  return array;
}

template <class Number>
NpyArray to_npy(std::span<const Number> numbers, std::vector<std::size_t> shape) {
  return {kNpyType<Number>, std::move(shape), little_endian(numbers)};
}

template <class Number>
std::vector<Number> from_npy(const NpyArray& array) {
  if (array.type != kNpyType<Number>) return {};
  return numbers_of<Number>(array.bytes);
}

template NpyArray to_npy(std::span<const double>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const float>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const std::int32_t>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const std::int64_t>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const std::uint64_t>, std::vector<std::size_t>);
template std::vector<double> from_npy(const NpyArray&);
template std::vector<float> from_npy(const NpyArray&);
template std::vector<std::int32_t> from_npy(const NpyArray&);
template std::vector<std::int64_t> from_npy(const NpyArray&);
template std::vector<std::uint64_t> from_npy(const NpyArray&);

NpyArray to_npy(std::span<const std::string> texts) {
  std::vector<std::u32string> decoded;
  std::size_t width = 1;
  for (const std::string& text : texts) {
    decoded.push_back(decode_utf8(text).value_or(U""));
    width = std::max(width, decoded.back().size());
  }
  std::vector<std::uint32_t> points;
  points.reserve(width * texts.size());
  for (const std::u32string& text : decoded) {
    points.insert(points.end(), text.begin(), text.end());
    points.resize(points.size() + width - text.size());
  }
  return {fmt::format("<U{}", width),
          {texts.size()},
          little_endian(std::span<const std::uint32_t>(points))};
}

Result<std::vector<std::string>> texts_of(const NpyArray& array) {
  std::vector<std::string> texts;
  if (!array.type.starts_with("<U")) return texts;
  const auto points = numbers_of<std::uint32_t>(array.bytes);
  const std::size_t width = element_size(array.type) / 4;
  for (std::size_t begin = 0; width > 0 && begin < points.size(); begin += width) {
    std::u32string text(points.begin() + static_cast<std::ptrdiff_t>(begin),
                        points.begin() + static_cast<std::ptrdiff_t>(begin + width));
    text.resize(text.find_last_not_of(U'\0') + 1);
    auto encoded = encode_utf8(text);
    if (!encoded) {
      return fail(ErrorCode::parse, fmt::format("has a text {} that is no Unicode", begin / width));
    }
    texts.push_back(std::move(*encoded));
  }
  return texts;
}

}  // namespace mneme::internal
