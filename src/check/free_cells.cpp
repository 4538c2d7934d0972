// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/free_cells.h"

#include "base/as_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace mneme::internal {
namespace {

/// Metres that points move within half a cell: smaller cells are more, larger ones prove less.
constexpr double kCellMotion = 1e-3;
/// Cells overlap by this fraction, so that rounding leaves no gap.
constexpr double kOverlap = 0.01;
constexpr std::int64_t kMostCells = 1 << 20;

}  // namespace

/// What a link can reach while it rolls about an axis: in slices along the axis, the largest
/// distance from it.
class RoundBody {
 public:
  /// `X`: pose of the link in a frame whose z axis is the axis.
  RoundBody(const ExactLink& link, const Transform& X);

  /// True if no part of `solid` is closer than `margin` metres; `X` is the pose of its tree. May be
  /// false for parts that are nearly so close.
  [[nodiscard]] bool is_clear_of(const SweptSolid& solid, const Transform& X, double margin) const;

  /// Middle of the axis, and the distance of the farthest point from the origin.
  [[nodiscard]] Vec3 middle() const { return {0, 0, 0.5 * (low_ + high_)}; }
  [[nodiscard]] double reach() const {
    return std::hypot(std::max(std::abs(low_), std::abs(high_)), std::ranges::max(radii_));
  }

 private:
  static constexpr int kSlices = 32;

  [[nodiscard]] double edge_of(int slice) const { return low_ + (high_ - low_) * slice / kSlices; }
  void add(const Capsule& edge);
  [[nodiscard]] bool is_beyond(double distance, double low, double high, double margin) const;
  [[nodiscard]] bool is_beyond(const Triangle& t, double margin, int splits) const;

  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
  std::array<double, kSlices> radii_{};
};

namespace {

/// The edges of a link's triangles, and the axes of its capsules. `X`: pose of the link.
std::vector<Capsule> edges_of(const ExactLink& link, const Transform& X) {
  std::vector<Capsule> edges;
  for (const Capsule& shape : link.shapes()) {
    edges.push_back({X * shape.a, X * shape.b, shape.radius});
  }
  for (const Mesh& surface : link.surfaces()) {
    const Transform X_surface = X * surface.pose;
    for (const Triangle& t : surface.parts->list()) {
      const std::array<Vec3, 3> corners = {X_surface * t.a, X_surface * t.b, X_surface * t.c};
      for (std::size_t i = 0; i < 3; ++i) {
        edges.push_back({corners[i], corners[(i + 1) % 3], surface.radius});
      }
    }
  }
  return edges;
}

/// Distance of a triangle from the z axis.
double distance_to_axis(const Triangle& t) {
  const std::array<Eigen::Vector2d, 3> corners = {t.a.head<2>(), t.b.head<2>(), t.c.head<2>()};
  double least = std::numeric_limits<double>::infinity();
  int left = 0, right = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d edge = corners[(i + 1) % 3] - a;
    const double length2 = edge.squaredNorm();
    const double share = length2 > 0 ? std::clamp(-a.dot(edge) / length2, 0.0, 1.0) : 0;
    least = std::min(least, (a + share * edge).norm());
    ++(edge.x() * a.y() - edge.y() * a.x() > 0 ? left : right);
  }
  return left == 3 || right == 3 ? 0 : least;
}

}  // namespace

RoundBody::RoundBody(const ExactLink& link, const Transform& X) {
  const std::vector<Capsule> edges = edges_of(link, X);
  for (const Capsule& edge : edges) {
    low_ = std::min({low_, edge.a.z() - edge.radius, edge.b.z() - edge.radius});
    high_ = std::max({high_, edge.a.z() + edge.radius, edge.b.z() + edge.radius});
  }
  for (const Capsule& edge : edges) add(edge);
}

/// A triangle is farthest from the axis at its edges, and a segment at its ends.
void RoundBody::add(const Capsule& edge) {
  const double rise = edge.b.z() - edge.a.z();
  for (int slice = 0; slice < kSlices; ++slice) {
    const double begin = edge_of(slice) - edge.radius, end = edge_of(slice + 1) + edge.radius;
    if (std::max(edge.a.z(), edge.b.z()) < begin || std::min(edge.a.z(), edge.b.z()) > end)
      continue;
    double from = 0, to = 1;
    if (rise != 0) {
      from = std::clamp((begin - edge.a.z()) / rise, 0.0, 1.0);
      to = std::clamp((end - edge.a.z()) / rise, 0.0, 1.0);
    }
    const auto radius_at = [&](double t) {
      return (edge.a + t * (edge.b - edge.a)).head<2>().norm();
    };
    double& radius = radii_[as_index(slice)];
    radius = std::max(radius, std::max(radius_at(from), radius_at(to)) + edge.radius);
  }
}

