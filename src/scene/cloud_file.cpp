// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "base/files.h"
#include "scene/compound_files.h"
#include "scene/input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

namespace mneme::internal {
namespace {

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
  bool may_go_on = false;  ///< other data may follow the records
};

/// Splits a file into lines and words; errors name the line.
class CloudText {
 public:
  CloudText(std::string_view bytes, const std::string& source) : rest_(bytes), source_(source) {}

  /// The words of the next line; nothing at the end.
  [[nodiscard]] std::optional<std::vector<std::string_view>> next_line();
  [[nodiscard]] std::string_view rest() const { return rest_; }
  /// Throws InputFailure with the current line.
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
  /// Throws InputFailure unless `word` is a whole number of at most `most`.
  [[nodiscard]] std::size_t read_count(std::string_view word, std::size_t most) const;

 private:
  std::string_view rest_;
  const std::string& source_;
  int line_ = 0;
};

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

std::size_t CloudText::read_count(std::string_view word, std::size_t most) const {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    fail(ErrorCode::parse, "expected a whole number, got \"{}\"", word);
  }
  if (error != std::errc() || value > most) {
    fail(ErrorCode::unsupported, "expected at most {}, got {}", most, word);
  }
  return value;
}

using Words = std::vector<std::string_view>;

/// Limit on the fields of a record.
constexpr std::size_t kMostFields = 1000;

Words expect_line(CloudText& text, std::string_view what) {
  auto words = text.next_line();
  if (!words) text.fail_file(ErrorCode::parse, "ends before {}", what);
  return *std::move(words);
}

CloudField ply_field(const CloudText& text, const Words& words) {
  static const std::map<std::string_view, CloudField> kTypes = {
      {"char", {"", 'I', 1}},   {"int8", {"", 'I', 1}},    {"uchar", {"", 'U', 1}},
      {"uint8", {"", 'U', 1}},  {"short", {"", 'I', 2}},   {"int16", {"", 'I', 2}},
      {"ushort", {"", 'U', 2}}, {"uint16", {"", 'U', 2}},  {"int", {"", 'I', 4}},
      {"int32", {"", 'I', 4}},  {"uint", {"", 'U', 4}},    {"uint32", {"", 'U', 4}},
      {"float", {"", 'F', 4}},  {"float32", {"", 'F', 4}}, {"double", {"", 'F', 8}},
      {"float64", {"", 'F', 8}}};
  const auto type = words.size() == 3 ? kTypes.find(words[1]) : kTypes.end();
  if (type == kTypes.end()) {
    text.fail(ErrorCode::parse, "expected a property of vertices: a type of PLY and a name");
  }
  CloudField field = type->second;
  field.name = words[2];
  return field;
}

CloudHeader::Data ply_data(const CloudText& text, const Words& words) {
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return CloudHeader::Data::text;
    if (words[1] == "binary_little_endian") return CloudHeader::Data::little_endian;
    if (words[1] == "binary_big_endian") return CloudHeader::Data::big_endian;
  }
  text.fail(ErrorCode::unsupported,
            "expected the format ascii, binary_little_endian or binary_big_endian 1.0");
}

/// Reads up to the first record.
CloudHeader read_ply_header(CloudText& text) {
  CloudHeader header;
  int elements = 0;
  bool has_format = false;
  static_cast<void>(text.next_line());
  while (true) {
    const Words words = expect_line(text, "end_header");
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format") {
      header.data = ply_data(text, words);
      has_format = true;
    } else if (words[0] == "element") {
      if (++elements > 1) {
        header.may_go_on = true;
      } else if (words.size() != 3 || words[1] != "vertex") {
        text.fail(ErrorCode::unsupported, "expected vertices as the first element");
      } else {
        header.count = text.read_count(words[2], kMaxCloudPoints);
      }
    } else if (words[0] != "property") {
      text.fail(ErrorCode::parse, "expected a header of PLY, got \"{}\"", words[0]);
    } else if (elements == 1) {
      if (header.fields.size() >= kMostFields) text.fail(ErrorCode::parse, "too many properties");
      header.fields.push_back(ply_field(text, words));
    }
  }
  if (!has_format || elements == 0) {
    text.fail(ErrorCode::parse, "expected a format and the element vertex in the header");
  }
  return header;
}

/// Entries of a PCD header by keyword.
using PcdEntries = std::map<std::string, Words, std::less<>>;

const Words& pcd_entry(const CloudText& text, const PcdEntries& entries, std::string_view key) {
  const auto found = entries.find(key);
  if (found == entries.end() || found->second.empty()) {
    text.fail(ErrorCode::parse, "expected {} in the header", key);
  }
  return found->second;
}

CloudHeader::Data pcd_data(const CloudText& text, const Words& words) {
  if (words[0] == "ascii") return CloudHeader::Data::text;
  if (words[0] == "binary") return CloudHeader::Data::little_endian;
  text.fail(ErrorCode::unsupported,
            "expected the data ascii or binary, got \"{}\"; PCL's "
            "pcl_convert_pcd_ascii_binary writes them",
            words[0]);
}

