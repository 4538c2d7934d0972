// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/free_cells.h"

#include "base/as_index.h"
#include "base/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mneme::internal {
namespace {

/// Metres that points move within half of a smallest cell, unless kMostBits limits the number of
/// cells: smaller cells prove more, and take longer.
constexpr double kCellMotion = 1e-3;
/// Cells overlap by this share of a smallest one, so that rounding leaves no gap.
constexpr double kOverlap = 0.02;
/// The largest cells are 2^kTopBits for each joint, the smallest at most 2^kMostBits: of one joint,
/// or of two.
constexpr int kTopBits = 2;
constexpr std::array<int, 2> kMostBits = {8, 7};
/// Changes with what proofs decide, so that older ones in the cache are not found.
constexpr double kCellVersion = 1;
/// The character of the first verdict in the cache.
constexpr char kFirstVerdict = '0';

using Step = JointChain::Step;

/// The joints that move these steps of a chain, if each is in one place of it.
std::vector<int> joints_of(std::span<const Step> steps) {
  std::vector<int> joints;
  for (const Step& step : steps) {
    if (!joints.empty() && joints.back() == step.joint) continue;
    if (std::ranges::count(joints, step.joint) > 0) return {};
    joints.push_back(step.joint);
  }
  return joints;
}

/// Speeds of points of a body that a step moves. `X`: pose of the body in the step's frame.
PointSpeeds speeds_by(const Step& step, const Transform& X) {
  return {X, std::abs(step.rate), step.is_prismatic};
}

/// Cells of the chain from `a` to `b` without its last joint, about which `b` rolls.
std::shared_ptr<const FreeCells> make_rolled(const Robot& robot, const LinkDistances& links, int a,
                                             int b) {
  JointChain chain(robot, a, b);
  const auto steps = chain.steps();
  if (steps.size() < 2 || steps.size() > 3 || steps.back().is_prismatic) return nullptr;
  std::vector<int> joints = joints_of(steps);
  if (joints.size() != steps.size()) return nullptr;
  joints.pop_back();
  auto round = std::make_shared<const RoundBody>(links.exact(b), chain.last());
  SolidPair pair(std::move(chain), links.exact(a), links.exact(b));
  return std::make_shared<FreeCells>(robot, std::move(pair), joints, std::move(round));
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
double speed_of(const SolidPair& pair, int joint, int joint_count) {
  std::vector<float> from(as_index(joint_count)), delta(as_index(joint_count));
  delta[as_index(joint)] = 1;
  const ChainMotion motion(pair.chain, from, delta);
  const auto most = [](const MotionBound& bound, double reach) {
    return bound.speed + reach * bound.speed_by_reach;
  };
  return std::min(most(motion.of_a, reach_of(pair.solids)),
                  most(motion.of_b, reach_of(pair.others)));
}

/// Metres per unit of a step's joint that points of a link move at most.
double speed_of(const ExactLink& link, const PointSpeeds& speeds) {
  return speeds.rate * (speeds.is_prismatic ? 1 : radius_about_axis(link, speeds.X_AxisBody));
}

}  // namespace

std::vector<std::shared_ptr<const FreeCells>> FreeCells::make(const Robot& robot,
                                                              const LinkDistances& links, int first,
                                                              int second) {
  std::vector<std::shared_ptr<const FreeCells>> cells = {make_rolled(robot, links, first, second),
                                                         make_rolled(robot, links, second, first)};
  std::erase(cells, nullptr);
  JointChain chain(robot, first, second);
  const std::vector<int> joints = joints_of(chain.steps());
  if (joints.size() == 1 || (joints.size() == 2 && chain.steps().size() == 2)) {
    SolidPair pair(std::move(chain), links.exact(first), links.exact(second));
    cells.push_back(std::make_shared<FreeCells>(robot, std::move(pair), joints));
  }
  return cells;
}

FreeCells::FreeCells(const Robot& robot, SolidPair pair, const std::vector<int>& joints,
                     std::shared_ptr<const RoundBody> round)
    : pair_(std::move(pair)), round_(std::move(round)), joint_count_(robot.joint_count()) {
  const auto steps = pair_.chain.steps();
  speeds_ = speeds_by(steps[0], steps[0].mount.inverse());
  const int most_bits = kMostBits[joints.size() - 1];
  if (joints.size() == 1) {
    const double speed =
        round_ ? speed_of(pair_.link, speeds_) : speed_of(pair_, joints[0], joint_count_);
    add_axis(robot, joints[0], speed, most_bits);
  } else {
    add_axis(robot, joints[0], speed_of(pair_.link, speeds_), most_bits);
    const PointSpeeds second = speeds_by(steps[1], round_ ? steps[2].mount : pair_.chain.last());
    const double reach = round_ ? round_->reach_about(second.X_AxisBody) : 0;
    const double speed =
        round_ ? second.rate * (second.is_prismatic ? 1 : reach) : speed_of(*pair_.other, second);
    add_axis(robot, joints[1], speed, most_bits);
  }
  const int levels = 1 + std::ranges::max(axes_, {}, &Axis::bits).bits;
  top_ = std::max(0, levels - 1 - kTopBits);
  for (int level = 0; level <= top_; ++level) {
    of_levels_.push_back(count_);
    int bits = 0;
    for (const Axis& axis : axes_) bits += std::max(0, axis.bits - level);
    count_ += std::size_t{1} << bits;
  }
  verdicts_ = std::make_unique<std::atomic<Verdict>[]>(count_);
}

void FreeCells::add_axis(const Robot& robot, int index, double speed, int most_bits) {
  const Joint& joint = robot.group_joint(index);
  Axis axis{.joint = index, .wraps = joint.type == JointType::continuous, .speed = speed};
  const double range = axis.wraps ? 2 * std::numbers::pi : joint.upper - joint.lower;
  const double wanted = std::max(1.0, range * speed / (2 * kCellMotion));
  axis.bits = std::clamp(static_cast<int>(std::ceil(std::log2(wanted))), kTopBits, most_bits);
  const double cells = std::ldexp(1, axis.bits);
  axis.size = range / cells;
  axis.lower = joint.lower;
  if (!axis.wraps) {
    // A cell more at each end: rounded limits, and starts barely beyond them.
    constexpr double kLeastSize = 1e-4;
    axis.size = std::max(range / (cells - 2), kLeastSize);
    axis.lower -= axis.size;
  }
  axes_.push_back(axis);
}

FreeCells::Cell FreeCells::cell_at(std::span<const float> from, std::span<const float> delta,
                                   double share) const {
  Cell cell = {};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    double value = from[as_index(axis.joint)];
    if (!delta.empty()) value += share * delta[as_index(axis.joint)];
    cell[i] = static_cast<std::int64_t>(std::floor((value - axis.lower) / axis.size));
  }
  return cell;
}

