// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Fits planar arms that pass one gap to another gap.
#pragma once

#include "memory/planar_chain.h"

#include <array>
#include <span>

namespace mneme::internal {

/// The first link of an arm that crosses a gap, with directions and bases of this link and of up to
/// two links before it. Cached, because a query fits some hundred configurations.
struct GapCrossing {
  int link = -1;                       ///< Index of the link; -1: none.
  double fraction = 0;                 ///< Position of the crossing from the gap's a (0) to b (1).
  double entry = 0;                    ///< Length of the link before the gap, metres.
  double tilt = 0;                     ///< Angle from the gap's normal to the link, radians.
  std::array<double, 4> directions{};  ///< Radians; the crossing link's is the last.
  std::array<Vec2, 3> bases{};         ///< Bases of the links, in the same order.
};
[[nodiscard]] GapCrossing find_gap_crossing(const PlanarChain& chain, const GapSegment& gap,
                                            std::span<const double> q);

/// Fits configurations threaded through one gap to a similar gap: unchanged, they would hit the
/// circles. The first crossing link keeps its position in the gap; its tilt is scaled by the root
/// of the width ratio, like clearance between circles. Its base is placed by turning the arm about
/// its own base and by bending the two links before it, with the elbow on the side where it was.
/// Only these four joints change. O(links). Const is parallel-safe.
class GapFit {
 public:
  /// The ends of `to` must be in the order of `from`. Refers to the chain.
  GapFit(const PlanarChain& chain, const GapSegment& from, const GapSegment& to);

  /// Fits `q`, whose crossing is `crossing`. Returns false, leaving `q` undefined, if the arm
  /// cannot reach. Limits are not checked.
  [[nodiscard]] bool fit(const GapCrossing& crossing, std::span<double> q) const;

 private:
  bool fit_first_link(const Vec2& target, std::span<double> q) const;
  bool fit_second_link(const GapCrossing& crossing, const Vec2& target, std::span<double> q) const;
  bool fit_later_link(const GapCrossing& crossing, const Vec2& target, std::span<double> q) const;

  const PlanarChain* chain_;
  GapSegment to_;
  double turn_ = 0;        ///< radians from one normal to the other
  double tilt_scale_ = 1;  ///< at most 1
};

}  // namespace mneme::internal
