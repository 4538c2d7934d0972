// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/smooth_motion.h"

#include "trajectory/speed_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace mneme::internal {
namespace {

/// Share of a value to which equations are solved, on the safe side.
constexpr double kAccuracy = 1e-11;
/// Factor on the speed at a corner for the next attempt if it is not free; deviations shrink with
/// its square.
constexpr double kSlowerCorner = 0.6;
constexpr int kCornerAttempts = 6;
/// Share of a leg's length that counts as rounding.
constexpr double kSameLength = 1e-6;

/// A change of velocity whose acceleration grows for `ramp_s`, stays, and shrinks for `ramp_s`.
struct Change {
  double duration_s = 0, ramp_s = 0;

  /// The greatest acceleration is the change of velocity times this.
  [[nodiscard]] double steepness() const { return 1 / (duration_s - ramp_s); }
  [[nodiscard]] Change slowed(double factor) const {
    return {factor * duration_s, factor * ramp_s};
  }
  /// The distance, after `t` seconds, from where the velocity before would have led, divided by the
  /// change of velocity. The second half is the first one turned about its middle.
  [[nodiscard]] double moved(double t) const {
    const double late = std::max(0.0, t - duration_s / 2);
    t -= 2 * late;
    const double ramp = std::min(t, ramp_s), steady = t - ramp;
    const double growing = ramp > 0 ? ramp * ramp * ramp / (6 * ramp_s) : 0;
    if (!(duration_s > 0)) return late;
    return late + steepness() * (growing + steady * (ramp_s + steady) / 2);
  }
};

/// The shortest change that takes at least `acceleration_s` at the limits of acceleration, and
/// `jerk_s2` at those of jerk.
Change shortest_change(double acceleration_s, double jerk_s2) {
  const double steady = std::max(acceleration_s, std::sqrt(jerk_s2));
  const double ramp = steady > 0 ? std::min(jerk_s2 / steady, steady) : 0;
  return {steady + ramp, ramp};
}

/// The limits along a leg.
struct LegLimits {
  double speed = kNoLimit, acceleration = kNoLimit, jerk = kNoLimit;

  [[nodiscard]] Change change(double from, double to) const {
    const double difference = std::abs(to - from);
    return shortest_change(difference / acceleration, difference / jerk);
  }
  /// The length that a change of speed takes.
  [[nodiscard]] double reach(double from, double to) const {
    return 0.5 * (from + to) * change(from, to).duration_s;
  }
};

LegLimits limits_along(const std::vector<double>& direction, const RateLimits& limits) {
  LegLimits along;
  for (std::size_t j = 0; j < direction.size(); ++j) {
    const double share = std::abs(direction[j]);
    if (share == 0) continue;
    along.speed = std::min(along.speed, kRoom * limits.velocity[j] / share);
    along.acceleration = std::min(along.acceleration, kRoom * limits.acceleration[j] / share);
    if (limits.jerk.empty()) continue;
    along.jerk = std::min(along.jerk, kRoom * limits.jerk[j] / share);
  }
  return along;
}

/// About the greatest value in [least, most] whose `excess`, a continuous function, is at most 0,
/// as it must be for `least`. The method ITP (Oliveira and Takahashi, DOI 10.1145/3423597): a
/// secant, moved towards the middle so that it takes hardly longer than bisection.
template <class Excess>
double greatest(double least, double most, Excess&& excess) {
  double above = excess(most);
  if (above <= 0) return most;
  double below = std::min(0.0, excess(least));
  const double accuracy = kAccuracy * most, range = most - least;
  double radius = accuracy * std::exp2(std::ceil(std::log2(std::max(1.0, range / accuracy))));
  while (most - least > accuracy) {
    const double width = most - least, middle = least + 0.5 * width;
    const double secant = least + width * (below / (below - above));
    const double shift = std::min(0.2 * width * width / range, std::abs(middle - secant));
    const double nearer = secant + std::copysign(shift, middle - secant);
    const double most_away = std::max(0.0, radius - 0.5 * width);
    const double x = std::clamp(nearer, middle - most_away, middle + most_away);
    const double value = excess(x);
    (value <= 0 ? least : most) = x;
    (value <= 0 ? below : above) = value;
    radius *= 0.5;
  }
  return least;
}

/// A corner between two legs at `share` of their greatest speeds.
class SmoothCorner {
 public:
  SmoothCorner(const Leg& in, const LegLimits& before, const Leg& out, const LegLimits& after,
               const RateLimits& limits)
      : in_(in), out_(out), speed_in_(before.speed), speed_out_(after.speed) {
    turn_ = plus(std::vector<double>(in.direction.size()), speed_out_, out.direction);
    turn_ = plus(std::move(turn_), -speed_in_, in.direction);
    for (std::size_t j = 0; j < turn_.size(); ++j) {
      acceleration_s_ = std::max(acceleration_s_, std::abs(turn_[j]) / limits.acceleration[j]);
      if (limits.jerk.empty()) continue;
      jerk_s2_ = std::max(jerk_s2_, std::abs(turn_[j]) / limits.jerk[j]);
    }
  }

