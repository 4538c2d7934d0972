// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/gap_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mneme::internal {
namespace {

Vec2 unit(double direction) { return {std::cos(direction), std::sin(direction)}; }

double direction_of(const Vec2& v) { return std::atan2(v.y(), v.x()); }

double width(const GapSegment& gap) { return (gap.b - gap.a).norm(); }

/// Angle from the gap's normal, on the side of `along`, to `direction`.
double tilt_of(const GapSegment& gap, const Vec2& along, double direction) {
  const Vec2 normal(gap.a.y() - gap.b.y(), gap.b.x() - gap.a.x());
  const double there = direction_of(normal.dot(along) < 0 ? Vec2(-normal) : normal);
  return std::remainder(direction - there, 2 * std::numbers::pi);
}

/// Directions of two links of lengths `first` and `second` from the origin to `target`. `side`:
/// positive if the second link turns left.
struct TwoLinks {
  bool is_reached = false;
  double first = 0, second = 0;
};
TwoLinks reach_with_two_links(double first, double second, const Vec2& target, double side) {
  const double distance = target.norm();
  if (distance > first + second || distance < std::abs(first - second) || distance <= 0) return {};
  const double cosine =
      (first * first + distance * distance - second * second) / (2 * first * distance);
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const Vec2 ahead = target / distance, left(-ahead.y(), ahead.x());
  const Vec2 along = cosine * ahead + (side < 0 ? sine : -sine) * left;
  return {true, direction_of(along), direction_of(target - first * along)};
}

}  // namespace

GapCrossing find_gap_crossing(const PlanarChain& chain, const GapSegment& gap,
                              std::span<const double> q) {
  GapCrossing crossing;
  auto& [before, first, second, own] = crossing.directions;
  auto& [first_base, second_base, from] = crossing.bases;
  from = Vec2::Zero();
  for (int link = 0; link < chain.link_count(); ++link) {
    before = std::exchange(first, std::exchange(second, own));
    own = chain.direction(link, q[static_cast<std::size_t>(link)], second);
    const Vec2 along = unit(own);
    const Vec2 to = from + chain.length(link) * along;
    if (do_segments_cross(from, to, gap.a, gap.b)) {
      const Vec2 across = gap.b - gap.a;
      const double determinant = cross(along, across);
      if (determinant == 0) return {};
      const Vec2 offset = gap.a - from;
      crossing.link = link;
      crossing.entry = cross(offset, across) / determinant;
      crossing.fraction = std::clamp(cross(offset, along) / determinant, 0.0, 1.0);
      crossing.tilt = tilt_of(gap, along, own);
      return crossing;
    }
    first_base = std::exchange(second_base, std::exchange(from, to));
  }
  return {};
}

GapFit::GapFit(const PlanarChain& chain, const GapSegment& from, const GapSegment& to)
    : chain_(&chain), to_(to) {
  turn_ = direction_of(to.b - to.a) - direction_of(from.b - from.a);
  if (width(from) > 0) tilt_scale_ = std::min(1.0, std::sqrt(width(to) / width(from)));
}

bool GapFit::fit(const GapCrossing& crossing, std::span<double> q) const {
  const Vec2 target = to_.a + crossing.fraction * (to_.b - to_.a);
  if (crossing.link == 0) return fit_first_link(target, q);
  if (crossing.link == 1) return fit_second_link(crossing, target, q);
  return fit_later_link(crossing, target, q);
}

/// The first link has only one direction to the target.
bool GapFit::fit_first_link(const Vec2& target, std::span<double> q) const {
  if (target.norm() > chain_->length(0)) return false;
  q[0] = chain_->joint_value(0, direction_of(target), 0);
  return true;
}

/// Two links to the target; the tilt follows.
bool GapFit::fit_second_link(const GapCrossing& crossing, const Vec2& target,
                             std::span<double> q) const {
  const auto& [before, start, first, second] = crossing.directions;
  const TwoLinks links =
      reach_with_two_links(chain_->length(0), crossing.entry, target, std::sin(second - first));
  if (!links.is_reached) return false;
  q[0] = chain_->joint_value(0, links.first, 0);
  q[1] = chain_->joint_value(1, links.second, links.first);
  return true;
}

bool GapFit::fit_later_link(const GapCrossing& crossing, const Vec2& target,
                            std::span<double> q) const {
  const int link = crossing.link;
  const auto at = [](int joint) { return static_cast<std::size_t>(joint); };
  const auto& [before, first, second, across] = crossing.directions;
  const double new_across = across + turn_ - (1 - tilt_scale_) * crossing.tilt;
  const Vec2 new_base = target - crossing.entry * unit(new_across);
  // The links before the two bent ones turn as a whole.
  Vec2 start = crossing.bases.front();
  double direction = before;
  if (link > 2) {
    const Vec2& base = crossing.bases.back();
    const double cosine = base.dot(new_base), sine = cross(base, new_base);
    const double norm = std::hypot(cosine, sine);
    if (norm <= 0) return false;
    const double turn = std::atan2(sine, cosine);
    q[0] = chain_->joint_value(0, chain_->direction(0, q[0], 0) + turn, 0);
    direction += turn;
    start =
        Vec2(cosine * start.x() - sine * start.y(), sine * start.x() + cosine * start.y()) / norm;
  }
  const TwoLinks links = reach_with_two_links(chain_->length(link - 2), chain_->length(link - 1),
                                              new_base - start, std::sin(second - first));
  if (!links.is_reached) return false;
  q[at(link - 2)] = chain_->joint_value(link - 2, links.first, direction);
  q[at(link - 1)] = chain_->joint_value(link - 1, links.second, links.first);
  q[at(link)] = chain_->joint_value(link, new_across, links.second);
  return true;
}

}  // namespace mneme::internal
