// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths: their length, shortening and verification.
#pragma once

#include <cstdint>
#include <vector>

#include "mneme/base.h"
#include "mneme/collision.h"

namespace mneme {

/// A sequence of configurations joined by straight motions; continuous joints lie in [-pi, pi) and
/// take the shorter way round between neighbours.
using Path = std::vector<Configuration>;

/// Length of a path: the sum of L2 joint distances, radians.
[[nodiscard]] double path_length(const Robot& robot, const Path& path);

/// What the motions of a path must pass before it is returned.
enum class Verification {
  none,
  states,   ///< states at kVerificationRefinement times the resolution; of planar arms, `motions`
  motions,  ///< the same and all that lies between the states, by conservative bounds on how fast
            ///< links approach obstacles and each other (docs/numerics.md)
};

/// Shortens `path` by replacing stretches between random points of it with straight free motions
/// (Geraerts and Overmars, DOI 10.1177/0278364907079280). Keeps both ends. The new
/// motions pass the verification.
void shortcut(const CollisionChecker& checker, Path& path, std::uint64_t seed, int attempts,
              Verification verification, CheckCounters& counters);

/// The first motion of `path` that fails the verification; -1 if none does. A margin of
/// kVerificationMargin lets a path survive a check at other states of the same density, too; only
/// the first and the last motion do without it if their ends lie closer to contact.
[[nodiscard]] int find_invalid_motion(const CollisionChecker& checker, const Path& path,
                                      CheckCounters& counters,
                                      Verification verification = Verification::states);
inline constexpr double kVerificationMargin = 1e-4;  ///< metres
inline constexpr double kVerificationRefinement = 10;

}  // namespace mneme
