// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "base/files.h"
#include "base/text.h"
#include "mesh/line_reader.h"
#include "scene/compound_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

namespace mneme::internal {
namespace {

/// A number in a record.
struct CloudField {
  std::string name;
  NumberType type;
};

struct CloudHeader {
  std::vector<CloudField> fields;
  std::size_t count = 0;  ///< number of records
  PlyHeader::Data data = PlyHeader::Data::text;
  bool is_pcd = false;
  bool may_go_on = false;      ///< other data may follow the records
  bool is_compressed = false;  ///< binary data of PCD, field by field
  std::vector<std::string> notes;
};

constexpr std::size_t kMostFields = 1000;
constexpr std::size_t kMostEntries = 1000;

/// Reads up to the first record.
CloudHeader read_ply_cloud_header(LineReader& text) {
  const PlyHeader ply = read_ply_header(text);
  const PlyElement& vertices = ply.elements.front();
  if (vertices.name != "vertex") {
    text.fail_file(ErrorCode::unsupported, "expected vertices as the first element");
  }
  if (vertices.count > kMaxCloudPoints) {
    text.fail_file(ErrorCode::unsupported, "expected at most {} points, got {}", kMaxCloudPoints,
                   vertices.count);
  }
  CloudHeader header;
  header.count = vertices.count;
  header.data = ply.data;
  header.may_go_on = ply.elements.size() > 1;
  for (const PlyProperty& property : vertices.properties) {
    if (property.is_list) text.fail_file(ErrorCode::parse, "expected vertices without lists");
    header.fields.push_back({property.name, property.type});
  }
  return header;
}

/// Entries of a PCD header by keyword.
using PcdEntries = std::map<std::string, Words, std::less<>>;

const Words& pcd_entry(const LineReader& text, const PcdEntries& entries, std::string_view key) {
  const auto found = entries.find(key);
  if (found == entries.end() || found->second.empty()) {
    text.fail(ErrorCode::parse, "expected {} in the header", key);
  }
  return found->second;
}

void read_pcd_data(const LineReader& text, const Words& words, CloudHeader& header) {
  header.is_compressed = words[0] == "binary_compressed";
  header.may_go_on = true;  // PCL ignores further rows, and pads binary files to whole pages.
  if (words[0] == "ascii") return;
  if (words[0] != "binary" && !header.is_compressed) {
    text.fail(ErrorCode::unsupported,
              "expected the data ascii, binary or binary_compressed, got \"{}\"", words[0]);
  }
  header.data = PlyHeader::Data::little_endian;
}

std::vector<CloudField> pcd_fields(const LineReader& text, const PcdEntries& entries) {
  const Words& names = pcd_entry(text, entries, "FIELDS");
  const auto entry_or = [&](std::string_view key, std::string_view fallback) {
    return entries.contains(key) ? pcd_entry(text, entries, key) : Words(names.size(), fallback);
  };
  const Words sizes = entry_or("SIZE", "4"), kinds = entry_or("TYPE", "F"),
              counts = entry_or("COUNT", "1");
  for (const Words* entry : {&sizes, &kinds, &counts}) {
    if (entry->size() == names.size()) continue;
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
    const std::size_t count = text.read_count(counts[i], kMostFields);
    for (std::size_t k = 0; k < count; ++k) {
      fields.push_back({k == 0 ? std::string(names[i]) : "", {kinds[i][0], size}});
    }
    if (fields.size() > kMostFields) text.fail(ErrorCode::parse, "too many fields");
  }
  return fields;
}

constexpr std::array<std::string_view, 11> kPcdKeys = {"VERSION",   "FIELDS", "COLUMNS", "SIZE",
                                                       "TYPE",      "COUNT",  "WIDTH",   "HEIGHT",
                                                       "VIEWPOINT", "POINTS", "DATA"};

void check_pcd_version(const LineReader& text, const Words& words) {
  static constexpr std::array<std::string_view, 6> kVersions = {".5",  "0.5", ".6",
                                                                "0.6", ".7",  "0.7"};
  const std::string_view version = words.size() < 2 ? "none" : words[1];
  if (std::ranges::find(kVersions, version) == kVersions.end()) {
    text.fail(ErrorCode::unsupported, "expected PCD of version .5, .6 or .7, got {}", version);
  }
}

/// The entries up to DATA, with COLUMNS of old files as FIELDS. Foreign ones are noted.
PcdEntries read_pcd_entries(LineReader& text, std::vector<std::string>& notes) {
  PcdEntries entries;
  while (!entries.contains("DATA")) {
    const Words& words = text.expect_line("the line DATA");
    if (words.empty() || words[0].front() == '#') continue;
    if (words[0] == "VERSION") check_pcd_version(text, words);
    if (std::ranges::find(kPcdKeys, words[0]) == kPcdKeys.end()) {
      const bool is_key =
          words[0].find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_") == words[0].npos;
      if (!is_key || notes.size() == kMostEntries) {
        text.fail(ErrorCode::parse, "expected a header of PCD, got \"{}\"", words[0]);
      }
      notes.push_back(fmt::format("ignored the entry {}", excerpt(words[0])));
      continue;
    }
    const std::string_view key = words[0] == "COLUMNS" ? "FIELDS" : words[0];
    entries[std::string(key)] = Words(words.begin() + 1, words.end());
  }
  return entries;
}

/// Notes a pose of the sensor: some files give their points in its frame, others in the world's.
void note_viewpoint(const PcdEntries& entries, std::vector<std::string>& notes) {
  static constexpr std::array<double, 7> kNone = {0, 0, 0, 1, 0, 0, 0};
  const auto words = entries.find("VIEWPOINT");
  if (words == entries.end()) return;
  const bool is_none = std::ranges::equal(words->second, kNone, [](const auto& word, double none) {
    return parse_number<double>(word) == none;
  });
  if (is_none) return;
  notes.push_back(fmt::format("ignored VIEWPOINT {}: the points are taken as they are",
                              excerpt(fmt::format("{}", fmt::join(words->second, " ")))));
}

/// Reads up to the first record. Old files may lack all entries but FIELDS, POINTS and DATA.
CloudHeader read_pcd_header(LineReader& text) {
  CloudHeader header;
  header.is_pcd = true;
  const PcdEntries entries = read_pcd_entries(text, header.notes);
  note_viewpoint(entries, header.notes);
  header.fields = pcd_fields(text, entries);
  read_pcd_data(text, pcd_entry(text, entries, "DATA"), header);
  const auto count_of = [&](std::string_view key) {
    return text.read_count(pcd_entry(text, entries, key)[0], kMaxCloudPoints);
  };
  const bool has_width = entries.contains("WIDTH");
  header.count = count_of(has_width ? "WIDTH" : "POINTS");
  const std::uint64_t rows = has_width && entries.contains("HEIGHT") ? count_of("HEIGHT") : 1;
  if (header.count * rows > kMaxCloudPoints) {
    text.fail(ErrorCode::unsupported, "expected at most {} points, got {}", kMaxCloudPoints,
              header.count * rows);
  }
  header.count *= rows;
  if (entries.contains("POINTS") && count_of("POINTS") != header.count) {
    text.fail(ErrorCode::parse, "expected WIDTH times HEIGHT POINTS");
  }
  return header;
}

/// Position of x, y or z in a record.
struct Place {
  std::size_t field = 0, offset = 0;
  NumberType type;
};

std::array<Place, 3> find_places(const CloudHeader& header, const LineReader& text) {
  static constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  std::array<Place, 3> places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t offset = 0, found = 0;
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
      const CloudField& field = header.fields[i];
      if (field.name == kNames[axis]) {
        places[axis] = {i, offset, field.type};
        ++found;
      }
      offset += field.type.size;
    }
    if (found != 1) {
      text.fail_file(ErrorCode::parse, "expected one field {}", kNames[axis]);
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

/// LibLZF's longest copy, which takes three bytes.
constexpr std::size_t kMostCopied = 264, kMostGrowth = kMostCopied / 3;

/// Expands LibLZF's format to `size` bytes: runs of literals, and copies of what came before.
std::string expand_lzf(std::string_view packed, std::size_t size, const LineReader& text) {
  std::string bytes;
  bytes.reserve(size + kMostCopied);
  std::size_t at = 0;
  const auto take = [&](std::size_t count) {
    if (packed.size() - at < count) {
      text.fail_file(ErrorCode::parse, "ends within its compressed data");
    }
    at += count;
    return packed.substr(at - count, count);
  };
  const auto take_byte = [&] { return std::size_t{static_cast<unsigned char>(take(1)[0])}; };
  while (at < packed.size() && bytes.size() <= size) {
    const std::size_t control = take_byte();
    if (control < 32) {
      bytes += take(control + 1);
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) length += take_byte();
    const std::size_t distance = ((control & 31) << 8) + take_byte() + 1;
    if (distance > bytes.size()) {
      text.fail_file(ErrorCode::parse, "has compressed data that is damaged");
    }
    // The copy may overlap what it writes.
    for (length += 2; length > 0; --length) bytes += bytes[bytes.size() - distance];
  }
  if (bytes.size() != size) {
    text.fail_file(ErrorCode::parse, "has compressed data of other than {} bytes", size);
  }
  return bytes;
}

/// The records of compressed data: two sizes, then each field of all points after the other.
std::string expanded_records(std::size_t size, const LineReader& text) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 30;
  std::array<std::uint32_t, 2> sizes{};  // compressed, expanded
  if (text.rest().size() < sizeof sizes) {
    text.fail_file(ErrorCode::parse, "ends before its compressed data");
  }
  std::memcpy(sizes.data(), text.rest().data(), sizeof sizes);
  const std::string_view packed = text.rest().substr(sizeof sizes, sizes[0]);
  if (packed.size() < sizes[0] || sizes[1] != size || size > kMostBytes) {
    text.fail_file(
        ErrorCode::parse,
        "expected {} bytes of compressed data for {} bytes of points, at most {}; got {} and {}",
        sizes[0], size, kMostBytes, packed.size(), sizes[1]);
  }
  // Before memory is taken: a head may announce anything.
  if (size > kMostGrowth * packed.size()) {
    text.fail_file(ErrorCode::parse,
                   "announces {} bytes of points, but its {} bytes of compressed data expand to at "
                   "most {}",
                   size, packed.size(), kMostGrowth * packed.size());
  }
  return expand_lzf(packed, size, text);
}

CloudFile read_binary_records(const CloudHeader& header, const LineReader& text) {
  std::size_t stride = 0;
  for (const CloudField& field : header.fields) stride += field.type.size;
  const std::array<Place, 3> places = find_places(header, text);
  const std::size_t expected = stride * header.count;
  const std::string expanded = header.is_compressed ? expanded_records(expected, text) : "";
  const std::string_view bytes = header.is_compressed ? std::string_view(expanded) : text.rest();
  if (bytes.size() < expected || (bytes.size() > expected && !header.may_go_on)) {
    text.fail_file(ErrorCode::parse, "expected {} bytes of {} points after the header, got {}",
                   expected, header.count, bytes.size());
  }
  Collect points(header.count);
  for (std::size_t i = 0; i < header.count; ++i) {
    std::array<double, 3> p{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Place& place = places[axis];
      const std::size_t at = header.is_compressed
                                 ? place.offset * header.count + i * place.type.size
                                 : i * stride + place.offset;
      p[axis] =
          read_binary(bytes.data() + at, place.type, header.data == PlyHeader::Data::big_endian);
    }
    points.add(p);
  }
  return points.take();
}

CloudFile read_text_records(const CloudHeader& header, LineReader& text) {
  const std::array<Place, 3> places = find_places(header, text);
  Collect points(std::min(header.count, text.rest().size() / 6));
  for (std::size_t i = 0; i < header.count;) {
    const Words* words = text.next_line();
    if (!words) {
      text.fail_file(ErrorCode::parse, "ends after {} of {} points", i, header.count);
    }
    if (words->empty()) continue;
    if (words->size() != header.fields.size()) {
      text.fail(ErrorCode::parse, "expected {} numbers, got {}", header.fields.size(),
                words->size());
    }
    points.add({text.read_number((*words)[places[0].field]),
                text.read_number((*words)[places[1].field]),
                text.read_number((*words)[places[2].field])});
    ++i;
  }
  std::size_t surplus = 0;
  while (const Words* words = text.next_line()) {
    if (words->empty()) continue;
    if (!header.may_go_on) {
      text.fail(ErrorCode::parse, "expected nothing after {} points", header.count);
    }
    ++surplus;
  }
  CloudFile cloud = points.take();
  if (surplus > 0 && header.is_pcd) {
    cloud.notes.push_back(
        fmt::format("ignored {} rows after the {} that it announces", surplus, header.count));
  }
  return cloud;
}

CloudFile read_records(const CloudHeader& header, LineReader& text) {
  CloudFile cloud = header.data == PlyHeader::Data::text ? read_text_records(header, text)
                                                         : read_binary_records(header, text);
  cloud.notes.insert(cloud.notes.begin(), header.notes.begin(), header.notes.end());
  return cloud;
}

}  // namespace

Result<CloudFile> parse_cloud(std::string_view bytes, const std::string& source) {
  return without_throwing([&] {
    LineReader text(bytes, source);
    if (is_ply(bytes)) {
      return read_records(read_ply_cloud_header(text), text);
    }
    constexpr const char* kSpace = " \t\r\n";
    std::string_view first = without_mark(bytes);
    first.remove_prefix(std::min(first.find_first_not_of(kSpace), first.size()));
    first = first.substr(0, first.find_first_of(kSpace));
    if (first.starts_with('#') || std::ranges::find(kPcdKeys, first) != kPcdKeys.end()) {
      return read_records(read_pcd_header(text), text);
    }
    text.fail_file(ErrorCode::unsupported, "expected points in a file of PLY or PCD");
  });
}

Result<CloudFile> read_cloud(const std::string& path) {
  const std::string bytes = MNEME_TRY(read_regular_file(path));
  return parse_cloud(bytes, path);
}

}  // namespace mneme::internal
