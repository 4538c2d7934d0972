// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/content_cache.h"

#include "base/files.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace mneme::internal {

std::string ContentCache::hash_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string ContentCache::path_of(const std::string& key) const {
  return fmt::format("{}/{}-{}.json", directory_, kind_, key);
}

std::optional<std::string> ContentCache::find(const std::string& key) const {
  if (directory_.empty()) return std::nullopt;
  std::ifstream file(path_of(key), std::ios::binary);
  std::string text;
  std::string checksum;
  if (!std::getline(file, text) || !std::getline(file, checksum)) return std::nullopt;
  if (checksum != hash_of(key + text)) return std::nullopt;
  return text;
}

bool ContentCache::store(const std::string& key, const std::string& text) const {
  std::error_code error;
  if (!directory_.empty()) std::filesystem::create_directories(directory_, error);
  if (directory_.empty() || error) return false;
  auto file = NewFile::create(path_of(key));
  // Another program may be writing the same entry.
  if (!file) return std::filesystem::exists(path_of(key) + ".unfinished", error);
  return file->write(fmt::format("{}\n{}\n", text, hash_of(key + text))) && file->finish();
}

}  // namespace mneme::internal
