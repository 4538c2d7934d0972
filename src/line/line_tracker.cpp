// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "line/line_tracker.h"

#include "base/as_index.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mneme::internal {
namespace {

/// Metres along the line: the first step, and a step that is not halved any more.
constexpr double kFirstStep = 0.01, kLeastStep = 5e-4, kLeastLazyStep = 4e-3;
/// Errors of waypoints, as a share of the tolerance.
constexpr double kWaypointShare = 0.02;
/// Corrections of a step by Newton's method with a constant response.
constexpr int kMostCorrections = 8;
constexpr double kDamping = 1e-9;
/// Share of the tolerance that steps aim at.
constexpr double kAim = 0.8;
/// Largest value of |t (t - 1/2) (t - 1)| / 6 for t in [0, 1]: the error of interpolation at 0, 1/2
/// and 1 per third derivative.
constexpr double kInterpolationError = 0.0080188;
/// Radians per metre of the line by which joints at their limits drift away, at most.
constexpr double kLimitDrift = 4;

using Row = std::array<float, kMostChainJoints>;

Row to_row(const JointVector& q) {
  Row values = {};
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    values[static_cast<std::size_t>(j)] = static_cast<float>(q[j]);
  }
  return values;
}

double chord(double angle) { return 2 * std::sin(0.5 * std::min(angle, 3.0)); }

/// Largest angle with a chord.
double angle_of(double chord) { return chord < 2 ? 2 * std::asin(0.5 * chord) : 4.0; }

}  // namespace

LineTracker::LineTracker(const LinkChain& chain, const LineSegment& segment,
                         const CollisionChecker& checker, const LineTolerances& tolerances)
    : chain_(chain),
      segment_(segment),
      checker_(checker),
      verifier_(checker),
      tolerances_(tolerances),
      joints_(as_index(checker.robot().joint_count())),
      redundancy_(chain.moving_count() - (checker.robot().is_planar() ? 3 : 6)) {}

LineState LineTracker::begin(double s, const JointVector& q) const {
  const Twist error = difference(chain_.place(q), segment_.at(s));
  LineState state;
  state.s = s;
  state.q = q;
  state.position = error.head<3>().norm();
  state.rotation = error.tail<3>().norm();
  state.step = kFirstStep / segment_.size();
  return state;
}

LineStop LineTracker::step(const LineState& from, double until, JointVector drift, LineCheck check,
                           LineState& to, int& attempts) {
  Base base{from, {}, {}, {}};
  base.pose = chain_.place(from.q, &base.jacobian);
  std::uint32_t locked = 0;
  int lockable = redundancy();
  base.response = chain_.response(from.q, base.jacobian, locked, kDamping);
  const double least = check == LineCheck::states ? kLeastLazyStep : kLeastStep;
  double h = std::min(from.step, until - from.s);
  for (;;) {
    double excess = 0;
    ++attempts;
    const LineStop stop = attempt(base, h, drift, check, to, excess);
    if (stop.kind == LineStop::Kind::none) {
      to.step = h * std::clamp(kAim / std::sqrt(excess + 1e-9), 0.5, 2.0);
      // A step that ends at `until` says little about the next.
      if (h == until - from.s) to.step = std::max(to.step, from.step);
      return stop;
    }
    const bool may_lock = stop.kind == LineStop::Kind::limit && lockable > 0;
    if (may_lock && (locked >> stop.joint & 1) == 0) {
      locked |= std::uint32_t{1} << stop.joint;
      --lockable;
      drift[stop.joint] = 0;
      base.response = chain_.response(from.q, base.jacobian, locked, kDamping);
      continue;
    }
    if (h * segment_.size() < least) return stop;
    h *= excess > 1 ? std::clamp(kAim / std::sqrt(excess), 0.1, 0.8) : 0.5;
  }
}

LineStop LineTracker::attempt(const Base& base, double h, const JointVector& drift, LineCheck check,
                              LineState& to, double& excess) {
  const LineState& from = base.from;
  // The last step of a line ends on it exactly.
  to.s = from.s + h > 1 - 1e-12 ? 1 : from.s + h;
  const JointVector free = h * drift;
  const Twist twist = difference(base.pose, segment_.at(to.s)) - base.jacobian * free;
  to.q = from.q + free + base.response * twist;
  const auto stopped = [&](LineStop::Kind kind, int joint = -1) {
    return LineStop{kind, joint, from.q, to.q};
  };
  if (!correct(base.response, to)) return stopped(LineStop::Kind::kinematics);
  const int joint = find_violated_limit(to.q);
  if (joint >= 0) return stopped(LineStop::Kind::limit, joint);
  excess = bound_deviation(from, to);
  if (!(excess <= 1)) return stopped(LineStop::Kind::kinematics);
  to.is_proven = check == LineCheck::proof;
  if (!is_free(from, to, check)) return stopped(LineStop::Kind::contact);
  return {};
}

