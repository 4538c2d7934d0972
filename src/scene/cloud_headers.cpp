// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/cloud_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace mneme::internal {
namespace {

using Words = std::vector<std::string_view>;

/// Fields of a record, and bytes of one.
constexpr std::size_t kMostFields = 1000;

Words expect_line(CloudText& text, std::string_view what) {
  auto words = text.next_line();
  if (!words) text.fail_file(ErrorCode::parse, fmt::format("ends before {}", what));
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

}  // namespace

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
      text.fail(ErrorCode::parse, fmt::format("expected a header of PLY, got \"{}\"", words[0]));
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

namespace {

/// Entries of a PCD header by keyword.
using PcdEntries = std::map<std::string, Words, std::less<>>;

const Words& pcd_entry(const CloudText& text, const PcdEntries& entries, std::string_view key) {
  const auto found = entries.find(key);
  if (found == entries.end() || found->second.empty()) {
    text.fail(ErrorCode::parse, fmt::format("expected {} in the header", key));
  }
  return found->second;
}

CloudHeader::Data pcd_data(const CloudText& text, const Words& words) {
  if (words[0] == "ascii") return CloudHeader::Data::text;
  if (words[0] == "binary") return CloudHeader::Data::little_endian;
  text.fail(ErrorCode::unsupported,
            fmt::format("expected the data ascii or binary, got \"{}\"; PCL's "
                        "pcl_convert_pcd_ascii_binary writes them",
                        words[0]));
}

std::vector<CloudField> pcd_fields(const CloudText& text, const PcdEntries& entries) {
  const Words& names = pcd_entry(text, entries, "FIELDS");
  const Words& sizes = pcd_entry(text, entries, "SIZE");
  const Words& kinds = pcd_entry(text, entries, "TYPE");
  const auto counts = entries.find("COUNT");
  const bool has_counts = counts != entries.end();
  if (sizes.size() != names.size() || kinds.size() != names.size() ||
      (has_counts && counts->second.size() != names.size())) {
    text.fail(ErrorCode::parse, "expected as many of SIZE, TYPE and COUNT as FIELDS");
  }
  std::vector<CloudField> fields;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t size = text.read_count(sizes[i], 8);
    const bool is_size = size == 1 || size == 2 || size == 4 || size == 8;
    const bool is_kind = kinds[i] == "F" || kinds[i] == "I" || kinds[i] == "U";
    if (!is_size || !is_kind || (kinds[i] == "F" && size < 4)) {
      text.fail(ErrorCode::parse, fmt::format("field {}: expected F of 4 or 8 bytes, I or U of 1, "
                                              "2, 4 or 8",
                                              names[i]));
    }
    const std::size_t count = has_counts ? text.read_count(counts->second[i], kMostFields) : 1;
    for (std::size_t k = 0; k < count; ++k) {
      fields.push_back({k == 0 ? std::string(names[i]) : "", kinds[i][0], size});
    }
    if (fields.size() > kMostFields) text.fail(ErrorCode::parse, "too many fields");
  }
  return fields;
}

}  // namespace

CloudHeader read_pcd_header(CloudText& text) {
  static constexpr std::array<std::string_view, 10> kKeys = {
      "VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
      "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  PcdEntries entries;
  while (!entries.contains("DATA")) {
    const Words words = expect_line(text, "the line DATA");
    if (words.empty() || words[0].front() == '#') continue;
    if (std::ranges::find(kKeys, words[0]) == kKeys.end()) {
      text.fail(ErrorCode::parse, fmt::format("expected a header of PCD, got \"{}\"", words[0]));
    }
    entries[std::string(words[0])] = Words(words.begin() + 1, words.end());
  }
  const std::string_view version = pcd_entry(text, entries, "VERSION")[0];
  if (version != ".7" && version != "0.7") {
    text.fail(ErrorCode::unsupported, fmt::format("expected PCD of version .7, got {}", version));
  }
  CloudHeader header;
  header.fields = pcd_fields(text, entries);
  header.data = pcd_data(text, pcd_entry(text, entries, "DATA"));
  const auto count_of = [&](std::string_view key) {
    return text.read_count(pcd_entry(text, entries, key)[0], kMaxCloudPoints);
  };
  header.count = count_of("WIDTH") * count_of("HEIGHT");
  if (header.count > kMaxCloudPoints) {
    text.fail(ErrorCode::unsupported,
              fmt::format("expected at most {} points, got {}", kMaxCloudPoints, header.count));
  }
  if (entries.contains("POINTS") && count_of("POINTS") != header.count) {
    text.fail(ErrorCode::parse, "expected WIDTH times HEIGHT POINTS");
  }
  return header;
}

}  // namespace mneme::internal
