// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How planar arms stand in gaps, by their robots.
#pragma once

#include "memory/planar_chain.h"
#include "support/support.h"

namespace mneme::test {

inline int first_crossing_link(const Robot& robot, const PrimitiveKey& key,
                               std::span<const double> q) {
  return internal::first_crossing_link(require(internal::PlanarChain::make(robot)), key, q);
}

inline std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                                    const PrimitiveKey& key, int first_link,
                                                    int attempts, Rng& rng) {
  return internal::sample_threaded(checker, require(internal::PlanarChain::make(checker.robot())),
                                   key, first_link, attempts, rng);
}

inline std::vector<Configuration> sample_outside(const CollisionChecker& checker,
                                                 const PrimitiveKey& key, int count, int attempts,
                                                 Rng& rng) {
  return internal::sample_outside(checker, require(internal::PlanarChain::make(checker.robot())),
                                  key, count, attempts, rng);
}

}  // namespace mneme::test