  /// Limits the share so that the corner takes at most half of each leg and deviates by at most
  /// `tolerance`. Closed forms: shares whose acceleration stays for a while, otherwise smaller
  /// ones.
  void keep_near(double tolerance) {
    const double turn = norm(turn_);
    if (!(turn > 0)) return;
    const double steady_s = acceleration_s_ / kRoom, ramp_s = jerk_s2_ / acceleration_s_;
    const auto share_within = [&](double time_s) {
      const double large =
          (std::sqrt(ramp_s * ramp_s + 4 * steady_s * time_s) - ramp_s) / (2 * steady_s);
      return steady_s * large >= ramp_s ? large
                                        : std::cbrt(time_s * time_s / (4 * steady_s * ramp_s));
    };
    const double aside_s = tolerance / turn;
    const double large =
        std::sqrt(std::max(0.0, 8 / steady_s * (aside_s - ramp_s * ramp_s / (24 * steady_s))));
    const double near = steady_s * large >= ramp_s
                            ? large
                            : std::cbrt(36 * aside_s * aside_s / (steady_s * ramp_s));
    share = std::min(
        {1.0, near, share_within(in_.length / speed_in_), share_within(out_.length / speed_out_)});
  }

  [[nodiscard]] Change change_at(double value) const {
    return shortest_change(acceleration_s_ * value / kRoom, jerk_s2_ * value / kRoom);
  }
  [[nodiscard]] double speed_in(double value) const { return value * speed_in_; }
  [[nodiscard]] double speed_out(double value) const { return value * speed_out_; }
  [[nodiscard]] double reach_in(double value) const {
    return 0.5 * speed_in(value) * change_at(value).duration_s;
  }
  [[nodiscard]] double reach_out(double value) const {
    return 0.5 * speed_out(value) * change_at(value).duration_s;
  }

  void add_to(std::vector<JerkPiece>& pieces) const {
    const Change change = change_at(share);
    if (!(change.duration_s > 0)) return;
    const std::vector<double> still(turn_.size());
    const std::vector<double> steepest = plus(still, share * change.steepness(), turn_);
    const double steady = change.duration_s - 2 * change.ramp_s;
    JerkPiece piece{change.ramp_s, plus(in_.begin, in_.length - reach_in(share), in_.direction),
                    plus(still, share * speed_in_, in_.direction), still, still};
    if (change.ramp_s > 0) {
      piece.jerk = plus(still, 1 / change.ramp_s, steepest);
      pieces.push_back(piece);
      piece = end_of(piece);
    }
    piece.acceleration = steepest;
    piece.jerk = still;
    piece.duration_s = steady;
    if (steady > 0) pieces.push_back(piece);
    if (change.ramp_s == 0) return;
    piece = end_of(piece);
    piece.acceleration = steepest;
    piece.jerk = plus(still, -1 / change.ramp_s, steepest);
    piece.duration_s = change.ramp_s;
    pieces.push_back(piece);
  }

