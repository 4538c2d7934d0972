// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one joint per lane.
#include "trajectory/barrier_kernel.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trajectory/barrier_kernel.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

using DTag = hn::ScalableTag<double>;
using D = hn::Vec<DTag>;

inline constexpr size_t kDoubles = HWY_LANES(double);
static_assert(kJointLanes % kDoubles == 0);

HWY_INLINE D all(double x) { return hn::Set(DTag(), x); }
HWY_INLINE D zero() { return hn::Zero(DTag()); }
HWY_INLINE D load(const double* p) { return hn::LoadU(DTag(), p); }
HWY_INLINE void store(D x, double* p) { hn::StoreU(x, DTag(), p); }
HWY_INLINE double sum_of(D x) { return hn::GetLane(hn::SumOfLanes(DTag(), x)); }
HWY_INLINE double most_of(D x) { return hn::GetLane(hn::MaxOfLanes(DTag(), x)); }

/// Differences of first to third order of a sequence, which begins with equal values.
class Differences {
 public:
  HWY_INLINE explicit Differences(D first) : last_(first) { first_ = next_ = second_ = zero(); }

  /// Takes the value three after where the next differences begin, and writes these.
  HWY_INLINE void step(D value, D* d) {
    const D after = hn::Sub(value, last_), bend = hn::Sub(after, next_);
    d[0] = first_;
    d[1] = second_;
    d[2] = hn::Sub(bend, second_);
    last_ = value;
    first_ = next_;
    next_ = after;
    second_ = bend;
  }

 private:
  D last_, first_, next_, second_;
};

/// Sums a sequence of values of the differences of each order into rows of control points: a
/// difference is that of two differences of one order less.
class RowSum {
 public:
  HWY_INLINE RowSum() { first_ = second_ = third_ = zero(); }
  HWY_INLINE D step(D first, D second, D third) {
    second = hn::Add(second, hn::Sub(third_, third));
    first = hn::Add(first, hn::Sub(second_, second));
    const D row = hn::Sub(first_, first);
    first_ = first;
    second_ = second;
    third_ = third;
    return row;
  }

 private:
  D first_, second_, third_;
};

/// The same for a matrix that is diagonal in the differences: rows of a band of four diagonals. All
/// curves are at least 0, and so are all sums, so that nothing cancels.
class BandSum {
 public:
  HWY_INLINE BandSum() { third_ = second_ = first_ = next_ = zero(); }
  /// Writes absolute values. The diagonals next to the main one and farthest from it are negative.
  HWY_INLINE void step(D first, D second, D third, D* band) {
    const D both = hn::Add(third_, third);
    second = hn::Add(second, both);
    first = hn::Add(hn::Add(first, hn::Add(third_, third_)), hn::Add(second_, second));
    const D next = hn::Add(second, both);
    band[0] = hn::Add(hn::Add(first_, first), hn::Add(next_, next_));
    band[1] = hn::Add(hn::Add(next_, next), hn::Add(third_, first));
    band[2] = hn::Add(next, both);
    band[3] = third;
    third_ = third;
    second_ = second;
    first_ = first;
    next_ = next;
  }

 private:
  D third_;         ///< curve of the last difference of third order
  D second_;        ///< main diagonal of the differences of second order, in the last row
  D first_, next_;  ///< the same for first order, and the diagonal next to it
};

/// Derivatives by the step alone.
struct StepDerivatives {
  double gradient = 0, curvature = 0;
};

/// Newton's equations of the joints of a vector: a symmetric band of four diagonals, with the step
/// as its border. `kOrders`: 2 if no joint has a limit of jerk, otherwise 3.
template <size_t kOrders>
class JointBlock {
 public:
  HWY_INLINE JointBlock(const BarrierTables& tables, size_t first, double step_s)
      : t_(tables),
        first_(first),
        records_(tables.scratch + first * tables.count * kBarrierArrays) {
    double power = 1;
    for (size_t o = 0; o < kOrders; ++o) {
      power *= step_s;
      limit_[o] = hn::Mul(all(power), load(t_.limits[o] + first));
      weight_[o] = load(t_.weights[o] + first);
      // The limit grows with the step.
      slope_[o] = hn::Mul(all(static_cast<double>(o + 1) / step_s), limit_[o]);
    }
    // Two differences of first order and one of second order are among the last points, which are
    // equal, and begin after the rows below.
    const D rate = all(4 / step_s), both = hn::Add(weight_[0], weight_[1]);
    gradient_ = hn::Neg(hn::Mul(rate, both));
    curvature_ = hn::Mul(hn::Mul(rate, all(1 / step_s)), hn::Add(both, weight_[1]));
  }

