// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/line_reader.h"
#include "mesh/mesh_file.h"
#include "mesh/surface_builder.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Strips of kMaxTriangles triangles apart from each other have fewer indices.
constexpr std::size_t kMostIndices = 6 * kMaxTriangles;

/// Numbers of a PLY file after its header. A line of text holds one item of an element.
class PlyNumbers {
 public:
  PlyNumbers(LineReader& lines, PlyHeader::Data data)
      : lines_(lines), data_(data), bytes_(lines.rest()) {}

  void begin_item() {
    if (data_ != PlyHeader::Data::text) return;
    do {
      words_ = &lines_.expect_line("all elements that it announces");
    } while (words_->empty());
    word_ = 0;
  }
  double next(NumberType type) {
    if (data_ == PlyHeader::Data::text) {
      if (word_ == words_->size()) lines_.fail(ErrorCode::parse, "has too few numbers");
      return lines_.read_number((*words_)[word_++]);
    }
    if (bytes_.size() < type.size) {
      lines_.fail_file(ErrorCode::parse, "ends before all elements that it announces");
    }
    const double number = read_binary(bytes_.data(), type, data_ == PlyHeader::Data::big_endian);
    bytes_.remove_prefix(type.size);
    return number;
  }
  void end_item() const {
    if (data_ == PlyHeader::Data::text && word_ != words_->size()) {
      lines_.fail(ErrorCode::parse, "expected {} numbers, got {}", word_, words_->size());
    }
  }

 private:
  LineReader& lines_;
  PlyHeader::Data data_;
  std::string_view bytes_;        ///< of binary data
  const Words* words_ = nullptr;  ///< of text
  std::size_t word_ = 0;
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, SurfaceBuilder& surface)
      : lines_(bytes, surface.source()), surface_(surface) {}

  void read() {
    const PlyHeader header = read_ply_header(lines_);
    PlyNumbers numbers(lines_, header.data);
    for (const PlyElement& element : header.elements) {
      // Such items take no space, so that any number may be announced.
      if (element.properties.empty()) continue;
      if (element.name == "vertex") check_vertices(element);
      has_vertices_ = has_vertices_ || element.name == "vertex";
      for (std::size_t i = 0; i < element.count; ++i) read_item(element, numbers);
    }
    add_early_lists();
  }

 private:
  void check_vertices(const PlyElement& element) const {
    for (const char* axis : {"x", "y", "z"}) {
      const auto found = std::ranges::find(element.properties, axis, &PlyProperty::name);
      if (found == element.properties.end() || found->is_list) {
        lines_.fail_file(ErrorCode::parse, "expected a property {} of vertices", axis);
      }
    }
  }

  void read_item(const PlyElement& element, PlyNumbers& numbers) {
    Vec3 vertex;
    numbers.begin_item();
    for (const PlyProperty& property : element.properties) {
      if (property.is_list) {
        const bool is_face = element.name == "face" && is_indices(property);
        const bool is_strips = element.name == "tristrips" && is_indices(property);
        const std::size_t most = is_face ? kMaxTriangles + 2 : is_strips ? kMostIndices : 0;
        read_list(property, most, numbers);
        if (!has_vertices_ && most > 0) {
          put_off(is_strips);
        } else if (is_face) {
          add_face();
        } else if (is_strips) {
          add_strips();
        }
        continue;
      }
      const double number = numbers.next(property.type);
      for (int axis = 0; axis < 3; ++axis) {
        if (property.name == std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1)) {
          vertex[axis] = number;
        }
      }
    }
    numbers.end_item();
    if (element.name != "vertex") return;
    if (vertices_.size() == kMaxVertices) {
      lines_.fail_file(ErrorCode::unsupported, "has more than {} vertices", kMaxVertices);
    }
    vertices_.push_back(vertex);
  }

  static bool is_indices(const PlyProperty& property) {
    return property.name == "vertex_indices" || property.name == "vertex_index";
  }

  /// Keeps a list of up to `most` indices; skips the list if `most` is 0. A longer one is refused
  /// before it takes memory.
  void read_list(const PlyProperty& property, std::size_t most, PlyNumbers& numbers) {
    const double length = numbers.next(property.count_type);
    if (!(length >= 0)) lines_.fail_file(ErrorCode::parse, "has a list of length {}", length);
    if (most > 0 && length > static_cast<double>(most)) surface_.fail_too_many();
    list_.clear();
    for (double i = 0; i < length; ++i) {
      const double number = numbers.next(property.type);
      if (most > 0) list_.push_back(number);
    }
  }

  /// Keeps the list for when there are vertices.
  void put_off(bool is_strips) {
    if (list_.size() < 3) return;  // no surface
    if (early_numbers_.size() + list_.size() > kMostIndices) surface_.fail_too_many();
    early_.push_back({early_numbers_.size(), list_.size(), is_strips});
    early_numbers_.insert(early_numbers_.end(), list_.begin(), list_.end());
  }
  void add_early_lists() {
    for (const EarlyList& early : early_) {
      const auto begin = early_numbers_.begin() + static_cast<std::ptrdiff_t>(early.begin);
      list_.assign(begin, begin + static_cast<std::ptrdiff_t>(early.count));
      early.is_strips ? add_strips() : add_face();
    }
  }

  [[nodiscard]] const Vec3& vertex_at(double index) const {
    if (!(index >= 0 && index < static_cast<double>(vertices_.size()) &&
          index == std::floor(index))) {
      lines_.fail_file(ErrorCode::parse, "a face has the vertex {}, but there are {}", index,
                       vertices_.size());
    }
    return vertices_[static_cast<std::size_t>(index)];
  }

  void add_face() {
    corners_.clear();
    for (const double index : list_) corners_.push_back(vertex_at(index));
    surface_.add_polygon(corners_);
  }

  /// Strips of triangles, with -1 between them.
  void add_strips() {
    for (std::size_t i = 0; i + 2 < list_.size(); ++i) {
      if (list_[i] == -1 || list_[i + 1] == -1 || list_[i + 2] == -1) continue;
      surface_.add(vertex_at(list_[i]), vertex_at(list_[i + 1]), vertex_at(list_[i + 2]));
    }
  }

  LineReader lines_;
  SurfaceBuilder& surface_;
  std::vector<Vec3> vertices_, corners_;
  std::vector<double> list_;
  struct EarlyList {
    std::size_t begin, count;  ///< in early_numbers_
    bool is_strips;
  };
  std::vector<EarlyList> early_;  ///< of faces that come before the vertices
  std::vector<double> early_numbers_;
  bool has_vertices_ = false;
};

}  // namespace

void read_ply(std::string_view bytes, SurfaceBuilder& surface) {
  if (!is_ply(bytes)) {
    throw_failure(ErrorCode::parse, "{}: expected a file that begins with a line \"ply\"",
                  surface.source());
  }
  PlyReader(bytes, surface).read();
}

}  // namespace mneme::internal
