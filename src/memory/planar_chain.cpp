// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/planar_chain.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace mneme::internal {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

bool do_boxes_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (a.cwiseMin(b).array() <= c.cwiseMax(d).array()).all() &&
         (c.cwiseMin(d).array() <= a.cwiseMax(b).array()).all();
}

}  // namespace

Result<PlanarChain> PlanarChain::make(const Robot& robot) {
  const auto refuse = [&](const std::string& why) {
    return fail(
        ErrorCode::unsupported,
        "robot '" + robot.name() + "': learning local samplers needs a planar serial arm: " + why);
  };
  if (!robot.is_planar()) return refuse("the robot moves out of the plane z = 0");
  PlanarChain chain;
  Vec3 tip = Vec3::Zero();
  int parent_link = 0;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    const Link& link = robot.links()[static_cast<std::size_t>(joint.child_link)];
    if (joint.parent_link != parent_link)
      return refuse("joint '" + joint.name + "' does not follow the link before");
    if (link.capsules.size() != 1 || !link.spheres.empty() || link.capsules[0].a.norm() > 1e-9) {
      return refuse("link '" + link.name + "' is not one capsule that starts at its joint");
    }
    const bool is_plain =
        joint.origin.rotation.isIdentity(1e-9) && joint.axis.isApprox(Vec3::UnitZ(), 1e-9);
    if (!is_plain || (joint.origin.translation - tip).norm() > 1e-9) {
      return refuse("joint '" + joint.name +
                    "' is not at the end of the link before, turning about +z");
    }
    tip = link.capsules[0].b;
    chain.lengths_.push_back(tip.norm());
    chain.bends_.push_back(std::atan2(tip.y(), tip.x()));
    chain.limits_.push_back({joint.lower, joint.upper});
    parent_link = joint.child_link;
  }
  return chain;
}

double PlanarChain::reach() const { return std::accumulate(lengths_.begin(), lengths_.end(), 0.0); }

void PlanarChain::points(std::span<const double> q, std::vector<Vec2>& result) const {
  result.resize(lengths_.size() + 1);
  result[0] = Vec2::Zero();
  double angle = 0;
  for (std::size_t i = 0; i < lengths_.size(); ++i) {
    angle += q[i];
    const double direction = angle + bends_[i];
    result[i + 1] = result[i] + lengths_[i] * Vec2(std::cos(direction), std::sin(direction));
  }
}

Configuration PlanarChain::joint_values(std::span<const double> directions) const {
  Configuration q;
  double before = 0;
  for (int link = 0; link < link_count(); ++link) {
    const double direction = directions[static_cast<std::size_t>(link)];
    q.push_back(joint_value(link, direction, before));
    before = direction;
  }
  return q;
}

double PlanarChain::joint_value(int link, double direction, double before) const {
  const double bend = bends_[static_cast<std::size_t>(link)];
  const double turn = (direction - bend) - (before - bend_before(link));
  const double value = turn - kTurn * std::nearbyint(turn / kTurn);
  for (const double turned : {value + kTurn, value - kTurn}) {
    if (!limits(link).contains(value) && limits(link).contains(turned)) return turned;
  }
  return value;
}

double PlanarChain::direction(int link, double value, double before) const {
  return before - bend_before(link) + value + bends_[static_cast<std::size_t>(link)];
}

GapSegment gap_segment(std::span<const double> key) {
  const Vec2 a(key[0], key[1]), b(key[3], key[4]);
  const Vec2 direction = (b - a).normalized();
  return {a + key[2] * direction, b - key[5] * direction};
}

bool do_segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 ab = b - a, cd = d - c;
  const double side_c = cross(ab, c - a), side_d = cross(ab, d - a);
  const double side_a = cross(cd, a - c), side_b = cross(cd, b - c);
  // Collinear segments are separated by their boxes only.
  return side_c * side_d <= 0 && side_a * side_b <= 0 && do_boxes_meet(a, b, c, d);
}

}  // namespace mneme::internal
