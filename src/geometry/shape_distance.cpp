// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "geometry/nearest_point.h"

namespace mneme {
// Alternating projections (Cheney and Goldstein, DOI 10.2307/2033416) are projected gradient steps
// on half the squared distance; where solids meet at a slant they creep. Momentum mends that (Beck
// and Teboulle, DOI 10.1137/080716542), restarted when it leads astray (O'Donoghue and Candes,
// DOI 10.1007/s10208-013-9150-3); only a round without momentum says that no way is left.
double distance(const Shape& a, const Shape& b) {
  constexpr int kMostRounds = 200;
  constexpr double kTolerance = 1e-6;
  Vec3 p = bounding_sphere(a).center;
  Vec3 from = p;
  double least = std::numeric_limits<double>::infinity();
  int momentum = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 q = internal::nearest_point(from, b);
    const Vec3 next = internal::nearest_point(q, a);
    const double now = (next - q).norm();
    if (now < kTolerance) return 0;
    const bool has_settled = least - now < kTolerance;
    if (has_settled && momentum == 0) return std::min(now, least);
    const Vec3 step = next - p;
    if (now <= least) p = next;
    least = std::min(now, least);
    momentum = has_settled ? 0 : momentum + 1;
    from = p;
    if (momentum > 1) from += (momentum - 1.0) / (momentum + 2.0) * step;
  }
  return least;
}

}  // namespace mneme