bool LineTracker::correct(const Response& response, LineState& to) const {
  const Transform pose = segment_.at(to.s);
  for (int i = 0; i <= kMostCorrections; ++i) {
    const Twist error = difference(chain_.place(to.q), pose);
    to.position = error.head<3>().norm();
    to.rotation = error.tail<3>().norm();
    if (to.position < kWaypointShare * tolerances_.position &&
        to.rotation < kWaypointShare * tolerances_.rotation) {
      return true;
    }
    if (!(to.position + to.rotation < 1)) return false;
    to.q += response * error;
  }
  return false;
}

double LineTracker::bound_deviation(const LineState& from, LineState& to) const {
  const Transform middle = chain_.place(0.5 * (from.q + to.q));
  const Twist off = difference(middle, segment_.at(0.5 * (from.s + to.s)));
  const LinkChain::MotionBounds bounds = chain_.bounds(from.q, to.q);
  to.off_line =
      off.head<3>().norm() + from.position + to.position + kInterpolationError * bounds.jerk;
  const double turned = segment_.angle() * (to.s - from.s);
  const double jerk = bounds.turn * bounds.turn * bounds.turn + turned * turned * turned;
  to.off_rotation = angle_of(chord(off.tail<3>().norm()) + chord(from.rotation) +
                             chord(to.rotation) + kInterpolationError * jerk);
  return std::max(to.off_line / tolerances_.position, to.off_rotation / tolerances_.rotation);
}

bool LineTracker::prove(const LineState& from, const LineState& to) {
  const Row a = to_row(from.q), b = to_row(to.q);
  return verifier_.is_free({a.data(), joints_}, {b.data(), joints_}, {from.s == 0, to.s == 1},
                           checks_);
}

bool LineTracker::prove(std::span<const LineState> states) {
  std::vector<float> rows;
  for (const LineState& state : states) {
    const Row row = to_row(state.q);
    rows.insert(rows.end(), row.begin(), row.begin() + static_cast<std::ptrdiff_t>(joints_));
  }
  return verifier_.are_free(rows, {states.front().s == 0, states.back().s == 1}, checks_);
}

/// States tell of most contact at less cost than a proof that fails.
bool LineTracker::is_free(const LineState& from, const LineState& to, LineCheck check) {
  if (check == LineCheck::kinematics) return true;
  return has_free_states(from, to) && (check == LineCheck::states || prove(from, to));
}

bool LineTracker::has_free_states(const LineState& from, const LineState& to) {
  const Row a = to_row(from.q), b = to_row(to.q);
  const bool is_end = from.s == 0 || to.s == 1;
  return checker_.is_motion_valid({a.data(), joints_}, {b.data(), joints_}, checks_,
                                  {1, is_end ? 0 : kVerificationMargin});
}

int LineTracker::find_violated_limit(const JointVector& q) const {
  for (int j = 0; j < chain_.joint_count(); ++j) {
    if (!(q[j] >= chain_.lower()[j] && q[j] <= chain_.upper()[j])) return j;
  }
  return -1;
}

JointVector LineTracker::drift_from_limits(const JointVector& q) const {
  JointVector drift = JointVector::Zero(q.size());
  if (redundancy() == 0) return drift;
  for (int j = 0; j < chain_.joint_count(); ++j) {
    if (chain_.wraps(j)) continue;
    const double half = 0.5 * (chain_.upper()[j] - chain_.lower()[j]);
    if (!(half > 0)) continue;
    const double u = (q[j] - chain_.lower()[j]) / half - 1;
    drift[j] = -kLimitDrift * segment_.size() * std::min(half, 1.0) * u * u * u;
  }
  return drift;
}

bool LineTracker::settle(double s, JointVector& q) const {
  LineState state;
  for (int i = 0; i < 2; ++i) {
    state.s = s;
    state.q = q;
    Jacobian jacobian;
    static_cast<void>(chain_.place(q, &jacobian));
    const bool is_settled = correct(chain_.response(q, jacobian, 0, kDamping), state);
    q = state.q;
    if (is_settled) return chain_.keeps_limits(q);
  }
  return false;
}

}  // namespace mneme::internal
