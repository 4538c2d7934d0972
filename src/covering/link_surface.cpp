// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/link_surface.h"

#include <fmt/format.h>

#include "covering/mesh_reader.h"

namespace mneme::internal {
namespace {

/// Metres. The search for few spheres takes the longer the more they must stick out.
constexpr double kLongest = 30;

struct Triangulate {
  Result<TriangleMesh> operator()(const Box& box) const { return triangulate(box); }
  Result<TriangleMesh> operator()(const Cylinder& cylinder) const { return triangulate(cylinder); }
  Result<TriangleMesh> operator()(const MeshFile& file) const { return read_mesh(file); }
};

Result<TriangleMesh> refuse_huge(const Link& link, TriangleMesh surface) {
  const Bounds bounds = bounds_of(surface);
  const double longest = (bounds.high - bounds.low).maxCoeff();
  if (longest <= kLongest) return surface;
  return fail(ErrorCode::invalid,
              fmt::format("link '{}': its collision geometry is {:.0f} m long, expected at most {} "
                          "m; one in millimetres needs a scale of 0.001",
                          link.name, longest, kLongest));
}

}  // namespace

Result<TriangleMesh> link_surface(const Link& link) {
  TriangleMesh surface;
  for (const Solid& solid : link.solids) {
    const auto part = std::visit(Triangulate{}, solid);
    if (!part) {
      return fail(part.error().code, fmt::format("link '{}': {}", link.name, part.error().message));
    }
    surface.insert(surface.end(), part->begin(), part->end());
  }
  const double area = surface_area(surface);
  if (std::isfinite(area) && area > 0) return refuse_huge(link, std::move(surface));
  return fail(ErrorCode::invalid,
              fmt::format("link '{}': its collision geometry has an area of {} m2, expected a "
                          "surface to cover",
                          link.name, area));
}

}  // namespace mneme::internal
