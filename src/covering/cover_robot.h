// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// All links of a robot covered, from the cache in the user's directory where possible.
#pragma once

#include "mneme/covering.h"

#include "covering/triangle_mesh.h"

#include <optional>
#include <string>

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

struct CachedCovering {
  Covering covering;
  int found = 0;   ///< covers that were in the cache
  int stored = 0;  ///< covers that were made and are in the cache now
};

/// For each link whether it is one of an arm's fingers or last three links.
[[nodiscard]] std::vector<bool> find_arm_ends(const Robot::Parts& parts);

/// cover_robot with this cache.
[[nodiscard]] Result<CachedCovering> cover_robot(Robot::Parts parts, const CoverSettings& settings,
                                                 const CoverCache& cache,
                                                 const CoverProgress& on_covered = {});

}  // namespace mneme::internal