  /// Points on the curve, and how far it is, at most, from the chords between them.
  struct Chords {
    std::vector<float> states, bow;
  };
  /// Empty for a corner at rest.
  [[nodiscard]] Chords chords() const {
    const Change change = change_at(share);
    if (!(change.duration_s > 0)) return {};
    Chords chords;
    const double dt = change.duration_s / kChords, before = in_.length - reach_in(share);
    for (int i = 0; i <= kChords; ++i) {
      const double along = before + speed_in(share) * i * dt, aside = share * change.moved(i * dt);
      for (std::size_t j = 0; j < turn_.size(); ++j) {
        const double q = in_.begin[j] + along * in_.direction[j] + aside * turn_[j];
        chords.states.push_back(static_cast<float>(q));
      }
    }
    for (const double turn : turn_) {
      const double acceleration = share * change.steepness() * std::abs(turn);
      chords.bow.push_back(static_cast<float>(acceleration * dt * dt / 8));
    }
    return chords;
  }

  double share = 1;  ///< of the greatest speeds of both legs
  double verified_share = 0;
  int failures = 0;

 private:
  [[nodiscard]] static JerkPiece end_of(const JerkPiece& piece) {
    const double t = piece.duration_s;
    JerkPiece end = piece;
    for (std::size_t j = 0; j < end.jerk.size(); ++j) {
      const double a = piece.acceleration[j], jerk = piece.jerk[j];
      end.position[j] += (piece.velocity[j] + (a / 2 + jerk * t / 6) * t) * t;
      end.velocity[j] += (a + jerk * t / 2) * t;
      end.acceleration[j] += jerk * t;
    }
    return end;
  }

  const Leg& in_;
  const Leg& out_;
  double speed_in_, speed_out_;
  std::vector<double> turn_;  ///< the change of velocity at share 1
  double acceleration_s_ = 0, jerk_s2_ = 0;
};

/// As a guide, a corner is free if its states are, without a proof.
bool is_free(const SmoothCorner& corner, const MotionVerifier& verifier,
             const FollowSettings& settings) {
  const auto [states, bow] = corner.chords();
  if (states.empty()) return true;
  CheckCounters counters;
  if (!settings.is_guide) return verifier.is_curve_free(states, bow, counters);
  // The first state is on a leg.
  std::array<std::uint8_t, kChords> passes;
  verifier.checker().check_states(std::span(states).subspan(bow.size()), passes, counters,
                                  settings.guide_margin);
  return std::ranges::find(passes, 0) == passes.end();
}

/// Legs and the corners between them.
class SmoothMotion {
 public:
  SmoothMotion(const Legs& legs, const RateLimits& limits, const FollowSettings& settings,
               const MotionVerifier* verifier)
      : legs_(legs.legs),
        settings_(settings),
        begin_speed_(settings.begin_speed),
        end_speed_(settings.end_speed),
        verifier_(verifier) {
    for (const Leg& leg : legs_) along_.push_back(limits_along(leg.direction, limits));
    for (std::size_t i = 1; i < legs_.size(); ++i) {
      corners_.emplace_back(legs_[i - 1], along_[i - 1], legs_[i], along_[i], limits);
      const bool is_passed = verifier != nullptr || settings.is_estimate;
      if (!is_passed || (settings.stops_first && i == 1)) {
        corners_.back().share = 0;
      } else {
        corners_.back().keep_near(settings.tolerance);
      }
    }
  }

  /// Lowers speeds at corners until each leg can be passed and each corner is free.
  void slow_down() {
    do {
      for (std::size_t i = 0; i < corners_.size(); ++i) slow_down_end(i);
      for (std::size_t i = corners_.size(); i-- > 0;) slow_down_begin(i + 1);
    } while (stop_beside_ends() || !verify());
  }

  [[nodiscard]] double duration_s() const {
    double duration_s = 0;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      const auto [begin, peak, end, from, steady, slower] = profile(i);
      const double changing_s =
          along_[i].change(begin, peak).duration_s + along_[i].change(peak, end).duration_s;
      duration_s += slower * changing_s + (peak > 0 ? steady / peak : 0);
    }
    for (const SmoothCorner& corner : corners_) {
      duration_s += corner.change_at(corner.share).duration_s;
    }
    return duration_s;
  }

