// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sphere approximations of all links of a robot, with a cache in the user's directory.
#pragma once

#include "mneme/spheres.h"

#include "base/content_cache.h"
#include "spheres/triangle_mesh.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Returns a hash of 32 hexadecimal digits of surface, settings and version of the algorithm.
[[nodiscard]] std::string sphere_key(const TriangleMesh& surface, const SphereSettings& settings);

/// Sphere approximations in a ContentCache.
class SphereCache {
 public:
  /// An empty `directory` is no cache: nothing is found or stored.
  explicit SphereCache(std::string directory) : files_(std::move(directory), "spheres") {}

  [[nodiscard]] const std::string& directory() const { return files_.directory(); }
  /// Returns the spheres stored under `key`, without the link's name. Nothing if there are none or
  /// the file is damaged.
  [[nodiscard]] std::optional<LinkSpheres> find(const std::string& key) const;
  /// Returns true if the file was written.
  bool store(const std::string& key, const LinkSpheres& spheres) const;

 private:
  ContentCache files_;
};

/// The spheres of a surface.
struct CachedSurface {
  LinkSpheres spheres;  ///< without the link's name
  bool is_found = false;
  bool is_stored = false;
};
/// approximate_solid(), from the cache if possible.
[[nodiscard]] CachedSurface approximate_surface(const TriangleMesh& surface,
                                                const SphereSettings& settings,
                                                const SphereCache& cache);

struct CachedSpheres {
  RobotSpheres robot;
  int found = 0;   ///< number of links read from the cache
  int stored = 0;  ///< number of links computed and stored in the cache
};

/// Returns for each link true if it is one of an arm's fingers or last three links.
[[nodiscard]] std::vector<bool> find_arm_ends(const Robot::Parts& parts);

/// As approximate_robot() of mneme/spheres.h, with this cache.
[[nodiscard]] Result<CachedSpheres> approximate_robot(Robot::Parts parts,
                                                      const SphereSettings& settings,
                                                      const SphereCache& cache,
                                                      const SphereProgress& on_approximated = {});

/// Names of checked pairs of links whose spheres overlap in every sampled configuration, or often.
struct InseparablePairs {
  using Names = std::vector<std::pair<std::string, std::string>>;
  Names always;         ///< pairs whose exact geometry always overlaps, too
  Names only_spheres;   ///< pairs whose exact geometry can be apart
  Names often_spheres;  ///< of which only the spheres overlap in 2 % of the configurations or more
};
/// Cost: 100 configurations if there are none, up to a second per pair otherwise.
[[nodiscard]] InseparablePairs find_inseparable_pairs(const Robot& robot);

}  // namespace mneme::internal
