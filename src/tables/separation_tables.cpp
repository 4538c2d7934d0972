// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "tables/joint_reach.h"
#include "tables/make_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

/// Cells of each joint, by the number of joints.
constexpr std::array<int, kMostJointsBetween> kCells = {256, 64};
/// Times that a cell is halved before it counts as touching, by the number of joints.
constexpr std::array<int, kMostJointsBetween> kHalvings = {2, 4};
/// Distances computed for a table; cells that are left then count as touching.
constexpr int kMostDistances = 400000;
/// Errors of a cell's bounds in single precision: radians for values up to 1e4, and relative.
constexpr double kPeriodicRounding = 2e-3, kRelativeRounding = 1e-6;
/// Bodies with more pairs of groups get no table: it would take too long.
constexpr std::size_t kMostGroupPairs = 1000;
constexpr double kLeastWidth = 1e-6;
/// Two groups are replaced by their shapes in boxes that change their distance by less than this
/// share of their radii.
constexpr double kExpandShare = 0.5;

/// Two shapes, or the balls around two groups.
struct NearPair {
  Capsule a, b;
  JointValues speeds = {};         ///< bounds on the change of their distance, metres per unit
  int group_a = -1, group_b = -1;  ///< of balls
};

/// Cells `begin` to `end` of both axes.
struct CellBox {
  std::array<int, kMostJointsBetween> begin = {}, end = {};

  [[nodiscard]] bool is_cell() const { return end[0] - begin[0] == 1 && end[1] - begin[1] == 1; }
};

Vec3 to_vector(const float* v) { return {v[0], v[1], v[2]}; }
Capsule to_capsule(const Ball& ball) {
  return {to_vector(ball.center), to_vector(ball.center), ball.radius};
}

std::vector<Capsule> shapes_of(const RobotTables& tables, const GroupRow& group) {
  if (group.is_capsule) {
    const CapsuleRow& row = tables.capsules[as_index(group.begin)];
    return {{to_vector(row.a), to_vector(row.a) + to_vector(row.along), row.radius}};
  }
  std::vector<Capsule> shapes;
  for (int i = group.begin; i < group.begin + kGroupSize; ++i) {
    shapes.push_back(to_capsule(tables.spheres[as_index(i)]));
  }
  return shapes;
}

double gap_of(const Transform& X_AB, const NearPair& pair) {
  const double radii = pair.a.radius + pair.b.radius;
  if (pair.a.a == pair.a.b && pair.b.a == pair.b.b)
    return (pair.a.a - X_AB * pair.b.a).norm() - radii;
  return segment_distance(pair.a.a, pair.a.b, X_AB * pair.b.a, X_AB * pair.b.b) - radii;
}

double change_in(const JointBox& box, const NearPair& pair) {
  double change = 0;
  for (std::size_t i = 0; i < kMostJointsBetween; ++i) change += box.half[i] * pair.speeds[i];
  return change;
}

/// Fills a separation table by branch and bound: boxes of cells are halved until bounds on the
/// change of distances decide them.
class SeparationTableMaker {
 public:
  SeparationTableMaker(const RobotTables& tables, const Linkage& linkage)
      : tables_(tables), linkage_(linkage), count_(linkage.joints().size()) {
    for (std::size_t i = 0; i < count_; ++i) set_axis(i, linkage.joints()[i]);
    rings_.resize(as_index(cells(0) * cells(1)));
  }

  /// Empty if nothing is proven.
  std::optional<SeparationTable> make(const BodyPairRow& pair) {
    std::vector<NearPair> all;
    for (int i = pair.begin; i < pair.end; ++i) {
      const GroupPairRow& row = tables_.group_pairs[as_index(i)];
      for (int k = row.second_begin; k < row.second_end; ++k) all.push_back(pair_of(row.first, k));
      if (all.size() > kMostGroupPairs) return std::nullopt;
    }
    decide({{0, 0}, {cells(0), cells(1)}}, all);
    if (std::ranges::count(rings_, 0) == std::ssize(rings_)) return std::nullopt;
    for (int ring = 1; ring < SeparationTable::kMostRings; ++ring) add_ring(ring);
    pack();
    return std::move(table_);
  }

 private:
  [[nodiscard]] int cells(std::size_t axis) const { return table_.axes[axis].cells; }

