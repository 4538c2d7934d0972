// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_cache.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>
#include <xxhash.h>

#include "covering/cover_solid.h"

namespace mneme::internal {
namespace {

using Json = nlohmann::json;

std::string hash_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

Json to_json(const LinkCover& cover) {
  Json spheres = Json::array();
  for (const Sphere& s : cover.spheres) {
    spheres.push_back({s.center.x(), s.center.y(), s.center.z(), s.radius});
  }
  return {{"spheres", spheres},
          {"uncovered", cover.uncovered},
          {"mean_excess", cover.mean_excess},
          {"max_excess", cover.max_excess}};
}

LinkCover from_json(const Json& json) {
  LinkCover cover;
  for (const auto& [x, y, z, radius] :
       json.at("spheres").get<std::vector<std::array<double, 4>>>()) {
    cover.spheres.push_back({Vec3(x, y, z), radius});
  }
  json.at("uncovered").get_to(cover.uncovered);
  json.at("mean_excess").get_to(cover.mean_excess);
  json.at("max_excess").get_to(cover.max_excess);
  return cover;
}

/// Writes a file of its own and renames it, so that no reader sees half of it.
bool write_whole(const std::string& path, const std::string& text) {
  std::string temporary = path + ".XXXXXX";
  const int file = ::mkstemp(temporary.data());
  if (file < 0) return false;
  const ssize_t written = ::write(file, text.data(), text.size());
  const bool is_closed = ::close(file) == 0;
  const bool is_written = is_closed && written == static_cast<ssize_t>(text.size()) &&
                          std::rename(temporary.c_str(), path.c_str()) == 0;
  if (!is_written) ::unlink(temporary.c_str());
  return is_written;
}

}  // namespace

std::string cover_key(const TriangleMesh& surface, const CoverSettings& settings) {
  std::vector<double> numbers = {kCoverVersion, settings.excess,
                                 static_cast<double>(settings.max_spheres)};
  for (const Triangle& triangle : surface) {
    for (const Vec3& corner : {triangle.a, triangle.b, triangle.c}) {
      // Adding zero makes -0 the same as 0.
      for (const double coordinate : corner) numbers.push_back(coordinate + 0.0);
    }
  }
  return hash_of({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

std::string CoverCache::path_of(const std::string& key) const {
  return fmt::format("{}/cover-{}.json", directory_, key);
}

std::optional<LinkCover> CoverCache::find(const std::string& key) const {
  if (directory_.empty()) return std::nullopt;
  std::ifstream file(path_of(key), std::ios::binary);
  std::string text;
  std::string checksum;
  if (!std::getline(file, text) || !std::getline(file, checksum)) return std::nullopt;
  if (checksum != hash_of(key + text)) return std::nullopt;
  try {
    return from_json(Json::parse(text));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

bool CoverCache::store(const std::string& key, const LinkCover& cover) const {
  std::error_code error;
  if (!directory_.empty()) std::filesystem::create_directories(directory_, error);
  if (directory_.empty() || error) return false;
  const std::string text = to_json(cover).dump();
  return write_whole(path_of(key), fmt::format("{}\n{}\n", text, hash_of(key + text)));
}

}  // namespace mneme::internal
