// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Collecting the triangles of a mesh file, and the readers of its formats.
#pragma once

#include "mneme/geometry.h"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Places triangles, checks them and skips those without area. Its functions throw InputFailure.
class SurfaceBuilder {
 public:
  /// Keeps a reference to `source`, which names the file. Corners are scaled along the mesh's axes,
  /// then moved to `pose`.
  SurfaceBuilder(const std::string& source, const Vec3& scale, const Transform& pose)
      : source_(source), scale_(scale), pose_(pose) {}

  void add(const Vec3& a, const Vec3& b, const Vec3& c);
  void add_polygon(std::span<const Vec3> corners);
  /// Triangles of a polygon, as indices of its corners: a fan if it is convex, otherwise by ear
  /// clipping. Fails for more than kMaxTriangles, for a concave polygon with very many corners, and
  /// when the concave polygons of the file together take too many steps.
  [[nodiscard]] std::vector<std::array<std::size_t, 3>> triangulate(std::span<const Vec3> corners);
  [[noreturn]] void fail_too_many() const;
  /// The triangles; fails if there are none.
  [[nodiscard]] std::vector<Triangle> take();

  [[nodiscard]] bool is_empty() const { return triangles_.empty(); }
  [[nodiscard]] const std::string& source() const { return source_; }

 private:
  [[nodiscard]] Vec3 place(const Vec3& corner) const;

  const std::string& source_;
  Vec3 scale_;
  Transform pose_;
  std::vector<Triangle> triangles_;
  std::size_t count_ = 0;      ///< with skipped ones
  std::size_t ear_steps_ = 0;  ///< of ear clipping so far
};

// Each reads a file with these bytes into `surface`.
void read_stl(std::string_view bytes, SurfaceBuilder& surface);
void read_obj(std::string_view bytes, SurfaceBuilder& surface);
void read_ply(std::string_view bytes, SurfaceBuilder& surface);
void read_dae(std::string_view bytes, SurfaceBuilder& surface);

}  // namespace mneme::internal
