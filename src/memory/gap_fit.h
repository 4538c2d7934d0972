// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planar arms that pass one gap as they passed another one.
#pragma once

#include "memory/planar_chain.h"

#include <array>
#include <span>

namespace mneme::internal {

/// The first link of an arm that crosses a gap, and how. It and the two links before it, as far as
/// there are any, are kept as they are found: what is fitted is fitted some hundred times a query.
struct GapCrossing {
  int link = -1;        ///< -1: none does
  double fraction = 0;  ///< where, of the way from the gap's a to its b, 0 to 1
  double entry = 0;     ///< metres of the link before the gap
  double tilt = 0;      ///< radians from the gap's normal, on whose side the link leaves
  std::array<double, 4> directions{};  ///< radians; its own is the last
  std::array<Vec2, 3> bases{};         ///< where links begin, likewise
};
[[nodiscard]] GapCrossing find_gap_crossing(const PlanarChain& chain, const GapSegment& gap,
                                            std::span<const double> q);

/// Takes arms that were threaded through one gap to another that is not quite where, or as wide as,
/// the first one was: a mean that is off by as much as two keys may be apart meets circles instead
/// of the gap. The first link that crosses keeps its GapCrossing (its tilt shrinks with the root of
/// the width, as clearance beside circles does); its base gets where it must by turning the arm
/// about its own base, and by bending the two links before on the side where their elbow is. No
/// joint but these four changes. O(links). Const is parallel-safe.
class GapFit {
 public:
  /// `to` must be named as `from` is: a is near a. Refers to the chain.
  GapFit(const PlanarChain& chain, const GapSegment& from, const GapSegment& to);

  /// Changes `q`, which crosses as `crossing` says; false, and it is of no use any longer, if the
  /// arm does not reach so far. Limits are the caller's business.
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