  void set_axis(std::size_t i, const Linkage::MovingJoint& joint) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const auto [lower, upper] = joint.limits;
    SeparationTable::Axis& axis = table_.axes[i];
    axis.joint = joint.index;
    axis.cells = kCells[count_ - 1];
    axis.has_period = joint.has_period && upper - lower > kTurn - 1e-6;
    width_[i] = axis.has_period ? kTurn / axis.cells
                                : std::max((upper - lower) / (axis.cells - 2), kLeastWidth);
    low_[i] = axis.has_period ? lower : lower - width_[i];
    axis.scale = static_cast<float>(1 / width_[i]);
    axis.offset = static_cast<float>(-low_[i] / width_[i]);
  }

  [[nodiscard]] NearPair make_pair(const Capsule& a, const Capsule& b) const {
    const std::array<Sphere, 2> ends_a = {{{a.a, 0}, {a.b, 0}}}, ends_b = {{{b.a, 0}, {b.b, 0}}};
    return {a, b, linkage_.find_speeds(ends_a, ends_b)};
  }
  [[nodiscard]] NearPair pair_of(int group_a, int group_b) const {
    NearPair pair = make_pair(to_capsule(tables_.groups[as_index(group_a)].ball),
                              to_capsule(tables_.groups[as_index(group_b)].ball));
    pair.group_a = group_a;
    pair.group_b = group_b;
    return pair;
  }

  [[nodiscard]] JointBox box_of(const CellBox& cells) const {
    JointBox box;
    for (std::size_t i = 0; i < count_; ++i) {
      double begin = low_[i] + cells.begin[i] * width_[i];
      double end = low_[i] + cells.end[i] * width_[i];
      if (!table_.axes[i].has_period) {
        const auto [lower, upper] = linkage_.joints()[i].limits;
        begin = std::clamp(begin, lower, upper);
        end = std::clamp(end, lower, upper);
      }
      const double rounding = table_.axes[i].has_period
                                  ? kPeriodicRounding
                                  : kRelativeRounding * (1 + std::abs(begin) + std::abs(end));
      box.middle[i] = 0.5 * (begin + end);
      box.half[i] = 0.5 * (end - begin) + rounding;
    }
    return box;
  }

  /// State of the pairs in a box.
  enum class Verdict { apart, touching, open };

  /// Writes the pairs that may be close somewhere in the box to `left`.
  Verdict look(const JointBox& box, const std::vector<NearPair>& pairs,
               std::vector<NearPair>& left) {
    const Transform X_AB = linkage_.pose_at(box.middle);
    distances_ += static_cast<int>(pairs.size());
    for (const NearPair& pair : pairs) {
      const double apart = gap_of(X_AB, pair) - SeparationTable::kApart - kKernelRounding;
      const double change = change_in(box, pair);
      if (apart >= change) continue;
      if (pair.group_a < 0) {
        if (apart < -change) return Verdict::touching;
        left.push_back(pair);
      } else if (change > kExpandShare * (pair.a.radius + pair.b.radius)) {
        left.push_back(pair);
      } else {
        for (const Capsule& a : shapes_of(tables_, tables_.groups[as_index(pair.group_a)])) {
          for (const Capsule& b : shapes_of(tables_, tables_.groups[as_index(pair.group_b)])) {
            left.push_back(make_pair(a, b));
          }
        }
      }
    }
    return left.empty() ? Verdict::apart : Verdict::open;
  }

  /// The joint that changes distances most in the box.
  [[nodiscard]] std::size_t widest(const JointBox& box, const std::vector<NearPair>& pairs,
                                   const CellBox* cells) const {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < count_; ++i) {
      if (cells != nullptr && cells->end[i] - cells->begin[i] == 1) continue;
      const double change = box.half[i] * pairs.front().speeds[i];
      if (change > most) best = i;
      most = std::max(most, change);
    }
    return best;
  }

  void decide(const CellBox& cells, const std::vector<NearPair>& pairs) {
    if (distances_ > kMostDistances) return;
    const JointBox box = box_of(cells);
    std::vector<NearPair> left;
    const Verdict verdict = look(box, pairs, left);
    bool is_apart = verdict == Verdict::apart;
    if (verdict == Verdict::open) {
      if (!cells.is_cell()) return halve(cells, widest(box, left, &cells), left);
      is_apart = is_apart_in(box, left, kHalvings[count_ - 1]);
    }
    if (is_apart) fill(cells);
  }

  void halve(CellBox cells, std::size_t axis, const std::vector<NearPair>& pairs) {
    CellBox upper = cells;
    upper.begin[axis] = cells.end[axis] = (cells.begin[axis] + cells.end[axis]) / 2;
    decide(cells, pairs);
    decide(upper, pairs);
  }

  /// True if all pairs are apart throughout the box.
  bool is_apart_in(const JointBox& box, const std::vector<NearPair>& pairs, int halvings) {
    if (halvings == 0) return false;
    const std::size_t axis = widest(box, pairs, nullptr);
    JointBox part = box;
    part.half[axis] /= 2;
    for (const double side : {-1.0, 1.0}) {
      part.middle[axis] = box.middle[axis] + side * part.half[axis];
      std::vector<NearPair> left;
      const Verdict verdict = look(part, pairs, left);
      if (verdict == Verdict::touching) return false;
      if (verdict == Verdict::open && !is_apart_in(part, left, halvings - 1)) return false;
    }
    return true;
  }

  /// Cells beyond the limits stay 0.
  void fill(CellBox cells) {
    for (std::size_t i = 0; i < count_; ++i) {
      if (table_.axes[i].has_period) continue;
      cells.begin[i] = std::max(cells.begin[i], 1);
      cells.end[i] = std::min(cells.end[i], this->cells(i) - 1);
    }
    for (int i = cells.begin[0]; i < cells.end[0]; ++i) {
      const auto row = rings_.begin() + i * this->cells(1);
      std::fill(row + cells.begin[1], row + cells.end[1], std::uint8_t{1});
    }
  }

  /// Raises cells of value `ring` that no smaller one adjoins.
  void add_ring(std::uint8_t ring) {
    std::vector<std::uint8_t> least = rings_;
    erode(least, as_index(cells(1)), 1);
    erode(least, as_index(cells(0)), as_index(cells(1)));
    for (std::size_t i = 0; i < rings_.size(); ++i) rings_[i] += least[i] == ring ? 1 : 0;
  }

  /// The least of each cell and its two neighbours along an axis. Without a period the cells at its
  /// ends are 0, so that it may as well have one.
  static void erode(std::vector<std::uint8_t>& values, std::size_t cells, std::size_t stride) {
    const std::vector<std::uint8_t> old = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t cell = i / stride % cells, line = i - cell * stride;
      const std::size_t before = line + (cell + cells - 1) % cells * stride;
      const std::size_t after = line + (cell + 1) % cells * stride;
      values[i] = std::min({old[before], old[i], old[after]});
    }
  }

  void pack() {
    table_.rings.resize((rings_.size() + SeparationTable::kCellsPerWord - 1) /
                        SeparationTable::kCellsPerWord);
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      const auto shift = i % SeparationTable::kCellsPerWord * SeparationTable::kBits;
      table_.rings[i / SeparationTable::kCellsPerWord] |= std::uint32_t{rings_[i]} << shift;
    }
  }

  const RobotTables& tables_;
  const Linkage& linkage_;
  std::size_t count_;
  std::array<double, kMostJointsBetween> low_ = {}, width_ = {};
  int distances_ = 0;
  std::vector<std::uint8_t> rings_;
  SeparationTable table_;
};

bool can_have_table(std::span<const Linkage::MovingJoint> joints) {
  return !joints.empty() && joints.size() <= kMostJointsBetween &&
         std::ranges::all_of(joints, [](const Linkage::MovingJoint& joint) {
           return std::isfinite(joint.limits.first) && std::isfinite(joint.limits.second);
         });
}

}  // namespace

void add_separation_tables(const Robot& robot, RobotTables& tables) {
  std::vector<SeparationTable> made;
  for (BodyPairRow& pair : tables.body_pairs) {
    const Linkage linkage(robot, tables, tables.bodies[as_index(pair.first)].frame,
                          tables.bodies[as_index(pair.second)].frame);
    if (!can_have_table(linkage.joints())) continue;
    auto table = SeparationTableMaker(tables, linkage).make(pair);
    if (!table) continue;
    pair.separation_table = static_cast<int>(made.size());
    made.push_back(std::move(*table));
  }
  if (!made.empty()) {
    tables.separation_tables =
        std::make_shared<const std::vector<SeparationTable>>(std::move(made));
  }
}

}  // namespace mneme::internal
