// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The exact geometry of links.
#pragma once

#include "mneme/robot.h"

#include <vector>

namespace mneme::internal {

/// The shapes of a link that are exact, and the surface that its sphere approximation holds, in the
/// link's frame.
class LinkSolid {
 public:
  explicit LinkSolid(const Link& link);

  /// Metres from a shape in the link's frame, by distance_to_solid (geometry/solid_distance.h): 0
  /// if they meet.
  [[nodiscard]] double distance_to(const Shape& shape) const;
  /// The same from a link that stands at X_LO, exact if that is at most `enough`, and otherwise
  /// anything above it.
  [[nodiscard]] double distance_to(const LinkSolid& other, const Transform& X_LO,
                                   double enough) const;

 private:
  std::vector<Capsule> shapes_;
  std::vector<Mesh> surfaces_;  ///< one, or none without an approximation
};

}  // namespace mneme::internal