  [[nodiscard]] std::vector<JerkPiece> pieces() const {
    std::vector<JerkPiece> pieces;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      add_leg(i, pieces);
      if (i < corners_.size()) corners_[i].add_to(pieces);
    }
    return pieces;
  }

 private:
  [[nodiscard]] double begin_speed(std::size_t leg) const {
    return leg == 0 ? begin_speed_ : corners_[leg - 1].speed_out(corners_[leg - 1].share);
  }
  [[nodiscard]] double end_speed(std::size_t leg) const {
    return leg == corners_.size() ? end_speed_ : corners_[leg].speed_in(corners_[leg].share);
  }
  [[nodiscard]] double begin_reach(std::size_t leg) const {
    return leg == 0 ? 0 : corners_[leg - 1].reach_out(corners_[leg - 1].share);
  }
  [[nodiscard]] double end_reach(std::size_t leg) const {
    return leg == corners_.size() ? 0 : corners_[leg].reach_in(corners_[leg].share);
  }

  /// At most 0 if the leg is long enough to change to the speed of its end at this share. The other
  /// pass sees to it that slower ends can be reached, except from the speed at the start.
  [[nodiscard]] double excess_at_end(std::size_t leg, double share) const {
    const SmoothCorner& corner = corners_[leg];
    const double begin = begin_speed(leg), end = corner.speed_in(share);
    const double length = legs_[leg].length - begin_reach(leg);
    const double excess = along_[leg].reach(begin, end) - (length - corner.reach_in(share));
    return leg > 0 ? std::min(end - begin, excess) : excess;
  }
  /// The same for the speed of its begin. Faster ends are seen to by the other pass, except the
  /// speed at the end of the motion.
  [[nodiscard]] double excess_at_begin(std::size_t leg, double share) const {
    const SmoothCorner& corner = corners_[leg - 1];
    const double begin = corner.speed_out(share), end = end_speed(leg);
    const double length = legs_[leg].length - end_reach(leg);
    const double excess = along_[leg].reach(begin, end) - (length - corner.reach_out(share));
    return leg < corners_.size() ? std::min(begin - end, excess) : excess;
  }
  void slow_down_end(std::size_t leg) {
    SmoothCorner& corner = corners_[leg];
    corner.share =
        greatest(0, corner.share, [&](double share) { return excess_at_end(leg, share); });
  }
  void slow_down_begin(std::size_t leg) {
    SmoothCorner& corner = corners_[leg - 1];
    corner.share =
        greatest(0, corner.share, [&](double share) { return excess_at_begin(leg, share); });
  }

  /// Stops at the corners beside the ends if they are too slow for the given speeds there. Returns
  /// true if one was not stopped before.
  bool stop_beside_ends() {
    if (corners_.empty()) return false;
    double &first = corners_.front().share, &last = corners_.back().share;
    const bool stops_first = begin_speed_ > 0 && first > 0 && excess_at_end(0, first) > 0;
    const bool stops_last =
        end_speed_ > 0 && last > 0 && excess_at_begin(corners_.size(), last) > 0;
    if (stops_first) first = 0;
    if (stops_last) last = 0;
    return stops_first || stops_last;
  }

  /// Slows down at corners that are not free. Returns true if all are.
  bool verify() {
    if (verifier_ == nullptr) return true;
    bool has_passed = true;
    for (SmoothCorner& corner : corners_) {
      if (corner.share == corner.verified_share || corner.share == 0) continue;
      if (is_free(corner, *verifier_, settings_)) {
        corner.verified_share = corner.share;
        continue;
      }
      corner.share *= ++corner.failures < kCornerAttempts ? kSlowerCorner : 0;
      has_passed = false;
    }
    return has_passed;
  }

  /// Speeds along a leg: it changes from `begin` to `peak`, stays for `steady` metres or radians,
  /// and changes to `end`, from `from` on. Changes take `slower` times as long as limits allow.
  struct LegProfile {
    double begin = 0, peak = 0, end = 0, from = 0, steady = 0, slower = 1;
  };
  /// Accelerates to the greatest speed that the leg allows, and decelerates. A leg that is longer
  /// than its change by rounding has a slower change, not an opposite one first.
  [[nodiscard]] LegProfile profile(std::size_t i) const {
    const LegLimits& along = along_[i];
    const double begin = begin_speed(i), end = end_speed(i), from = begin_reach(i);
    const double length = legs_[i].length - from - end_reach(i);
    const auto reach = [&](double speed) {
      return along.reach(begin, speed) + along.reach(speed, end);
    };
    const double least = std::max(begin, end), needed = reach(least);
    if (needed > 0 && length <= (1 + kSameLength) * needed) {
      return {begin, least, end, from, 0, std::max(1.0, length / needed)};
    }
    // Without a limit of jerk.
    const double fastest =
        std::sqrt(along.acceleration * length + 0.5 * (begin * begin + end * end));
    const double most = std::max(least, std::min((1 - kAccuracy) * fastest, along.speed));
    const double peak = greatest(least, most, [&](double speed) { return reach(speed) - length; });
    return {begin, peak, end, from, std::max(0.0, length - reach(peak))};
  }

  void add_leg(std::size_t i, std::vector<JerkPiece>& pieces) const {
    const Leg& leg = legs_[i];
    const LegLimits& along = along_[i];
    const auto [begin, peak, end, from, steady, slower] = profile(i);
    const double slow_down_at = leg.length - end_reach(i) - slower * along.reach(peak, end);
    add_change(leg, along.change(begin, peak).slowed(slower), from, begin, peak, pieces);
    add(leg, slow_down_at - steady, peak, 0, 0, peak > 0 ? steady / peak : 0, pieces);
    add_change(leg, along.change(peak, end).slowed(slower), slow_down_at, peak, end, pieces);
  }

  static void add_change(const Leg& leg, const Change& change, double from, double begin,
                         double end, std::vector<JerkPiece>& pieces) {
    const double a = (end - begin) * change.steepness(), ramp = change.ramp_s;
    if (!(change.duration_s > 0)) return;
    const double jerk = ramp > 0 ? a / ramp : 0, steady = change.duration_s - 2 * ramp;
    add(leg, from, begin, 0, jerk, ramp, pieces);
    from += (begin + a * ramp / 6) * ramp;
    begin += 0.5 * a * ramp;
    add(leg, from, begin, a, 0, steady, pieces);
    from += (begin + 0.5 * a * steady) * steady;
    begin += a * steady;
    add(leg, from, begin, a, -jerk, ramp, pieces);
  }

  static void add(const Leg& leg, double from, double speed, double acceleration, double jerk,
                  double duration_s, std::vector<JerkPiece>& pieces) {
    if (!(duration_s > 0)) return;
    const std::vector<double> still(leg.direction.size());
    pieces.push_back({duration_s, plus(leg.begin, from, leg.direction),
                      plus(still, speed, leg.direction), plus(still, acceleration, leg.direction),
                      plus(still, jerk, leg.direction)});
  }

  const std::vector<Leg>& legs_;
  const FollowSettings& settings_;
  double begin_speed_, end_speed_;  ///< at the start and at the end
  const MotionVerifier* verifier_;
  std::vector<LegLimits> along_;
  std::vector<SmoothCorner> corners_;
};

}  // namespace

