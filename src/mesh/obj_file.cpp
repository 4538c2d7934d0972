// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"
#include "mesh/line_reader.h"
#include "mesh/mesh_file.h"
#include "mesh/surface_builder.h"

#include <algorithm>
#include <cstdint>
#include <span>

namespace mneme::internal {
namespace {

/// Reads vertices and faces. Everything else, such as normals and materials, has no surface.
class ObjReader {
 public:
  ObjReader(std::string_view bytes, SurfaceBuilder& surface)
      : lines_(bytes, surface.source()), surface_(surface) {}

  void read() {
    Words joined;
    while (const Words* words = lines_.next_line()) {
      // A backslash at the end of a line continues it.
      const bool goes_on = !words->empty() && words->back() == "\\";
      if (!goes_on && joined.empty()) {
        read_line(*words);
        continue;
      }
      joined.insert(joined.end(), words->begin(), words->end() - (goes_on ? 1 : 0));
      if (joined.size() > kMostJoinedWords) {
        lines_.fail(ErrorCode::unsupported, "continues too many lines");
      }
      if (goes_on) continue;
      read_line(joined);
      joined.clear();
    }
    read_line(joined);
    for (const EarlyPolygon& polygon : early_) {
      add_polygon(std::span(early_corners_).subspan(polygon.begin, polygon.count), polygon.line);
    }
  }

 private:
  static constexpr std::size_t kMostJoinedWords = 1 << 20;
  /// Polygons that come before their vertices have fewer corners together.
  static constexpr std::size_t kMostEarlyCorners = 6 * kMaxTriangles;
  struct EarlyPolygon {
    std::size_t begin, count;  ///< in early_corners_
    std::size_t line;
  };

  void read_line(const Words& words) {
    if (words.empty()) return;
    if (words[0] == "v") {
      if (words.size() < 4) lines_.fail(ErrorCode::parse, "expected \"v X Y Z\"");
      if (vertices_.size() == kMaxVertices) {
        lines_.fail_file(ErrorCode::unsupported, "has more than {} vertices", kMaxVertices);
      }
      vertices_.emplace_back(lines_.read_number(words[1]), lines_.read_number(words[2]),
                             lines_.read_number(words[3]));
    } else if (words[0] == "f") {
      polygon_.clear();
      for (std::size_t i = 1; i < words.size() && words[i][0] != '#'; ++i) {
        polygon_.push_back(read_corner(words[i]));
      }
      const auto is_early = [&](std::uint32_t vertex) { return vertex >= vertices_.size(); };
      if (std::ranges::any_of(polygon_, is_early)) return put_off();
      add_polygon(polygon_, lines_.line());
    }
  }

  /// The place of the vertex of "V", "V/T", "V/T/N" or "V//N": counted from 1, or back from the
  /// last one if V < 0. It may come later in the file.
  [[nodiscard]] std::uint32_t read_corner(std::string_view word) const {
    const auto count = static_cast<std::ptrdiff_t>(vertices_.size());
    const auto index = parse_number<std::ptrdiff_t>(word.substr(0, word.find('/'))).value_or(0);
    if (index == 0 || index > static_cast<std::ptrdiff_t>(kMaxVertices) || index < -count) {
      lines_.fail(ErrorCode::parse, "a face has the vertex \"{}\", but there are {} before it",
                  excerpt(word), count);
    }
    return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
  }

  /// Keeps the polygon for when all vertices are read.
  void put_off() {
    if (polygon_.size() < 3) return;  // no surface
    if (early_corners_.size() + polygon_.size() > kMostEarlyCorners) surface_.fail_too_many();
    early_.push_back({early_corners_.size(), polygon_.size(), lines_.line()});
    early_corners_.insert(early_corners_.end(), polygon_.begin(), polygon_.end());
  }

  void add_polygon(std::span<const std::uint32_t> polygon, std::size_t line) {
    corners_.clear();
    for (const std::uint32_t vertex : polygon) {
      if (vertex >= vertices_.size()) {
        throw_failure(ErrorCode::parse, "{}:{}: a face has the vertex {}, but there are {}",
                      surface_.source(), line, vertex + 1, vertices_.size());
      }
      corners_.push_back(vertices_[vertex]);
    }
    surface_.add_polygon(corners_);
  }

  LineReader lines_;
  SurfaceBuilder& surface_;
  std::vector<Vec3> vertices_, corners_;
  std::vector<std::uint32_t> polygon_, early_corners_;
  std::vector<EarlyPolygon> early_;
};

}  // namespace

void read_obj(std::string_view bytes, SurfaceBuilder& surface) { ObjReader(bytes, surface).read(); }

}  // namespace mneme::internal