  /// Adds the barriers of all differences and boxes, decomposes the band into L D L' and solves for
  /// the gradient and for the border. Curvature of the limits, which is negative, is left out.
  HWY_INLINE void solve(StepDerivatives& step) {
    Differences differences(load(point(0)));
    size_t i = 0;
    for (; i < kFixedPoints; ++i) add_row<false>(i, differences);
    for (; i + kFixedPoints < t_.count; ++i) add_row<true>(i, differences);
    for (; i < t_.count; ++i) {
      store(zero(), array(kMove, i));
      store(zero(), array(kBorderMove, i));
      store(zero(), array(kUp + kBox, i));
      store(zero(), array(kDown + kBox, i));
    }
    substitute();
    step.gradient += sum_of(gradient_);
    step.curvature += sum_of(curvature_);
  }

  /// Completes the moves by that of the step. Returns the greatest share of room that they take.
  HWY_INLINE double complete(double step_move) {
    D most = zero(), least = zero(), changes[kOrders];
    for (size_t o = 0; o < kOrders; ++o) changes[o] = hn::Mul(slope_[o], all(step_move));
    const auto lose_room = [&](D move, D change, const double* up, const double* down) HWY_ATTR {
      most = hn::Max(most, hn::Mul(hn::Sub(move, change), load(up)));
      least = hn::Min(least, hn::Mul(hn::Add(move, change), load(down)));
    };
    Differences differences(zero());
    for (size_t i = 0; i + kFixedPoints < t_.count; ++i) {
      const size_t last = i + kFixedPoints;
      const D move =
          hn::MulAdd(all(step_move), load(array(kBorderMove, last)), load(array(kMove, last)));
      store(move, array(kMove, last));
      lose_room(move, zero(), array(kUp + kBox, last), array(kDown + kBox, last));
      D d[3];
      differences.step(move, d);
      // Powers of the step are convex: they are above their tangent.
      for (size_t o = 0; o < kOrders; ++o) {
        lose_room(d[o], changes[o], array(kUp + o, i), array(kDown + o, i));
      }
    }
    return most_of(hn::Max(most, hn::Neg(least)));
  }

  HWY_INLINE void take(double share) {
    for (size_t i = kFixedPoints; i + kFixedPoints < t_.count; ++i) {
      double* p = t_.points + i * t_.stride + first_;
      store(hn::MulAdd(all(share), load(array(kMove, i)), load(p)), p);
    }
  }

 private:
  /// Values of a record; kUp and kDown have one for each order, and one for boxes. The border has
  /// the opposite sign.
  static constexpr size_t kUp = 0, kDown = 4, kBorder = 8, kMove = 9, kBorderMove = 10, kFirst = 11,
                          kSecond = 12, kThird = 13;
  static constexpr size_t kBox = 3;  // after the orders

  /// The distances to both limits of a barrier.
  struct Rooms {
    D above, below, product;
  };
  /// Derivatives of a barrier by its difference, and, with the opposite sign, by the step, too.
  struct Terms {
    D slope, curve, mixed;
  };

  /// All values of a row are next to each other.
  HWY_INLINE double* array(size_t which, size_t row) const {
    return records_ + (row * kBarrierArrays + which) * kDoubles;
  }
  HWY_INLINE const double* point(size_t i) const { return t_.points + i * t_.stride + first_; }

