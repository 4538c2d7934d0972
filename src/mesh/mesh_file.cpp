// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_file.h"

#include "base/fail.h"
#include "base/files.h"
#include "mesh/line_reader.h"
#include "mesh/surface_builder.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace mneme::internal {
namespace {

using ReadMesh = void (*)(std::string_view bytes, SurfaceBuilder& surface);
constexpr std::array<std::pair<std::string_view, ReadMesh>, 4> kFormats = {
    {{".stl", read_stl}, {".obj", read_obj}, {".dae", read_dae}, {".ply", read_ply}}};

Result<ReadMesh> find_format(const std::string& path) {
  const std::string suffix = lower_case(std::filesystem::path(path).extension().string());
  const auto format = std::ranges::find(kFormats, suffix, [](const auto& f) { return f.first; });
  if (format != kFormats.end()) return format->second;
  return fail(ErrorCode::unsupported, "mesh {}: expected a file named .stl, .obj, .dae or .ply",
              path);
}

}  // namespace

Result<std::vector<Triangle>> read_triangles(const std::string& path, const Vec3& scale,
                                             const Transform& pose) {
  if (auto format = find_format(path); !format) return tl::unexpected(format.error());
  const Result<std::string> bytes = read_regular_file(path, kMaxMeshBytes);
  if (!bytes) return fail(bytes.error().code, "mesh {}", bytes.error().message);
  return parse_triangles(*bytes, path, scale, pose);
}

bool is_empty_mesh(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{64} << 10;
  const auto format = find_format(path);
  const Result<std::string> bytes = read_regular_file(path, kMostBytes);
  if (!format || !bytes) return false;
  const auto is_empty = without_throwing([&] {
    SurfaceBuilder surface(path, Vec3::Ones(), {});
    if (!bytes->empty()) (*format)(*bytes, surface);
    return surface.is_empty();
  });
  return is_empty.value_or(false);
}

Result<std::vector<Triangle>> parse_triangles(std::string_view bytes, const std::string& path,
                                              const Vec3& scale, const Transform& pose) {
  const ReadMesh read = MNEME_TRY(find_format(path));
  if (bytes.empty()) return fail(ErrorCode::parse, "mesh {}: is empty", path);
  if (bytes.starts_with("version https://git-lfs")) {
    return fail(ErrorCode::parse, "mesh {}: is a pointer of Git LFS; fetch the file: git lfs pull",
                path);
  }
  const std::string source = "mesh " + path;
  return without_throwing([&] {
    SurfaceBuilder surface(source, scale, pose);
    read(bytes, surface);
    return surface.take();
  });
}

}  // namespace mneme::internal