bool FreeCells::is_in_range(const Cell& cell) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!axes_[i].wraps && (cell[i] < 0 || cell[i] >> axes_[i].bits != 0)) return false;
  }
  return true;
}

double FreeCells::end_of(const Cell& cell, int level, std::span<const float> from,
                         std::span<const float> delta) const {
  // Into the next cell, but not beyond the overlap.
  constexpr double kStep = 0.5 * kOverlap;
  double end = std::numeric_limits<double>::infinity(), step = end;
  for (std::size_t i = 0; i < axes_.size() && !delta.empty(); ++i) {
    const Axis& axis = axes_[i];
    const double begin = from[as_index(axis.joint)], change = delta[as_index(axis.joint)];
    if (change == 0) continue;
    const int bits = std::min(level, axis.bits);
    const std::int64_t edge = ((cell[i] >> bits) + (change > 0 ? 1 : 0)) << bits;
    end = std::min(end, (axis.lower + static_cast<double>(edge) * axis.size - begin) / change);
    step = std::min(step, kStep * axis.size / std::abs(change));
  }
  return end + step;
}

std::optional<MotionShare> FreeCells::unproven(std::span<const float> from,
                                               std::span<const float> delta,
                                               MotionShare share) const {
  std::optional<MotionShare> open;
  for (double at = share.first;;) {
    const Cell cell = cell_at(from, delta, at);
    if (!is_in_range(cell)) return MotionShare{open ? open->first : at, share.last};
    const int level = free_level(cell);
    const double end = std::min(share.last, end_of(cell, std::max(level, 0), from, delta));
    if (level < 0) open = {open ? open->first : at, end};
    if (!(end > at) || end >= share.last) return open;
    at = end;
  }
}

int FreeCells::free_level(const Cell& cell) const {
  for (int level = top_; level >= 0; --level) {
    std::atomic<Verdict>& verdict = verdicts_[index_of(cell, level)];
    Verdict known = verdict.load(std::memory_order_relaxed);
    if (known == Verdict::unknown) {
      known = prove(ranges_of(cell, level)) ? Verdict::free : Verdict::unproven;
      verdict.store(known, std::memory_order_relaxed);
    }
    if (known == Verdict::free) return level;
  }
  return -1;
}

std::size_t FreeCells::index_of(const Cell& cell, int level) const {
  std::size_t index = 0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int bits = std::max(0, axes_[i].bits - level);
    const auto number = static_cast<std::size_t>(cell[i] >> std::min(level, axes_[i].bits));
    index = (index << bits) | (number & ((std::size_t{1} << bits) - 1));
  }
  return of_levels_[as_index(level)] + index;
}

FreeCells::Ranges FreeCells::ranges_of(const Cell& cell, int level) const {
  Ranges ranges;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    const int bits = std::min(level, axis.bits);
    const std::int64_t turn = (std::int64_t{1} << axis.bits) - 1;
    const std::int64_t first = ((cell[i] & turn) >> bits) << bits;
    const double half = std::ldexp(0.5, bits);
    ranges.middle[i] = axis.lower + (static_cast<double>(first) + half) * axis.size;
    ranges.half[i] = (half + kOverlap) * axis.size;
  }
  return ranges;
}