  static HWY_INLINE Rooms rooms_of(D above, D below) {
    return {above, below, hn::Mul(above, below)};
  }
  HWY_INLINE Rooms box_rooms(size_t i) const {
    const size_t at = i * t_.stride + first_;
    const D p = load(t_.points + at);
    return rooms_of(hn::Sub(load(t_.upper + at), p), hn::Sub(p, load(t_.lower + at)));
  }
  /// Stores and returns the slopes of -log(above) and -log(below).
  HWY_INLINE void store_slopes(size_t which, size_t i, const Rooms& rooms, D inverse, D& up,
                               D& down) const {
    up = hn::Mul(rooms.below, inverse);
    down = hn::Mul(rooms.above, inverse);
    store(up, array(kUp + which, i));
    store(down, array(kDown + which, i));
  }

  /// -log(limit - g) - log(limit + g) of the difference of an order that begins at `i`.
  HWY_INLINE Terms add_barrier(size_t o, size_t i, const Rooms& rooms, D inverse) {
    D up, down;
    store_slopes(o, i, rooms, hn::Mul(inverse, weight_[o]), up, down);
    const D slope = hn::Sub(up, down), curve = hn::MulAdd(up, up, hn::Mul(down, down));
    const D by_step = hn::Mul(slope_[o], hn::Add(up, down));
    gradient_ = hn::Sub(gradient_, by_step);
    curvature_ = hn::MulAdd(hn::Mul(slope_[o], slope_[o]), curve, curvature_);
    return {slope, curve, hn::Mul(by_step, slope)};
  }

  /// Adds the differences that begin at `i`, and eliminates this row if its point is free.
  template <bool kIsFree>
  HWY_INLINE void add_row(size_t i, Differences& differences) {
    D d[3];
    differences.step(load(point(i + kFixedPoints)), d);
    const Rooms none{zero(), zero(), all(1)};
    Rooms rooms[3] = {none, none, none}, box = none;
    for (size_t o = 0; o < kOrders; ++o) {
      rooms[o] = rooms_of(hn::Sub(limit_[o], d[o]), hn::Add(limit_[o], d[o]));
    }
    if (kIsFree) box = box_rooms(i);
    // One division for all of them.
    const D a = hn::Mul(rooms[0].product, rooms[1].product);
    const D b = hn::Mul(rooms[2].product, box.product);
    const D inverse = hn::Div(all(1), hn::Mul(a, b));
    const D inverse_a = hn::Mul(inverse, b), inverse_b = hn::Mul(inverse, a);
    const Terms first = add_barrier(0, i, rooms[0], hn::Mul(inverse_a, rooms[1].product));
    const Terms second = add_barrier(1, i, rooms[1], hn::Mul(inverse_a, rooms[0].product));
    Terms third{zero(), zero(), zero()};
    if (kOrders > 2) third = add_barrier(2, i, rooms[2], hn::Mul(inverse_b, box.product));
    const D gradient = gradients_.step(first.slope, second.slope, third.slope);
    const D border = borders_.step(first.mixed, second.mixed, third.mixed);
    D band[4];
    bands_.step(first.curve, second.curve, third.curve, band);
    if (!kIsFree) return;
    D up, down;
    store_slopes(kBox, i, box, hn::Mul(inverse_b, rooms[2].product), up, down);
    band[0] = hn::MulAdd(up, up, hn::MulAdd(down, down, band[0]));
    eliminate(i, band, hn::Add(gradient, hn::Sub(up, down)), border);
  }

