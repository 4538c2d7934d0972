// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Fuzzing of a format of meshes.
#pragma once

#include "fuzz/fuzz_input.h"
#include "mesh/mesh_file.h"

namespace mneme::fuzz {

/// Reads a mesh whose format is that of the file name `path`.
inline int read_mesh(const std::uint8_t* data, std::size_t size, const char* path) {
  const auto mesh = internal::parse_triangles(as_text(data, size), path, Vec3::Ones(), {});
  expect_message(mesh);
  if (!mesh) return 0;
  if (mesh->empty() || mesh->size() > internal::kMaxTriangles) std::abort();
  for (const Triangle& t : *mesh) {
    if (!(t.area() > 0) || !Vec3(t.a + t.b + t.c).allFinite()) std::abort();
  }
  return 0;
}

}  // namespace mneme::fuzz
