// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/mesh_file.h"

#include "base/as_index.h"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <fstream>

namespace mneme::internal {
namespace {

constexpr double kFarthest = 1000;
constexpr int kDeepestNode = 256;

/// The file of a mesh, and its scale and pose.
struct MeshPlace {
  const std::string& path;
  Vec3 scale;
  Transform pose;
};

tl::unexpected<Error> refuse(ErrorCode code, const MeshPlace& file, const std::string& what) {
  return fail(code, fmt::format("mesh {}: {}", file.path, what));
}

std::string suffix_of(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

/// The size in bytes of a regular file that is neither empty nor too large.
Result<std::size_t> find_size(const MeshPlace& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file.path, error);
  if (!std::filesystem::exists(status)) return refuse(ErrorCode::io, file, "there is no such file");
  if (!std::filesystem::is_regular_file(status)) {
    return refuse(ErrorCode::io, file, "is not a file");
  }
  const auto size = std::filesystem::file_size(file.path, error);
  if (error) return refuse(ErrorCode::io, file, "cannot be read");
  if (size > kMaxMeshBytes) {
    return refuse(ErrorCode::unsupported, file,
                  fmt::format("has {} bytes, expected at most {}", size, kMaxMeshBytes));
  }
  if (size == 0) return refuse(ErrorCode::parse, file, "is empty");
  return size;
}

Result<std::string> read_bytes(const MeshPlace& file, std::size_t size) {
  std::string bytes(size, '\0');
  std::ifstream stream(file.path, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) return refuse(ErrorCode::io, file, "cannot be read");
  return bytes;
}

/// The fault of an STL file, or "". Binary files state their number of triangles; in text files
/// each triangle is a facet.
std::string find_stl_fault(const std::string& bytes) {
  const std::string truncated = "ends before the triangles that it announces";
  const std::string hollow = "has no triangles, expected a surface";
  const bool is_text = bytes.starts_with("solid") && bytes.find('\0') == std::string::npos;
  if (is_text) return bytes.find("facet") == std::string::npos ? hollow : "";
  if (bytes.size() < 84) return truncated;
  std::uint64_t count = 0;
  for (int i = 3; i >= 0; --i) {
    count = count << 8 | static_cast<unsigned char>(bytes[80 + as_index(i)]);
  }
  const bool is_binary = bytes.find('\0') != std::string::npos;
  if (is_binary && bytes.size() < 84 + 50 * count) return truncated;
  return is_binary && count == 0 ? hollow : "";
}

Vec3 to_vector(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Collects triangles and checks them.
class Collector {
 public:
  Collector(const aiScene& scene, const MeshPlace& file) : scene_(scene), file_(file) {}

  void add(const aiNode& node, const aiMatrix4x4& parent, int level = 0) {
    if (is_too_many_) return;
    if (level > kDeepestNode) {
      wrong_ = fmt::format("nests its nodes too deep, expected at most {} levels", kDeepestNode);
      return;
    }
    const aiMatrix4x4 pose = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene_.mMeshes[node.mMeshes[i]], pose);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], pose, level + 1);
  }

  [[nodiscard]] Result<std::vector<Triangle>> result() {
    if (is_too_many_) {
      return refuse(ErrorCode::unsupported, file_,
                    fmt::format("has too many triangles, expected at most {}", kMaxTriangles));
    }
    if (!wrong_.empty()) return refuse(ErrorCode::parse, file_, wrong_);
    if (mesh_.empty()) {
      return refuse(ErrorCode::parse, file_, "has no triangle with an area, expected a surface");
    }
    return std::move(mesh_);
  }

 private:
  void add(const aiMesh& mesh, const aiMatrix4x4& pose) {
    is_too_many_ = is_too_many_ || mesh_.size() + mesh.mNumFaces > kMaxTriangles;
    for (unsigned i = 0; i < mesh.mNumFaces && !is_too_many_; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      const auto corner = [&](int j) { return place(mesh, face.mIndices[j], pose); };
      const Triangle triangle{corner(0), corner(1), corner(2)};
      if (triangle.area() > 0) mesh_.push_back(triangle);
    }
  }

  Vec3 place(const aiMesh& mesh, unsigned index, const aiMatrix4x4& pose) {
    if (index >= mesh.mNumVertices) {
      wrong_ = fmt::format("a face names vertex {}, but there are {}", index, mesh.mNumVertices);
      return Vec3::Zero();
    }
    const Vec3 p = to_vector(pose * mesh.mVertices[index]).cwiseProduct(file_.scale);
    // The comparison is false for NaN.
    if (!(p.cwiseAbs().maxCoeff() <= kFarthest) || !p.allFinite()) {
      wrong_ = fmt::format("vertex {} is at ({}, {}, {}), expected coordinates within {} m", index,
                           p.x(), p.y(), p.z(), kFarthest);
    }
    return file_.pose * p;
  }

  const aiScene& scene_;
  const MeshPlace& file_;
  std::vector<Triangle> mesh_;
  std::string wrong_;
  bool is_too_many_ = false;
};

Result<std::vector<Triangle>> import(const MeshPlace& file) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(file.path, aiProcess_Triangulate | aiProcess_SortByPType);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    return refuse(ErrorCode::parse, file,
                  fmt::format("cannot be read: {}", importer.GetErrorString()));
  }
  Collector collector(*scene, file);
  collector.add(*scene->mRootNode, aiMatrix4x4());
  return collector.result();
}

}  // namespace

Result<std::vector<Triangle>> read_triangles(const std::string& path, const Vec3& scale,
                                             const Transform& pose) {
  const MeshPlace file{path, scale, pose};
  const std::string suffix = suffix_of(file.path);
  if (suffix != ".stl" && suffix != ".obj" && suffix != ".dae" && suffix != ".ply") {
    return refuse(ErrorCode::unsupported, file, "expected a file named .stl, .obj, .dae or .ply");
  }
  const std::size_t size = MNEME_TRY(find_size(file));
  if (suffix == ".stl") {
    const std::string bytes = MNEME_TRY(read_bytes(file, size));
    const std::string fault = find_stl_fault(bytes);
    if (!fault.empty()) return refuse(ErrorCode::parse, file, fault);
  }
  try {
    return import(file);
  } catch (const std::exception& error) {
    return refuse(ErrorCode::parse, file, fmt::format("cannot be read: {}", error.what()));
  }
}

}  // namespace mneme::internal