std::vector<CloudField> pcd_fields(const CloudText& text, const PcdEntries& entries) {
  const Words& names = pcd_entry(text, entries, "FIELDS");
  const Words& sizes = pcd_entry(text, entries, "SIZE");
  const Words& kinds = pcd_entry(text, entries, "TYPE");
  const auto counts = entries.find("COUNT");
  const bool has_counts = counts != entries.end();
  if (sizes.size() != names.size() || kinds.size() != names.size() ||
      (has_counts && counts->second.size() != names.size())) {
    text.fail(ErrorCode::parse, "expected one entry in SIZE, TYPE and COUNT per entry in FIELDS");
  }
  std::vector<CloudField> fields;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t size = text.read_count(sizes[i], 8);
    const bool is_size = size == 1 || size == 2 || size == 4 || size == 8;
    const bool is_kind = kinds[i] == "F" || kinds[i] == "I" || kinds[i] == "U";
    if (!is_size || !is_kind || (kinds[i] == "F" && size < 4)) {
      text.fail(ErrorCode::parse,
                "field {}: expected F of 4 or 8 bytes, I or U of 1, "
                "2, 4 or 8",
                names[i]);
    }
    const std::size_t count = has_counts ? text.read_count(counts->second[i], kMostFields) : 1;
    for (std::size_t k = 0; k < count; ++k) {
      fields.push_back({k == 0 ? std::string(names[i]) : "", kinds[i][0], size});
    }
    if (fields.size() > kMostFields) text.fail(ErrorCode::parse, "too many fields");
  }
  return fields;
}

/// Reads up to the first record.
CloudHeader read_pcd_header(CloudText& text) {
  static constexpr std::array<std::string_view, 10> kKeys = {
      "VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
      "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  PcdEntries entries;
  while (!entries.contains("DATA")) {
    const Words words = expect_line(text, "the line DATA");
    if (words.empty() || words[0].front() == '#') continue;
    if (std::ranges::find(kKeys, words[0]) == kKeys.end()) {
      text.fail(ErrorCode::parse, "expected a header of PCD, got \"{}\"", words[0]);
    }
    entries[std::string(words[0])] = Words(words.begin() + 1, words.end());
  }
  const std::string_view version = pcd_entry(text, entries, "VERSION")[0];
  if (version != ".7" && version != "0.7") {
    text.fail(ErrorCode::unsupported, "expected PCD of version .7, got {}", version);
  }
  CloudHeader header;
  header.fields = pcd_fields(text, entries);
  header.data = pcd_data(text, pcd_entry(text, entries, "DATA"));
  const auto count_of = [&](std::string_view key) {
    return text.read_count(pcd_entry(text, entries, key)[0], kMaxCloudPoints);
  };
  header.count = count_of("WIDTH") * count_of("HEIGHT");
  if (header.count > kMaxCloudPoints) {
    text.fail(ErrorCode::unsupported, "expected at most {} points, got {}", kMaxCloudPoints,
              header.count);
  }
  if (entries.contains("POINTS") && count_of("POINTS") != header.count) {
    text.fail(ErrorCode::parse, "expected WIDTH times HEIGHT POINTS");
  }
  return header;
}

/// Position of x, y or z in a record.
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
      text.fail_file(ErrorCode::parse, "expected one field {} of floating point", kNames[axis]);
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
    text.fail_file(ErrorCode::parse, "expected {} bytes of {} points after the header, got {}",
                   expected, header.count, got);
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
    text.fail(ErrorCode::parse, "expected a number, got \"{}\"", word);
  }
  return value;
}

CloudFile read_text_records(const CloudHeader& header, CloudText& text) {
  const std::array<Place, 3> places = find_places(header, text);
  Collect points(std::min(header.count, text.rest().size() / 6));
  for (std::size_t i = 0; i < header.count;) {
    const auto words = text.next_line();
    if (!words) {
      text.fail_file(ErrorCode::parse, "ends after {} of {} points", i, header.count);
    }
    if (words->empty()) continue;
    if (words->size() != header.fields.size()) {
      text.fail(ErrorCode::parse, "expected {} numbers, got {}", header.fields.size(),
                words->size());
    }
    points.add({read_number((*words)[places[0].field], text),
                read_number((*words)[places[1].field], text),
                read_number((*words)[places[2].field], text)});
    ++i;
  }
  while (const auto words = text.next_line()) {
    if (!words->empty() && !header.may_go_on) {
      text.fail(ErrorCode::parse, "expected nothing after {} points", header.count);
    }
  }
  return points.take();
}

CloudFile read_records(const CloudHeader& header, CloudText& text) {
  CloudFile cloud = header.data == CloudHeader::Data::text ? read_text_records(header, text)
                                                           : read_binary_records(header, text);
  if (cloud.points.empty()) {
    text.fail_file(ErrorCode::parse, "has no point with finite coordinates among {}", cloud.size());
  }
  return cloud;
}

}  // namespace

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
  const std::string bytes = MNEME_TRY(read_text_file(path));
  return parse_cloud(bytes, path);
}

}  // namespace mneme::internal
