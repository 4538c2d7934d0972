// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"
#include "mesh/line_reader.h"
#include "mesh/mesh_file.h"
#include "mesh/surface_builder.h"

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
  }

 private:
  static constexpr std::size_t kMostJoinedWords = 1 << 20;

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
      corners_.clear();
      for (std::size_t i = 1; i < words.size() && words[i][0] != '#'; ++i) {
        corners_.push_back(corner(words[i]));
      }
      surface_.add_polygon(corners_);
    }
  }

  /// The vertex of "V", "V/T", "V/T/N" or "V//N": counted from 1, or back from the last one if V <
  /// 0.
  [[nodiscard]] const Vec3& corner(std::string_view word) const {
    const auto count = static_cast<std::ptrdiff_t>(vertices_.size());
    const auto index = parse_number<std::ptrdiff_t>(word.substr(0, word.find('/'))).value_or(0);
    if (index == 0 || index > count || index < -count) {
      lines_.fail(ErrorCode::parse, "a face has the vertex \"{}\", but there are {} before it",
                  excerpt(word), count);
    }
    return vertices_[static_cast<std::size_t>(index > 0 ? index - 1 : count + index)];
  }

  LineReader lines_;
  SurfaceBuilder& surface_;
  std::vector<Vec3> vertices_, corners_;
};

}  // namespace

void read_obj(std::string_view bytes, SurfaceBuilder& surface) { ObjReader(bytes, surface).read(); }

}  // namespace mneme::internal