  /// Signs of the band are as those of BandSum.
  HWY_INLINE void eliminate(size_t i, D* band, D gradient, D border) {
    store(border, array(kBorder, i));
    band[0] = hn::Sub(band[0], diagonal_[0]);
    band[1] = hn::Sub(band[1], beside_[0]);
    band[2] = hn::Sub(band[2], farther_);
    const D inverse = hn::Div(all(1), band[0]);
    const D f1 = hn::Mul(band[1], inverse), f2 = hn::Mul(band[2], inverse);
    const D f3 = hn::Mul(band[3], inverse);
    const D x = hn::Neg(hn::Add(gradient, moves_[0])), y = hn::Sub(border, border_moves_[0]);
    // Rows below.
    diagonal_[0] = hn::MulAdd(f1, band[1], diagonal_[1]);
    diagonal_[1] = hn::MulAdd(f2, band[2], diagonal_[2]);
    diagonal_[2] = hn::Mul(f3, band[3]);
    beside_[0] = hn::MulAdd(f1, band[2], beside_[1]);
    beside_[1] = hn::Mul(f2, band[3]);
    farther_ = hn::Mul(f1, band[3]);
    const auto advance = [&](D* pending, D value) HWY_ATTR {
      pending[0] = hn::NegMulAdd(f1, value, pending[1]);
      pending[1] = hn::MulSub(f2, value, pending[2]);
      pending[2] = hn::Mul(f3, value);
    };
    advance(moves_, x);
    advance(border_moves_, y);
    store(f1, array(kFirst, i));
    store(f2, array(kSecond, i));
    if (kOrders > 2) store(f3, array(kThird, i));
    store(hn::Mul(x, inverse), array(kMove, i));
    store(hn::Mul(y, inverse), array(kBorderMove, i));
  }

  /// Back substitution, and the terms of the step's equation: [B c; c' d] [x; y] = -[g; e].
  HWY_INLINE void substitute() {
    D x[3] = {zero(), zero(), zero()}, y[3] = {zero(), zero(), zero()};
    for (size_t i = t_.count - kFixedPoints; i-- > kFixedPoints;) {
      const D f1 = load(array(kFirst, i)), f2 = load(array(kSecond, i));
      const D f3 = kOrders > 2 ? load(array(kThird, i)) : zero();
      const auto solve_row = [&](D* v, size_t which) HWY_ATTR {
        D value = hn::NegMulAdd(f2, v[1], load(array(which, i)));
        if (kOrders > 2) value = hn::MulAdd(f3, v[2], value);
        v[2] = v[1];
        v[1] = v[0];
        v[0] = hn::MulAdd(f1, v[0], value);
        store(v[0], array(which, i));
      };
      solve_row(x, kMove);
      solve_row(y, kBorderMove);
      const D border = load(array(kBorder, i));
      gradient_ = hn::NegMulAdd(border, x[0], gradient_);
      curvature_ = hn::NegMulAdd(border, y[0], curvature_);
    }
  }

  const BarrierTables& t_;
  size_t first_;
  double* records_;
  D limit_[kOrders], weight_[kOrders], slope_[kOrders];
  D gradient_, curvature_;
  RowSum gradients_, borders_;
  BandSum bands_;
  /// What the next rows lose: of their diagonal, of the two beside it, of the solutions.
  D diagonal_[3] = {zero(), zero(), zero()}, beside_[2] = {zero(), zero()}, farther_ = zero();
  D moves_[3] = {zero(), zero(), zero()}, border_moves_[3] = {zero(), zero(), zero()};
};

/// Calls `visit` with each block of joints.
template <class Visit>
HWY_INLINE void for_each_block(const BarrierTables& tables, double step_s, Visit&& visit) {
  for (size_t first = 0; first < tables.stride; first += kDoubles) {
    if (most_of(load(tables.weights[2] + first)) > 0) {
      visit(JointBlock<3>(tables, first, step_s));
    } else {
      visit(JointBlock<2>(tables, first, step_s));
    }
  }
}

double newton_step(const BarrierTables& tables, double weight, double& step_s) {
  constexpr double kKept = 0.1;  // share of the room that is left to each limit
  StepDerivatives step{weight, 0};
  for_each_block(tables, step_s, [&](auto block) HWY_ATTR { block.solve(step); });
  const double step_move = step.curvature > 0 ? -step.gradient / step.curvature : 0;
  double most = std::max(0.0, -step_move / step_s);
  for_each_block(tables, step_s,
                 [&](auto block) HWY_ATTR { most = std::max(most, block.complete(step_move)); });
  const double share = std::min(1.0, (1 - kKept) / most);
  if (!std::isfinite(share * step_move)) return share * step_move;
  for_each_block(tables, step_s, [&](auto block) HWY_ATTR { block.take(share); });
  step_s += share * step_move;
  return share;
}

const BarrierKernels& kernels() {
  static const BarrierKernels table = {&newton_step};
  return table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(const BarrierKernels&, barrier_kernels, kernels)
#endif
