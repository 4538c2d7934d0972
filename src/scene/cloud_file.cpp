// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/cloud_file.h"

#include "base/files.h"
#include "scene/cloud_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace mneme::internal {

std::optional<std::vector<std::string_view>> CloudText::next_line() {
  if (rest_.empty()) return std::nullopt;
  ++line_;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t length = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, length));
    line.remove_prefix(length);
  }
}

void CloudText::fail(ErrorCode code, const std::string& what) const {
  throw InputFailure{{code, fmt::format("{}:{}: {}", source_, line_, what)}};
}

void CloudText::fail_file(ErrorCode code, const std::string& what) const {
  throw InputFailure{{code, fmt::format("{}: {}", source_, what)}};
}

std::size_t CloudText::read_count(std::string_view word, std::size_t most) const {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    fail(ErrorCode::parse, fmt::format("expected a whole number, got \"{}\"", word));
  }
  if (error != std::errc() || value > most) {
    fail(ErrorCode::unsupported, fmt::format("expected at most {}, got {}", most, word));
  }
  return value;
}

namespace {

/// Where x, y and z are among the fields, and in bytes.
struct Place {
  std::size_t field = 0, offset = 0, size = 0;
};

std::array<Place, 3> find_places(const CloudHeader& header, const CloudText& text) {
  static constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  std::array<Place, 3> places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t offset = 0, found = 0;
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
      const CloudField& field = header.fields[i];
      if (field.name == kNames[axis]) {
        places[axis] = {i, offset, field.size};
        found += field.kind == 'F' ? 1 : 2;
      }
      offset += field.size;
    }
    if (found != 1) {
      text.fail_file(ErrorCode::parse,
                     fmt::format("expected one field {} of floating point", kNames[axis]));
    }
  }
  return places;
}

class Collect {
 public:
  explicit Collect(std::size_t count) { result_.points.reserve(count); }
  void add(const std::array<double, 3>& p) {
    if (std::ranges::all_of(p, [](double x) { return std::isfinite(static_cast<float>(x)); })) {
      result_.points.push_back(
          {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
    } else {
      ++result_.skipped;
    }
  }
  CloudFile take() { return std::move(result_); }

 private:
  CloudFile result_;
};

double read_binary(const char* bytes, std::size_t size, bool is_big_endian) {
  std::array<char, 8> copy{};
  std::memcpy(copy.data(), bytes, size);
  const bool must_turn = is_big_endian != (std::endian::native == std::endian::big);
  if (must_turn) std::reverse(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(size));
  if (size == 8) return std::bit_cast<double>(copy);
  float value = 0;
  std::memcpy(&value, copy.data(), sizeof value);
  return value;
}

CloudFile read_binary_records(const CloudHeader& header, const CloudText& text) {
  std::size_t stride = 0;
  for (const CloudField& field : header.fields) stride += field.size;
  const std::array<Place, 3> places = find_places(header, text);
  const std::size_t expected = stride * header.count, got = text.rest().size();
  if (got < expected || (got > expected && !header.may_go_on)) {
    text.fail_file(ErrorCode::parse,
                   fmt::format("expected {} bytes of {} points after the header, got {}", expected,
                               header.count, got));
  }
  Collect points(header.count);
  for (std::size_t i = 0; i < header.count; ++i) {
    const char* const record = text.rest().data() + i * stride;
    std::array<double, 3> p{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[axis] = read_binary(record + places[axis].offset, places[axis].size,
                            header.data == CloudHeader::Data::big_endian);
    }
    points.add(p);
  }
  return points.take();
}

double read_number(std::string_view word, const CloudText& text) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) return std::nan("");
  if (error != std::errc() || end != word.data() + word.size()) {
    text.fail(ErrorCode::parse, fmt::format("expected a number, got \"{}\"", word));
  }
  return value;
}

CloudFile read_text_records(const CloudHeader& header, CloudText& text) {
  const std::array<Place, 3> places = find_places(header, text);
  Collect points(std::min(header.count, text.rest().size() / 6));
  for (std::size_t i = 0; i < header.count;) {
    const auto words = text.next_line();
    if (!words) {
      text.fail_file(ErrorCode::parse, fmt::format("ends after {} of {} points", i, header.count));
    }
    if (words->empty()) continue;
    if (words->size() != header.fields.size()) {
      text.fail(ErrorCode::parse,
                fmt::format("expected {} numbers, got {}", header.fields.size(), words->size()));
    }
    points.add({read_number((*words)[places[0].field], text),
                read_number((*words)[places[1].field], text),
                read_number((*words)[places[2].field], text)});
    ++i;
  }
  while (const auto words = text.next_line()) {
    if (!words->empty() && !header.may_go_on) {
      text.fail(ErrorCode::parse, fmt::format("expected nothing after {} points", header.count));
    }
  }
  return points.take();
}

}  // namespace

CloudFile read_records(const CloudHeader& header, CloudText& text) {
  CloudFile cloud = header.data == CloudHeader::Data::text ? read_text_records(header, text)
                                                           : read_binary_records(header, text);
  if (cloud.points.empty()) {
    text.fail_file(ErrorCode::parse,
                   fmt::format("has no point with finite coordinates among {}", cloud.size()));
  }
  return cloud;
}

Result<CloudFile> parse_cloud(std::string_view bytes, const std::string& source) {
  return without_throwing([&] {
    CloudText text(bytes, source);
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n")) {
      return read_records(read_ply_header(text), text);
    }
    if (bytes.starts_with('#') || bytes.starts_with("VERSION")) {
      return read_records(read_pcd_header(text), text);
    }
    text.fail_file(ErrorCode::unsupported, "expected points in a file of PLY or PCD");
  });
}

Result<CloudFile> read_cloud(const std::string& path) {
  const auto bytes = read_text_file(path);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  return parse_cloud(*bytes, path);
}

}  // namespace mneme::internal