/// True for points from `low` to `high` along the axis and `distance` metres or more away from it.
bool RoundBody::is_beyond(double distance, double low, double high, double margin) const {
  for (int slice = 0; slice < kSlices; ++slice) {
    const double beside = std::max({0.0, edge_of(slice) - high, low - edge_of(slice + 1)});
    const double beyond = std::max(0.0, distance - radii_[as_index(slice)]);
    if (beside * beside + beyond * beyond < margin * margin) return false;
  }
  return true;
}

bool RoundBody::is_beyond(const Triangle& t, double margin, int splits) const {
  const auto [low, high] = std::minmax({t.a.z(), t.b.z(), t.c.z()});
  const double distance = distance_to_axis(t);
  if (is_beyond(distance, low, high, margin)) return true;
  if (splits == 0 || !is_beyond(std::max(t.a.head<2>().norm(), 0.0), t.a.z(), t.a.z(), margin)) {
    return false;
  }
  const Vec3 ab = 0.5 * (t.a + t.b), bc = 0.5 * (t.b + t.c), ca = 0.5 * (t.c + t.a);
  return is_beyond({ab, bc, ca}, margin, splits - 1) &&
         is_beyond({t.a, ab, ca}, margin, splits - 1) &&
         is_beyond({ab, t.b, bc}, margin, splits - 1) &&
         is_beyond({ca, bc, t.c}, margin, splits - 1);
}

bool RoundBody::is_clear_of(const SweptSolid& solid, const Transform& X, double margin) const {
  constexpr int kMostSplits = 3;
  const double reach = margin + solid.radius();
  const Eigen::Matrix3d extent = X.rotation.cwiseAbs();
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const BoxTree::Node& node = solid.tree().nodes()[as_index(index)];
    const Vec3 center = X * Vec3(0.5 * (node.box.low + node.box.high));
    const Vec3 half = extent * (0.5 * (node.box.high - node.box.low));
    const double distance = center.head<2>().norm() - half.head<2>().norm();
    if (is_beyond(distance, center.z() - half.z(), center.z() + half.z(), reach)) continue;
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int part = solid.tree().order()[as_index(i)];
      const Triangle& t = solid.triangle(part);
      if (!is_beyond({X * t.a, X * t.b, X * t.c}, reach + solid.own_radius(part), kMostSplits)) {
        return false;
      }
    }
    if (node.right >= 0) open.insert(open.end(), {index + 1, node.right});
  }
  return true;
}

namespace {

/// The only joint that moves these steps of a chain, if there is one.
std::optional<int> only_joint(std::span<const JointChain::Step> steps) {
  if (steps.empty()) return std::nullopt;
  const auto is_first = [&](const auto& step) { return step.joint == steps.front().joint; };
  return std::ranges::all_of(steps, is_first) ? std::optional(steps.front().joint) : std::nullopt;
}

/// Cells of the chain from `a` to `b` without its last joint, about which `b` rolls.
std::shared_ptr<const FreeCells> make_rolled(const Robot& robot, const LinkDistances& links, int a,
                                             int b) {
  JointChain chain(robot, a, b);
  const auto steps = chain.steps();
  if (steps.size() < 2 || steps.back().is_prismatic) return nullptr;
  const auto joint = only_joint(steps.first(steps.size() - 1));
  if (!joint || *joint == steps.back().joint) return nullptr;
  auto round = std::make_shared<const RoundBody>(links.exact(b), chain.last());
  SolidPair pair(std::move(chain), links.exact(a), links.exact(b));
  return std::make_shared<FreeCells>(robot, std::move(pair), *joint, std::move(round));
}

/// Metres from the body's origin that no point of the solids exceeds.
double reach_of(std::span<const SweptSolid> solids) {
  double reach = 0;
  for (const SweptSolid& solid : solids) {
    const AxisBox& box = solid.tree().nodes().front().box;
    const double corner = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).norm();
    reach = std::max(reach, solid.pose().translation.norm() + corner + solid.radius());
  }
  return reach;
}

/// Metres per unit of the joint that points of one body move against the other, at most.
double speed_of(const SolidPair& pair, double other_reach, int joint, int joint_count) {
  std::vector<float> from(as_index(joint_count)), delta(as_index(joint_count));
  delta[as_index(joint)] = 1;
  const ChainMotion motion(pair.chain, from, delta);
  const auto most = [](const MotionBound& bound, double reach) {
    return bound.speed + reach * bound.speed_by_reach;
  };
  return std::min(most(motion.of_a, reach_of(pair.solids)), most(motion.of_b, other_reach));
}

}  // namespace