/// Within the cell, the first joint moves one link and the second joint the other one, seen from
/// the body between both joints.
bool FreeCells::prove(const Ranges& cell) const {
  if (round_) return prove_round(cell);
  std::size_t swept = 0;
  double margin = kCellSpare;
  if (axes_.size() == 2) {
    const double first = cell.half[0] * axes_[0].speed, second = cell.half[1] * axes_[1].speed;
    if (second > first) swept = 1;
    margin += std::min(first, second);
  }
  std::vector<float> from(as_index(joint_count_)), delta(as_index(joint_count_));
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    from[as_index(axes_[i].joint)] = static_cast<float>(cell.middle[i]);
  }
  const std::size_t joint = as_index(axes_[swept].joint);
  from[joint] = static_cast<float>(cell.middle[swept] - cell.half[swept]);
  delta[joint] = static_cast<float>(2 * cell.half[swept]);
  ChainMotion motion(pair_.chain, from, delta);
  return pair_.stays_apart_as_whole(motion, margin);
}

bool FreeCells::prove_round(const Ranges& cell) const {
  std::vector<float> middle(as_index(joint_count_));
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    middle[as_index(axes_[i].joint)] = static_cast<float>(cell.middle[i]);
  }
  const ChainMotion state(pair_.chain, middle, {});
  PointMargin margin{kCellSpare, speeds_, cell.half[0]};
  if (axes_.size() == 2) margin.least += cell.half[1] * axes_[1].speed;
  // The frame of the roll joint, at any of its values, from that of the first link.
  const Transform X_AxisA = pair_.chain.last() * state.interval(0).pose.X_AB.inverse();
  for (const SweptSolid& solid : pair_.solids) {
    if (!round_->is_clear_of(solid, X_AxisA, margin)) return false;
  }
  return !pair_.link.may_enclose(Sphere{X_AxisA.inverse() * round_->middle(), 0});
}

void FreeCells::prove_all(const ContentCache& cache) const {
  const std::string key = this->key();
  std::string text = cache.find(key).value_or("");
  if (text.size() == count_) {
    for (std::size_t i = 0; i < count_; ++i) {
      const int verdict = text[i] - kFirstVerdict;
      const bool is_one = verdict >= 0 && verdict <= static_cast<int>(Verdict::unproven);
      if (is_one) verdicts_[i] = static_cast<Verdict>(verdict);
    }
    return;
  }
  const std::int64_t rows = axes_.size() == 2 ? std::int64_t{1} << axes_[1].bits : 1;
  for (std::int64_t i = 0; i < std::int64_t{1} << axes_[0].bits; ++i) {
    poll_interrupt();
    for (std::int64_t k = 0; k < rows; ++k) static_cast<void>(free_level({i, k}));
  }
  text.clear();
  for (std::size_t i = 0; i < count_; ++i) {
    text += static_cast<char>(kFirstVerdict + static_cast<int>(verdicts_[i].load()));
  }
  // Without a cache the proofs are made anew by the next program.
  static_cast<void>(cache.store(key, text));
}

namespace {

void add(std::vector<double>& numbers, const Vec3& v) {
  numbers.insert(numbers.end(), v.begin(), v.end());
}

void add(std::vector<double>& numbers, const Transform& X) {
  for (int axis = 0; axis < 3; ++axis) add(numbers, Vec3(X.rotation.col(axis)));
  add(numbers, X.translation);
}

void add(std::vector<double>& numbers, const ExactLink& link) {
  for (const Capsule& shape : link.shapes()) {
    add(numbers, shape.a);
    add(numbers, shape.b);
    numbers.push_back(shape.radius);
  }
  for (const Mesh& surface : link.surfaces()) {
    numbers.push_back(static_cast<double>(surface.parts->list().size()));
    numbers.push_back(surface.radius);
    add(numbers, surface.pose);
    for (const Triangle& t : surface.parts->list()) {
      for (const Vec3& corner : {t.a, t.b, t.c}) add(numbers, corner);
    }
  }
  numbers.push_back(static_cast<double>(link.shapes().size()));
}

}  // namespace

std::string FreeCells::key() const {
  std::vector<double> numbers = {kCellVersion, kCellSpare, kOverlap, round_ ? 1.0 : 0.0};
  for (const Step& step : pair_.chain.steps()) {
    add(numbers, step.mount);
    numbers.insert(numbers.end(), {step.is_prismatic ? 1.0 : 0.0, step.rate, step.offset});
  }
  add(numbers, pair_.chain.last());
  for (const Axis& axis : axes_) {
    numbers.insert(numbers.end(), {axis.wraps ? 1.0 : 0.0, axis.lower, axis.size,
                                   static_cast<double>(axis.bits), axis.speed});
  }
  add(numbers, pair_.link);
  add(numbers, *pair_.other);
  return ContentCache::hash_of(
      {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

const FreeCellsOfPairs::Cells& FreeCellsOfPairs::of(const Robot& robot, const LinkDistances& links,
                                                    int first, int second) {
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = cells_.try_emplace({first, second});
  if (is_new) entry->second = FreeCells::make(robot, links, first, second);
  return entry->second;
}

}  // namespace mneme::internal
