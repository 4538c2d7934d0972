// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Covers that were made before, in files of the user's cache directory.
#pragma once

#include <optional>
#include <string>

#include "mneme/covering.h"

#include "covering/triangle_mesh.h"

namespace mneme::internal {

/// 32 hexadecimal digits over surface, settings and the version of the algorithm.
[[nodiscard]] std::string cover_key(const TriangleMesh& surface, const CoverSettings& settings);

/// A directory with one file per cover. Several programs may use it at a time.
class CoverCache {
 public:
  /// In an empty `directory` nothing is found or stored.
  explicit CoverCache(std::string directory) : directory_(std::move(directory)) {}

  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// The cover that was stored under `key`, without the link's name; nothing if there is none or
  /// its file is damaged.
  [[nodiscard]] std::optional<LinkCover> find(const std::string& key) const;
  /// True if it was written, as a whole.
  bool store(const std::string& key, const LinkCover& cover) const;

 private:
  [[nodiscard]] std::string path_of(const std::string& key) const;
  std::string directory_;
};

}  // namespace mneme::internal
