// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/line_reader.h"
#include "mesh/surface_builder.h"

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr std::size_t kTitleBytes = 80, kHeaderBytes = 84, kFacetBytes = 50;

void read_text(std::string_view bytes, SurfaceBuilder& surface) {
  LineReader lines(bytes, surface.source());
  std::vector<Vec3> corners;
  bool is_open = false;
  while (const Words* words = lines.next_line()) {
    if (words->empty()) continue;
    const std::string keyword = lower_case(words->front());
    if (keyword == "vertex") {
      if (words->size() != 4 || !is_open) {
        lines.fail(ErrorCode::parse, "expected \"vertex X Y Z\" in a facet");
      }
      corners.emplace_back(lines.read_number((*words)[1]), lines.read_number((*words)[2]),
                           lines.read_number((*words)[3]));
    } else if (keyword == "facet") {
      if (is_open) lines.fail(ErrorCode::parse, "expected endfacet before the next facet");
      is_open = true;
      corners.clear();
    } else if (keyword == "endfacet") {
      if (!is_open || corners.size() != 3) {
        lines.fail(ErrorCode::parse, "expected a facet with 3 vertices, got {}", corners.size());
      }
      surface.add(corners[0], corners[1], corners[2]);
      is_open = false;
    } else if (keyword != "solid" && keyword != "endsolid" && keyword != "outer" &&
               keyword != "endloop" && keyword != "color" && keyword != "end") {
      lines.fail(ErrorCode::parse, "expected a keyword of STL, got \"{}\"",
                 excerpt(words->front()));
    }
  }
  if (is_open) lines.fail_file(ErrorCode::parse, "ends within a facet");
}

/// True for text of STL, which has no NUL.
bool is_text(std::string_view bytes) {
  bytes = without_mark(bytes);
  bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  return lower_case(bytes.substr(0, 5)) == "solid" && bytes.find('\0') == bytes.npos;
}

/// Fails if so much follows the triangles that it may be others, as where a program did not count
/// what it wrote. Less, or zeros, is padding.
void check_rest(std::string_view rest, std::size_t stated, const SurfaceBuilder& surface) {
  if (rest.size() < kFacetBytes || rest.find_first_not_of('\0') == rest.npos) return;
  throw_failure(
      ErrorCode::parse,
      "{}: announces {} triangles, and {} bytes follow them, enough for {} more: write the "
      "file anew with the right count, or without these bytes",
      surface.source(), stated, rest.size(), rest.size() / kFacetBytes);
}

/// A binary file states its number of triangles after its title.
void read_binary_facets(std::string_view bytes, SurfaceBuilder& surface) {
  const auto stated =
      static_cast<std::size_t>(read_binary(bytes.data() + kTitleBytes, {'U', 4}, false));
  if ((bytes.size() - kHeaderBytes) / kFacetBytes < stated) {
    throw_failure(ErrorCode::parse, "{}: ends before the {} triangles that it announces",
                  surface.source(), stated);
  }
  check_rest(bytes.substr(kHeaderBytes + kFacetBytes * stated), stated, surface);
  for (std::size_t i = 0; i < stated; ++i) {
    const auto corner = [&, at = bytes.data() + kHeaderBytes + kFacetBytes * i](int k) -> Vec3 {
      const auto number = [&](int axis) {
        return read_binary(at + 12 * (k + 1) + 4 * axis, {'F', 4}, false);
      };
      return {number(0), number(1), number(2)};
    };
    surface.add(corner(0), corner(1), corner(2));
  }
}

}  // namespace

void read_stl(std::string_view bytes, SurfaceBuilder& surface) {
  const std::string_view text = bytes.substr(0, bytes.find_last_not_of('\0') + 1);
  if (is_text(text)) return read_text(text, surface);
  const bool is_other_text = bytes.find('\0') == bytes.npos && bytes.find("facet") != bytes.npos;
  if (bytes == std::string(kTitleBytes, '\0')) return;  // some robots are published with it
  if (bytes.size() < kHeaderBytes || is_other_text) {
    throw_failure(ErrorCode::parse,
                  "{}: ends before the triangles of binary STL, and does not begin "
                  "with \"solid\" like text",
                  surface.source());
  }
  read_binary_facets(bytes, surface);
}

}  // namespace mneme::internal