bool has_jerk_limit(const RateLimits& limits) {
  return std::ranges::any_of(limits.jerk, [](double jerk) { return std::isfinite(jerk); });
}

Trajectory to_trajectory(const std::vector<JerkPiece>& pieces, const Configuration& end,
                         std::vector<double> end_velocity) {
  std::vector<Trajectory::Stretch> stretches;
  double time_s = 0;
  for (const JerkPiece& piece : pieces) {
    Trajectory::Stretch stretch{time_s, piece.position};
    std::vector<double>& all = stretch.coefficients;
    all.insert(all.end(), piece.velocity.begin(), piece.velocity.end());
    for (const double a : piece.acceleration) all.push_back(a / 2);
    for (const double jerk : piece.jerk) all.push_back(jerk / 6);
    stretches.push_back(std::move(stretch));
    time_s += piece.duration_s;
  }
  return {std::move(stretches), end, time_s, std::move(end_velocity)};
}

std::vector<JerkPiece> follow_legs(const Legs& legs, const RateLimits& limits,
                                   const FollowSettings& settings, const MotionVerifier* verifier) {
  SmoothMotion motion(legs, limits, settings, verifier);
  motion.slow_down();
  return motion.pieces();
}

double duration_along(const Legs& legs, const RateLimits& limits, const FollowSettings& settings,
                      const MotionVerifier* verifier) {
  SmoothMotion motion(legs, limits, settings, verifier);
  motion.slow_down();
  return motion.duration_s();
}

double reach_to_stop(const std::vector<double>& direction, double speed, const RateLimits& limits) {
  return limits_along(direction, limits).reach(speed, 0);
}

}  // namespace mneme::internal
