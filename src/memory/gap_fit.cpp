// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/gap_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::internal {
namespace {

Vec2 unit(double direction) { return {std::cos(direction), std::sin(direction)}; }

double direction_of(const Vec2& v) { return std::atan2(v.y(), v.x()); }

double width(const GapSegment& gap) { return (gap.b - gap.a).norm(); }

/// Of the gap's normal on the side of `along`.
double normal_direction(const GapSegment& gap, const Vec2& along) {
  const Vec2 normal(gap.a.y() - gap.b.y(), gap.b.x() - gap.a.x());
  return direction_of(normal.dot(along) < 0 ? Vec2(-normal) : normal);
}

/// The directions of two links of lengths `first` and `second` from the origin to `target`.
/// `side`: positive if the second one turns left.
struct TwoLinks {
  bool is_reached = false;
  double first = 0, second = 0;
};
TwoLinks reach_with_two_links(double first, double second, const Vec2& target, double side) {
  const double distance = target.norm();
  if (distance > first + second || distance < std::abs(first - second) || distance <= 0) return {};
  const double cosine =
      (first * first + distance * distance - second * second) / (2 * first * distance);
  const double shoulder = std::acos(std::clamp(cosine, -1.0, 1.0));
  const double direction = direction_of(target) - (side < 0 ? -shoulder : shoulder);
  return {true, direction, direction_of(target - first * unit(direction))};
}

}  // namespace

GapCrossing find_gap_crossing(const PlanarChain& chain, const GapSegment& gap,
                              std::span<const double> q) {
  Vec2 from = Vec2::Zero();
  double direction = 0;
  for (int link = 0; link < chain.link_count(); ++link) {
    direction = chain.direction(link, q[static_cast<std::size_t>(link)], direction);
    const Vec2 along = unit(direction);
    const Vec2 to = from + chain.length(link) * along;
    if (do_segments_cross(from, to, gap.a, gap.b)) {
      const Vec2 across = gap.b - gap.a;
      const double determinant = along.x() * across.y() - along.y() * across.x();
      if (determinant == 0) return {};
      const Vec2 offset = gap.a - from;
      const double entry = (offset.x() * across.y() - offset.y() * across.x()) / determinant;
      const double fraction = (offset.x() * along.y() - offset.y() * along.x()) / determinant;
      const double tilt =
          std::remainder(direction - normal_direction(gap, along), 2 * std::numbers::pi);
      return {link, std::clamp(fraction, 0.0, 1.0), entry, tilt};
    }
    from = to;
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

/// There is but one direction.
bool GapFit::fit_first_link(const Vec2& target, std::span<double> q) const {
  if (target.norm() > chain_->length(0)) return false;
  q[0] = chain_->joint_value(0, direction_of(target), 0);
  return true;
}

/// Two links to the target itself: the tilt is what comes of it.
bool GapFit::fit_second_link(const GapCrossing& crossing, const Vec2& target,
                             std::span<double> q) const {
  const double first = chain_->direction(0, q[0], 0);
  const double side = std::sin(chain_->direction(1, q[1], first) - first);
  const TwoLinks links = reach_with_two_links(chain_->length(0), crossing.entry, target, side);
  if (!links.is_reached) return false;
  q[0] = chain_->joint_value(0, links.first, 0);
  q[1] = chain_->joint_value(1, links.second, links.first);
  return true;
}

bool GapFit::fit_later_link(const GapCrossing& crossing, const Vec2& target,
                            std::span<double> q) const {
  const int link = crossing.link;
  const auto at = [](int joint) { return static_cast<std::size_t>(joint); };
  // Where the two links before the crossing one start, and what they and it head for.
  Vec2 start = Vec2::Zero();
  double direction = 0;
  for (int i = 0; i < link - 2; ++i) {
    direction = chain_->direction(i, q[at(i)], direction);
    start += chain_->length(i) * unit(direction);
  }
  const double first = chain_->direction(link - 2, q[at(link - 2)], direction);
  const double second = chain_->direction(link - 1, q[at(link - 1)], first);
  const double across = chain_->direction(link, q[at(link)], second);
  const Vec2 base =
      start + chain_->length(link - 2) * unit(first) + chain_->length(link - 1) * unit(second);

  const double new_across = across + turn_ - (1 - tilt_scale_) * crossing.tilt;
  const Vec2 new_base = target - crossing.entry * unit(new_across);
  if (link > 2) {
    const double turn = direction_of(new_base) - direction_of(base);
    q[0] = chain_->joint_value(0, chain_->direction(0, q[0], 0) + turn, 0);
    direction += turn;
    start = Eigen::Rotation2Dd(turn) * start;
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
