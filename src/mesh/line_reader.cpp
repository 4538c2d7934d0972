// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/line_reader.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostWords = 1 << 20;
constexpr std::size_t kMostProperties = 1000;

NumberType read_ply_type(const LineReader& lines, std::string_view word) {
  static const std::map<std::string_view, NumberType> kTypes = {
      {"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
      {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
      {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
      {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
  const auto type = kTypes.find(word);
  if (type == kTypes.end())
    lines.fail(ErrorCode::parse, "expected a type of PLY, got \"{}\"", excerpt(word));
  return type->second;
}

PlyProperty read_ply_property(const LineReader& lines, const Words& words) {
  if (words.size() == 3) return {std::string(words[2]), read_ply_type(lines, words[1])};
  if (words.size() != 5 || words[1] != "list") {
    lines.fail(ErrorCode::parse,
               "expected \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
  }
  const NumberType count = read_ply_type(lines, words[2]);
  if (count.kind == 'F')
    lines.fail(ErrorCode::parse, "expected a list with a whole number as length");
  return {std::string(words[4]), read_ply_type(lines, words[3]), true, count};
}

PlyHeader::Data read_ply_format(const LineReader& lines, const Words& words) {
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return PlyHeader::Data::text;
    if (words[1] == "binary_little_endian") return PlyHeader::Data::little_endian;
    if (words[1] == "binary_big_endian") return PlyHeader::Data::big_endian;
  }
  lines.fail(ErrorCode::unsupported,
             "expected the format ascii, binary_little_endian or binary_big_endian 1.0");
}

template <class Number>
double value_of(const std::array<char, 8>& bytes) {
  Number number;
  std::memcpy(&number, bytes.data(), sizeof number);
  return static_cast<double>(number);
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

const Words* LineReader::next_line() {
  if (rest_.empty()) return nullptr;
  ++line_;
  const std::size_t end = std::min(rest_.find(line_end_), rest_.size());
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  words_.clear();
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return &words_;
    if (words_.size() == kMostWords) {
      fail(ErrorCode::unsupported, "has too many words, expected at most {}", kMostWords);
    }
    line.remove_prefix(begin);
    const std::size_t length = std::min(line.find_first_of(" \t\r"), line.size());
    words_.push_back(line.substr(0, length));
    line.remove_prefix(length);
  }
}

const Words& LineReader::expect_line(std::string_view what) {
  const Words* words = next_line();
  if (words == nullptr) fail_file(ErrorCode::parse, "ends before {}", what);
  return *words;
}

std::size_t LineReader::read_count(std::string_view word, std::size_t most) const {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    fail(ErrorCode::parse, "expected a whole number, got \"{}\"", excerpt(word));
  }
  if (error != std::errc() || value > most) {
    fail(ErrorCode::unsupported, "expected at most {}, got {}", most, excerpt(word));
  }
  return value;
}

double LineReader::read_number(std::string_view word) const {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = number_from(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) return std::nan("");
  if (error != std::errc() || end != word.data() + word.size()) {
    fail(ErrorCode::parse, "expected a number, got \"{}\"", excerpt(word));
  }
  return value;
}

double read_binary(const char* bytes, NumberType type, bool is_big_endian) {
  std::array<char, 8> copy{};
  std::memcpy(copy.data(), bytes, type.size);
  const bool is_swapped = is_big_endian != (std::endian::native == std::endian::big);
  if (is_swapped) std::reverse(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(type.size));
  if (type.kind == 'F') return type.size == 8 ? value_of<double>(copy) : value_of<float>(copy);
  const bool is_signed = type.kind == 'I';
  switch (type.size) {
    case 1:
      return is_signed ? value_of<std::int8_t>(copy) : value_of<std::uint8_t>(copy);
    case 2:
      return is_signed ? value_of<std::int16_t>(copy) : value_of<std::uint16_t>(copy);
    case 4:
      return is_signed ? value_of<std::int32_t>(copy) : value_of<std::uint32_t>(copy);
    default:
      return is_signed ? value_of<std::int64_t>(copy) : value_of<std::uint64_t>(copy);
  }
}

bool is_ply(std::string_view bytes) {
  bytes = without_mark(bytes);
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

PlyHeader read_ply_header(LineReader& lines) {
  constexpr std::size_t kMostElements = 100;
  constexpr auto kMostCounted = static_cast<std::size_t>(
      std::min<std::uint64_t>(std::uint64_t{1} << 40, std::numeric_limits<std::size_t>::max()));
  PlyHeader header;
  bool has_format = false;
  static_cast<void>(lines.next_line());
  while (true) {
    const Words& words = lines.expect_line("end_header");
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format") {
      header.data = read_ply_format(lines, words);
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      if (header.elements.size() == kMostElements)
        lines.fail(ErrorCode::parse, "too many elements");
      header.elements.push_back(
          {std::string(words[1]), lines.read_count(words[2], kMostCounted), {}});
    } else if (words[0] == "property" && !header.elements.empty()) {
      auto& properties = header.elements.back().properties;
      if (properties.size() == kMostProperties) lines.fail(ErrorCode::parse, "too many properties");
      properties.push_back(read_ply_property(lines, words));
    } else {
      lines.fail(ErrorCode::parse, "expected a header of PLY, got \"{}\"", excerpt(words[0]));
    }
  }
  if (!has_format || header.elements.empty()) {
    lines.fail(ErrorCode::parse, "expected a format and elements in the header");
  }
  return header;
}

}  // namespace mneme::internal
