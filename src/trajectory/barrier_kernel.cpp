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

/// Factors of the control points i, i + 1, .. in a difference of first to third order.
constexpr double kFactors[3][4] = {{-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};

/// The last four values of a sequence, the newest first.
struct Last {
  HWY_INLINE Last() {
    for (D& x : v) x = zero();
  }
  HWY_INLINE void push(D x) {
    v[3] = v[2];
    v[2] = v[1];
    v[1] = v[0];
    v[0] = x;
  }

  D v[4];
};

template <size_t kOrder>
HWY_INLINE D difference(const double* row, size_t stride) {
  D sum = hn::Mul(all(kFactors[kOrder - 1][0]), load(row));
  for (size_t k = 1; k <= kOrder; ++k) {
    sum = hn::MulAdd(all(kFactors[kOrder - 1][k]), load(row + k * stride), sum);
  }
  return sum;
}

/// Derivatives by the step alone.
struct StepDerivatives {
  double gradient = 0, curvature = 0;
};

/// Newton's equations of the joints of a vector: a symmetric band of four diagonals, with the step
/// as its border.
class JointBlock {
 public:
  HWY_INLINE JointBlock(const BarrierTables& tables, size_t first, double step_s)
      : t_(tables), first_(first) {
    double power = 1;
    for (size_t o = 0; o < 3; ++o) {
      power *= step_s;
      limit_[o] = hn::Mul(all(power), load(t_.limits[o] + first));
      weight_[o] = load(t_.weights[o] + first);
      // The limit grows with the step.
      slope_[o] = hn::Mul(all(static_cast<double>(o + 1) / step_s), limit_[o]);
    }
  }

  /// Adds the barriers of all differences and boxes, decomposes the band into L D L' and solves for
  /// the gradient and for the border. Curvature of the limits, which is negative, is left out.
  HWY_INLINE void solve(StepDerivatives& step) {
    D gradient = zero(), curvature = zero();
    for (size_t i = 0; i < t_.count; ++i) {
      const Rooms first = rooms<1>(i), second = rooms<2>(i), third = rooms<3>(i),
                  box = box_rooms(i);
      // One division for all of them.
      const D a = hn::Mul(first.product, second.product), b = hn::Mul(third.product, box.product);
      const D inverse = hn::Div(all(1), hn::Mul(a, b));
      const D inverse_a = hn::Mul(inverse, b), inverse_b = hn::Mul(inverse, a);
      add_barriers<1>(i, first, hn::Mul(inverse_a, second.product), gradient, curvature);
      add_barriers<2>(i, second, hn::Mul(inverse_a, first.product), gradient, curvature);
      add_barriers<3>(i, third, hn::Mul(inverse_b, box.product), gradient, curvature);
      if (is_free(i)) {
        eliminate(i, box, hn::Mul(inverse_b, third.product));
      } else {
        store(zero(), array(kMove, i));
        store(zero(), array(kBorderMove, i));
      }
    }
    substitute(gradient, curvature);
    step.gradient += sum_of(gradient);
    step.curvature += sum_of(curvature);
  }

  /// Completes the moves by that of the step. Returns the greatest share of room that they take.
  HWY_INLINE double complete(double step_move) {
    for (size_t i = kFixedPoints; i + kFixedPoints < t_.count; ++i) {
      const D move =
          hn::NegMulAdd(all(step_move), load(array(kBorderMove, i)), load(array(kMove, i)));
      store(move, array(kMove, i));
    }
    D most = zero();
    for (size_t i = 0; i < t_.count; ++i) {
      find_lost_room<1>(i, step_move, most);
      find_lost_room<2>(i, step_move, most);
      find_lost_room<3>(i, step_move, most);
      if (is_free(i)) find_lost_room_in_box(i, most);
    }
    return most_of(most);
  }

  HWY_INLINE void take(double share) {
    for (size_t i = kFixedPoints; i + kFixedPoints < t_.count; ++i) {
      double* p = t_.points + i * t_.stride + first_;
      store(hn::MulAdd(all(share), load(array(kMove, i)), load(p)), p);
    }
  }

 private:
  /// Arrays of rows; kUp and kDown have one for each order, and one for boxes.
  enum { kUp = 0, kDown = 4, kBorder = 8, kMove, kBorderMove, kFirst, kSecond, kThird };
  static constexpr size_t kBox = 3;  // after the orders

  /// The distances to both limits of a barrier.
  struct Rooms {
    D above, below, product;
  };

  HWY_INLINE double* array(size_t which, size_t row) const {
    return t_.scratch + (which * t_.count + row) * t_.stride + first_;
  }
  HWY_INLINE const double* point(size_t i) const { return t_.points + i * t_.stride + first_; }
  HWY_INLINE bool is_free(size_t i) const {
    return i >= kFixedPoints && i + kFixedPoints < t_.count;
  }

  /// Of the difference that begins at `i`.
  template <size_t kOrder>
  HWY_INLINE Rooms rooms(size_t i) const {
    constexpr size_t o = kOrder - 1;
    if (i + kOrder >= t_.count) return {zero(), zero(), all(1)};
    const D g = difference<kOrder>(point(i), t_.stride);
    const D above = hn::Sub(limit_[o], g), below = hn::Add(limit_[o], g);
    return {above, below, hn::Mul(above, below)};
  }
  HWY_INLINE Rooms box_rooms(size_t i) const {
    if (!is_free(i)) return {zero(), zero(), all(1)};
    const size_t at = i * t_.stride + first_;
    const D p = load(t_.points + at);
    const D above = hn::Sub(load(t_.upper + at), p), below = hn::Sub(p, load(t_.lower + at));
    return {above, below, hn::Mul(above, below)};
  }
  /// Stores and returns the slopes of -log(above) and -log(below).
  HWY_INLINE void store_slopes(size_t which, size_t i, const Rooms& rooms, D inverse, D& up,
                               D& down) const {
    up = hn::Mul(rooms.below, inverse);
    down = hn::Mul(rooms.above, inverse);
    store(up, array(kUp + which, i));
    store(down, array(kDown + which, i));
  }

  /// -log(limit - g) - log(limit + g) of the difference that begins at `i`.
  template <size_t kOrder>
  HWY_INLINE void add_barriers(size_t i, const Rooms& rooms, D inverse, D& gradient, D& curvature) {
    constexpr size_t o = kOrder - 1;
    if (i + kOrder >= t_.count) return;
    D up, down;
    store_slopes(o, i, rooms, hn::Mul(inverse, weight_[o]), up, down);
    const D up2 = hn::Mul(up, up), down2 = hn::Mul(down, down);
    slopes_[o].push(hn::Sub(up, down));
    curves_[o].push(hn::Add(up2, down2));
    mixed_[o].push(hn::Mul(slope_[o], hn::Sub(down2, up2)));
    gradient = hn::NegMulAdd(slope_[o], hn::Add(up, down), gradient);
    curvature = hn::MulAdd(hn::Mul(slope_[o], slope_[o]), curves_[o].v[0], curvature);
  }

  /// Sum of the terms of one order in a row: their differences begin at the row and before it.
  template <size_t kOrder>
  HWY_INLINE void add_row(D* band, D& gradient, D& border) const {
    constexpr size_t o = kOrder - 1;
    for (size_t k = 0; k <= kOrder; ++k) {
      gradient = hn::MulAdd(all(kFactors[o][k]), slopes_[o].v[k], gradient);
      border = hn::MulAdd(all(kFactors[o][k]), mixed_[o].v[k], border);
      for (size_t b = 0; b + k <= kOrder; ++b) {
        band[b] = hn::MulAdd(all(kFactors[o][k] * kFactors[o][k + b]), curves_[o].v[k], band[b]);
      }
    }
  }

  HWY_INLINE void eliminate(size_t i, const Rooms& box, D inverse_room) {
    D up, down;
    store_slopes(kBox, i, box, inverse_room, up, down);
    D gradient = hn::Sub(up, down), border = zero();
    D band[4] = {hn::MulAdd(up, up, hn::Mul(down, down)), zero(), zero(), zero()};
    add_row<1>(band, gradient, border);
    add_row<2>(band, gradient, border);
    add_row<3>(band, gradient, border);
    store(border, array(kBorder, i));
    band[0] = hn::Sub(band[0], pending_[0].v[0]);
    band[1] = hn::Sub(band[1], pending_[1].v[0]);
    band[2] = hn::Sub(band[2], pending_[2].v[0]);
    const D inverse = hn::Div(all(1), band[0]);
    const D f1 = hn::Mul(band[1], inverse), f2 = hn::Mul(band[2], inverse);
    const D f3 = hn::Mul(band[3], inverse);
    const D x = hn::Neg(hn::Add(gradient, pending_move_.v[0]));
    const D y = hn::Sub(border, pending_border_.v[0]);
    // Rows below: the diagonal, and the two next to it.
    advance(pending_[0], hn::Mul(f1, band[1]), hn::Mul(f2, band[2]), hn::Mul(f3, band[3]));
    advance(pending_[1], hn::Mul(f1, band[2]), hn::Mul(f2, band[3]), zero());
    advance(pending_[2], hn::Mul(f1, band[3]), zero(), zero());
    advance(pending_move_, hn::Mul(f1, x), hn::Mul(f2, x), hn::Mul(f3, x));
    advance(pending_border_, hn::Mul(f1, y), hn::Mul(f2, y), hn::Mul(f3, y));
    store(f1, array(kFirst, i));
    store(f2, array(kSecond, i));
    store(f3, array(kThird, i));
    store(hn::Mul(x, inverse), array(kMove, i));
    store(hn::Mul(y, inverse), array(kBorderMove, i));
  }

  /// Adds the losses of the next three rows; pending.v[0] is that of the next one.
  static HWY_INLINE void advance(Last& pending, D next, D second, D third) {
    pending.v[0] = hn::Add(pending.v[1], next);
    pending.v[1] = hn::Add(pending.v[2], second);
    pending.v[2] = third;
  }

  /// Back substitution, and the terms of the step's equation: [B c; c' d] [x; y] = -[g; e].
  HWY_INLINE void substitute(D& gradient, D& curvature) {
    Last x, y;
    for (size_t i = t_.count - kFixedPoints; i-- > kFixedPoints;) {
      const D f1 = load(array(kFirst, i)), f2 = load(array(kSecond, i));
      const D f3 = load(array(kThird, i));
      const auto solved = [&](const Last& v, D value) {
        value = hn::NegMulAdd(f1, v.v[0], value);
        value = hn::NegMulAdd(f2, v.v[1], value);
        return hn::NegMulAdd(f3, v.v[2], value);
      };
      x.push(solved(x, load(array(kMove, i))));
      y.push(solved(y, load(array(kBorderMove, i))));
      store(x.v[0], array(kMove, i));
      store(y.v[0], array(kBorderMove, i));
      const D border = load(array(kBorder, i));
      gradient = hn::MulAdd(border, x.v[0], gradient);
      curvature = hn::NegMulAdd(border, y.v[0], curvature);
    }
  }

  /// Powers of the step are convex: they are above their tangent.
  template <size_t kOrder>
  HWY_INLINE void find_lost_room(size_t i, double step_move, D& most) const {
    constexpr size_t o = kOrder - 1;
    if (i + kOrder >= t_.count) return;
    const D move = difference<kOrder>(array(kMove, i), t_.stride);
    const D change = hn::Mul(slope_[o], all(step_move));
    most = hn::Max(most, hn::Mul(hn::Sub(move, change), load(array(kUp + o, i))));
    most = hn::Max(most, hn::Mul(hn::Neg(hn::Add(move, change)), load(array(kDown + o, i))));
  }
  HWY_INLINE void find_lost_room_in_box(size_t i, D& most) const {
    const D move = load(array(kMove, i));
    most = hn::Max(most, hn::Mul(move, load(array(kUp + kBox, i))));
    most = hn::Max(most, hn::Mul(hn::Neg(move), load(array(kDown + kBox, i))));
  }

  const BarrierTables& t_;
  size_t first_;
  D limit_[3], weight_[3], slope_[3];
  Last slopes_[3], curves_[3], mixed_[3];
  Last pending_[3], pending_move_, pending_border_;
};

double newton_step(const BarrierTables& tables, double weight, double& step_s) {
  constexpr double kKept = 0.1;  // share of the room that is left to each limit
  StepDerivatives step{weight, 0};
  for (size_t first = 0; first < tables.stride; first += kDoubles) {
    JointBlock(tables, first, step_s).solve(step);
  }
  const double step_move = step.curvature > 0 ? -step.gradient / step.curvature : 0;
  double most = std::max(0.0, -step_move / step_s);
  for (size_t first = 0; first < tables.stride; first += kDoubles) {
    most = std::max(most, JointBlock(tables, first, step_s).complete(step_move));
  }
  const double share = std::min(1.0, (1 - kKept) / most);
  if (!std::isfinite(share * step_move)) return share * step_move;
  for (size_t first = 0; first < tables.stride; first += kDoubles) {
    JointBlock(tables, first, step_s).take(share);
  }
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