std::vector<std::shared_ptr<const FreeCells>> FreeCells::make(const Robot& robot,
                                                              const LinkDistances& links, int first,
                                                              int second) {
  JointChain chain(robot, first, second);
  if (const auto joint = only_joint(chain.steps())) {
    SolidPair pair(std::move(chain), links.exact(first), links.exact(second));
    return {std::make_shared<FreeCells>(robot, std::move(pair), *joint)};
  }
  std::vector<std::shared_ptr<const FreeCells>> cells = {make_rolled(robot, links, first, second),
                                                         make_rolled(robot, links, second, first)};
  std::erase(cells, nullptr);
  return cells;
}

FreeCells::FreeCells(const Robot& robot, SolidPair pair, int joint,
                     std::shared_ptr<const RoundBody> round)
    : pair_(std::move(pair)),
      round_(std::move(round)),
      joint_(joint),
      joint_count_(robot.joint_count()) {
  const Joint& moved = robot.group_joint(joint);
  wraps_ = moved.type == JointType::continuous;
  const double range = wraps_ ? 2 * std::numbers::pi : moved.upper - moved.lower;
  // The reach of a round body is from the axis' origin, which may be another one than the link's.
  const double reach = round_ == nullptr ? reach_of(pair_.others)
                                         : round_->reach() + pair_.chain.last().translation.norm();
  size_ = 2 * kCellMotion / speed_of(pair_, reach, joint, joint_count_);
  count_ = static_cast<std::int64_t>(std::clamp(std::ceil(range / size_), 1.0, double{kMostCells}));
  if (wraps_) size_ = range / static_cast<double>(count_);
  lower_ = moved.lower;
  if (!wraps_) {
    // A cell more at each end: rounded limits, and starts barely beyond them.
    lower_ -= size_;
    count_ += 2;
  }
  cells_ = std::make_unique<std::atomic<Cell>[]>(static_cast<std::size_t>(count_));
}

std::optional<MotionShare> FreeCells::unproven(std::span<const float> from,
                                               std::span<const float> delta,
                                               MotionShare share) const {
  const double begin = from[as_index(joint_)];
  const double change = delta.empty() ? 0 : delta[as_index(joint_)];
  const auto cell_at = [&](double at) {
    return static_cast<std::int64_t>(std::floor((begin + at * change - lower_) / size_));
  };
  const std::int64_t last = cell_at(share.last), step = change < 0 ? -1 : 1;
  std::optional<std::int64_t> first_unproven;
  std::int64_t last_unproven = 0;
  for (std::int64_t cell = cell_at(share.first);; cell += step) {
    if (!is_free(cell)) {
      if (!first_unproven) first_unproven = cell;
      last_unproven = cell;
    }
    if (cell == last) break;
  }
  if (!first_unproven) return std::nullopt;
  if (change == 0) return share;
  const auto share_at = [&](std::int64_t edge) {
    const double at = (lower_ + static_cast<double>(edge) * size_ - begin) / change;
    return std::clamp(at, share.first, share.last);
  };
  return MotionShare{share_at(*first_unproven + (step < 0 ? 1 : 0)),
                     share_at(last_unproven + (step < 0 ? 0 : 1))};
}

bool FreeCells::is_free(std::int64_t index) const {
  if (wraps_) index = (index % count_ + count_) % count_;
  if (index < 0 || index >= count_) return false;
  std::atomic<Cell>& cell = cells_[static_cast<std::size_t>(index)];
  Cell known = cell.load(std::memory_order_relaxed);
  if (known == Cell::unknown) {
    known = prove(index) ? Cell::free : Cell::unproven;
    cell.store(known, std::memory_order_relaxed);
  }
  return known == Cell::free;
}

bool FreeCells::prove(std::int64_t index) const {
  std::vector<float> middle(as_index(joint_count_));
  middle[as_index(joint_)] =
      static_cast<float>(lower_ + (static_cast<double>(index) + 0.5) * size_);
  ChainMotion state(pair_.chain, middle, {});
  const double margin = (1 + kOverlap) * kCellMotion + kCellSpare;
  if (round_ == nullptr) return pair_.stays_apart(state, margin);
  // The frame of the roll joint, at any of its values, from that of the first link.
  const Transform X_AxisA = pair_.chain.last() * state.interval(0).pose.X_AB.inverse();
  for (const SweptSolid& solid : pair_.solids) {
    if (!round_->is_clear_of(solid, X_AxisA * solid.pose(), margin)) return false;
  }
  return !pair_.link.may_enclose(Sphere{X_AxisA.inverse() * round_->middle(), 0});
}

const FreeCellsOfPairs::Cells& FreeCellsOfPairs::of(const Robot& robot, const LinkDistances& links,
                                                    int first, int second) {
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = cells_.try_emplace({first, second});
  if (is_new) entry->second = FreeCells::make(robot, links, first, second);
  return entry->second;
}

}  // namespace mneme::internal
