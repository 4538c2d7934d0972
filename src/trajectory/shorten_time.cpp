// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Samples of a motion are control points of a spline that keeps the same limits, because its
// derivatives are averages of those of the motion. Rounds make it faster, each within boxes around
// the control points of the last one. Where a piece does not pass, the boxes of its control points
// shrink. Rounds check states; the result is proven.
#include "trajectory/shorten_time.h"

#include "base/as_index.h"
#include "path/rest_to_rest.h"
#include "trajectory/time_barrier.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

constexpr double kPieceTime = 0.02;  ///< seconds of a piece, within the numbers of pieces below
constexpr double kLeastPieces = 32, kMostPieces = 80;
/// The first spline is slower by this factor: barriers need room.
constexpr double kSlower = 1.05;
/// Half of the width of a box, radians or metres, at first and at most.
constexpr double kRadius = 0.2, kMostRadius = 0.5;
/// Factors on it after a round in which a point's pieces passed, or one did not.
constexpr double kGrow = 1.5, kShrink = 0.5;
/// Share of the move of a point whose pieces did not pass that its box leaves for the next round.
constexpr double kMoveAgain = 0.3;
constexpr double kLeastRoom = 1e-8;  ///< of a box around a joint's limit
/// Share of time that barriers may cost, at first and at last.
constexpr double kGap = 0.02, kLeastGap = 0.01;
constexpr double kGapFactor = 0.1;    ///< per round
constexpr double kLeastGain = 0.001;  ///< relative
constexpr int kIdleRounds = 3;        ///< without this gain end the search
/// Motions within this share of the time that their slowest joint needs by itself are fast enough:
/// a spline whose jerk changes only between pieces gains nothing.
constexpr double kNearLeast = 0.002;
/// Deviation of verified chords from the motion, L2 joint distance: first the greater one, which
/// needs fewer chords and more clearance.
constexpr double kChordErrors[] = {2e-3, 1e-4};
constexpr std::size_t kMostPiecesOfChord = 16;
/// Clearance of states beyond which rounds do not look closer, metres, and such states per piece.
constexpr double kGuideMargin = 2e-3;
constexpr std::size_t kGuides = 2;
/// The same for a closer look. A smaller clearance is proven less often in the end.
constexpr double kCloseMargin = 5e-4;
constexpr std::size_t kCloseStates = 8;
/// If the last spline is not proven, others between the first and the last are tried.
constexpr int kProofs = 4;

bool is_near(const Leg& leg, const float* q, double tolerance) {
  double along = 0, whole = 0;
  for (std::size_t j = 0; j < leg.direction.size(); ++j) {
    const double offset = double{q[j]} - leg.begin[j];
    along += offset * leg.direction[j];
    whole += offset * offset;
  }
  const double nearest = std::clamp(along, 0.0, leg.length);
  return whole + nearest * (nearest - 2 * along) <= tolerance * tolerance;
}

/// The spline at `share` of the way from `first` to `last`. A joint's difference of order k is then
/// within the means of both limits, which are below the limit for the cubic mean of both steps.
TimeSpline between(const TimeSpline& first, const TimeSpline& last, double share) {
  TimeSpline spline = last;
  spline.step_s =
      std::cbrt((1 - share) * std::pow(first.step_s, 3) + share * std::pow(last.step_s, 3));
  for (std::size_t i = 0; i < spline.count(); ++i) {
    for (std::size_t j = 0; j < spline.joint_count(); ++j) {
      spline.points[i][j] += (1 - share) * (first.points[i][j] - last.points[i][j]);
    }
  }
  return spline;
}

/// The time that the slowest joint needs by itself.
double least_time(const Legs& legs, const RateLimits& limits) {
  double time_s = 0;
  for (std::size_t j = 0; j < legs.end.size() && !legs.legs.empty(); ++j) {
    const double distance = std::abs(legs.end[j] - legs.legs.front().begin[j]);
    time_s = std::max(time_s, rest_to_rest(limits, j).duration_s(distance));
  }
  return time_s;
}

class TimeShortener {
 public:
  TimeShortener(const Robot& robot, const Legs& legs, const RateLimits& limits,
                const TrajectorySettings& settings, const MotionVerifier& verifier)
      : legs_(legs),
        joints_(legs.end.size()),
        tolerance_(settings.path_tolerance - kChordErrors[0]),
        rounds_(settings.time_rounds),
        fast_enough_s_((1 + kNearLeast) * least_time(legs, limits)),
        verifier_(verifier),
        barrier_(limits, verifier.checker().isa()) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    lowest_.assign(PointRows(1, joints_).stride(), -kNone);
    highest_.assign(lowest_.size(), kNone);
    for (std::size_t j = 0; j < joints_; ++j) {
      const Joint& joint = robot.group_joint(static_cast<int>(j));
      if (joint.type == JointType::continuous) continue;
      lowest_[j] = joint.lower;
      highest_[j] = joint.upper;
    }
  }

  std::optional<Trajectory> shorten(const Trajectory& motion) {
    if (motion.duration_s() <= fast_enough_s_) return std::nullopt;
    sample(motion);
    if (tolerance_ <= 0 || !barrier_.admits(spline_)) return std::nullopt;
    const TimeSpline first = spline_;
    run_rounds();
    for (int i = 0; i < kProofs; ++i) {
      const double share = 1 - static_cast<double>(i) / kProofs;
      const TimeSpline spline = share < 1 ? between(first, spline_, share) : spline_;
      if (!(spline.duration_s() < motion.duration_s())) break;
      if (barrier_.admits(spline) && is_proven(spline)) return to_trajectory(spline);
    }
    return std::nullopt;
  }

 private:
  void run_rounds() {
    double gap = kGap;
    int idle = 0;
    for (int round = 0; round < rounds_ && idle < kIdleRounds; ++round) {
      if (spline_.duration_s() <= fast_enough_s_) return;
      TimeSpline next = spline_;
      place_boxes();
      const bool is_centred = barrier_.shorten(next, boxes_, gap);
      const bool has_passed = passes(next);
      change_radii(next);
      if (!has_passed) continue;
      const double gain = 1 - next.duration_s() / spline_.duration_s();
      spline_ = std::move(next);
      idle = gap <= kLeastGap && gain < kLeastGain ? idle + 1 : 0;
      if (is_centred) gap = std::max(kLeastGap, kGapFactor * gap);
    }
  }

  /// Boxes grow, except at points whose pieces did not pass on the way to `next`.
  void change_radii(const TimeSpline& next) {
    for (std::size_t i = 0; i < radii_.size(); ++i) {
      double& radius = radii_[i];
      if (!has_failed_[i]) {
        radius = std::min(kGrow * radius, kMostRadius);
        continue;
      }
      double move = 0;
      for (std::size_t j = 0; j < joints_; ++j) {
        move = std::max(move, std::abs(next.points[i][j] - spline_.points[i][j]));
      }
      radius = std::max(kLeastRoom, std::min(kShrink * radius, kMoveAgain * move));
    }
  }

  void sample(const Trajectory& motion) {
    const double duration_s = motion.duration_s();
    const double pieces =
        std::floor(std::clamp(duration_s / kPieceTime, kLeastPieces, kMostPieces));
    const double step_s = duration_s / pieces;
    // Before the first and after the last of them there are two that repeat them.
    const auto count = static_cast<std::size_t>(pieces) + 2 * kFixedPoints - 1;
    spline_ = {kSlower * step_s, PointRows(count, joints_)};
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_end = i + kFixedPoints >= count;
      const double time_s = is_end ? duration_s : step_s * (static_cast<double>(i) - 2);
      std::ranges::copy(motion.at(time_s).position, spline_.points[i]);
    }
    radii_.assign(count, kRadius);
    boxes_ = {PointRows(count, joints_), PointRows(count, joints_)};
  }

  /// Places boxes_ around the control points, within the limits of joints.
  void place_boxes() {
    for (std::size_t i = 0; i < radii_.size(); ++i) {
      const double* p = spline_.points[i];
      double *lower = boxes_.lower[i], *upper = boxes_.upper[i];
      for (std::size_t j = 0; j < lowest_.size(); ++j) {
        lower[j] = std::min(std::max(p[j] - radii_[i], lowest_[j]), p[j] - kLeastRoom);
        upper[j] = std::max(std::min(p[j] + radii_[i], highest_[j]), p[j] + kLeastRoom);
      }
    }
  }

  /// Notes control points of pieces that do not pass; true if there are none.
  bool passes(const TimeSpline& spline) {
    has_failed_.assign(spline.count(), false);
    bool has_passed = true;
    const auto note_failure = [&](std::size_t piece) {
      has_passed = false;
      for (std::size_t k = 0; k <= kFixedPoints; ++k) has_failed_[piece + k] = true;
    };
    std::vector<std::size_t> pieces(spline.piece_count());
    std::iota(pieces.begin(), pieces.end(), std::size_t{0});
    states_.clear();
    for (const std::size_t i : pieces) add_states(spline, i, kGuides);
    const std::vector<std::size_t> touching = find_touching(pieces, kGuides, kGuideMargin);
    add_state(spline, pieces.back(), 1);
    find_far_chords([&](std::size_t chord) { note_failure(chord / kGuides); });
    // The last state of a piece is the first one of the next.
    std::vector<std::size_t> doubtful;
    for (const std::size_t i : touching) {
      if (i > 0 && (doubtful.empty() || doubtful.back() + 1 < i)) doubtful.push_back(i - 1);
      doubtful.push_back(i);
    }
    states_.clear();
    for (const std::size_t i : doubtful) add_states(spline, i, kCloseStates);
    for (const std::size_t i : find_touching(doubtful, kCloseStates, kCloseMargin)) note_failure(i);
    return has_passed;
  }

  /// Returns the pieces that lack the margin at one of their `count` states in states_.
  [[nodiscard]] std::vector<std::size_t> find_touching(const std::vector<std::size_t>& pieces,
                                                       std::size_t count, double margin) {
    is_free_.resize(pieces.size() * count);
    verifier_.checker().check_states(states_, is_free_, margin);
    std::vector<std::size_t> touching;
    for (std::size_t i = 0; i < is_free_.size(); ++i) {
      const std::size_t piece = pieces[i / count];
      const bool is_new = touching.empty() || touching.back() != piece;
      if (is_free_[i] == 0 && is_new) touching.push_back(piece);
    }
    return touching;
  }

  [[nodiscard]] bool is_proven(const TimeSpline& spline) {
    find_bends(spline);
    for (std::size_t i = 0, end = 0; i < spline.piece_count(); i = end) {
      end = find_chord_end(spline, i);
      if (end - i > 1 && is_chord_proven(spline, i, end)) continue;
      for (std::size_t piece = i; piece < end; ++piece) {
        if (!is_piece_proven(spline, piece)) return false;
      }
    }
    return true;
  }

  /// Writes the second differences of control points, absolute: those where pieces begin and end.
  void find_bends(const TimeSpline& spline) {
    bends_ = PointRows(spline.piece_count() + 1, joints_);
    for (std::size_t i = 0; i < bends_.count(); ++i) {
      const double *a = spline.points[i], *b = spline.points[i + 1], *c = spline.points[i + 2];
      for (std::size_t j = 0; j < bends_.stride(); ++j)
        bends_[i][j] = std::abs(a[j] - 2 * b[j] + c[j]);
    }
  }

  /// The end of a chord from where piece `begin` begins: it spans as many pieces as the greater
  /// error allows, and at least one.
  [[nodiscard]] std::size_t find_chord_end(const TimeSpline& spline, std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < spline.piece_count() && end - begin < kMostPiecesOfChord &&
           find_bow(begin, end + 1) <= kChordErrors[0]) {
      ++end;
    }
    return end;
  }

  /// Writes to bow_ how far pieces are, at most, from the chord between their ends: acceleration is
  /// linear in time on each. Returns the L2 norm.
  double find_bow(std::size_t begin, std::size_t end) {
    bow_.assign(joints_, 0);
    const auto count = static_cast<double>(end - begin);
    double sum = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      double most = 0;
      for (std::size_t i = begin; i <= end; ++i) most = std::max(most, bends_[i][j]);
      const double bow = most * count * count / 8;
      bow_[j] = static_cast<float>(bow);
      sum += bow * bow;
    }
    return std::sqrt(sum);
  }

  [[nodiscard]] bool is_chord_proven(const TimeSpline& spline, std::size_t begin, std::size_t end) {
    states_.clear();
    add_state(spline, begin, 0);
    add_state(spline, end - 1, 1);
    find_bow(begin, end);
    return !has_long_turn() && is_near() && verifier_.is_curve_free(states_, bow_, counters_);
  }

  /// True if a joint turns so far between two states that a sweep may take the other way around.
  [[nodiscard]] bool has_long_turn() const {
    constexpr float kMostTurn = 3;  // radians
    for (std::size_t j = 0; j < joints_; ++j) {
      if (std::abs(states_[joints_ + j] - states_[j]) > kMostTurn) return true;
    }
    return false;
  }

  [[nodiscard]] bool is_piece_proven(const TimeSpline& spline, std::size_t piece) {
    int last = 0;
    for (const double error : kChordErrors) {
      const double norm = find_bow(piece, piece + 1);
      const int count = std::max(1, static_cast<int>(std::ceil(std::sqrt(norm / error))));
      if (count == last) continue;
      last = count;
      states_.clear();
      add_states(spline, piece, as_index(count));
      add_state(spline, piece, 1);
      if (!is_near()) return false;
      for (float& value : bow_) value /= static_cast<float>(count * count);
      if (verifier_.is_curve_free(states_, bow_, counters_)) return true;
    }
    return false;
  }

  /// Adds to states_ those at the begin of `count` equal parts of a piece.
  void add_states(const TimeSpline& spline, std::size_t piece, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      add_state(spline, piece, static_cast<double>(k) / static_cast<double>(count));
    }
  }
  /// Adds the state at a share of a piece.
  void add_state(const TimeSpline& spline, std::size_t piece, double t) {
    const double a = (1 - t) * (1 - t) * (1 - t) / 6, d = t * t * t / 6;
    const double b = 2.0 / 3 - t * t * (2 - t) / 2, c = 1 - a - b - d;
    const double *p = spline.points[piece], *q = spline.points[piece + 1];
    const double *r = spline.points[piece + 2], *s = spline.points[piece + 3];
    states_.resize(states_.size() + joints_);
    float* state = states_.data() + states_.size() - joints_;
    for (std::size_t j = 0; j < joints_; ++j) {
      state[j] = static_cast<float>(a * p[j] + b * q[j] + c * r[j] + d * s[j]);
    }
  }

  [[nodiscard]] bool is_near() {
    bool is_near = true;
    find_far_chords([&](std::size_t) { is_near = false; });
    return is_near;
  }

  /// Calls `note` for each chord between states_ that is not near the path. A chord whose ends are
  /// near one leg is.
  template <class Note>
  void find_far_chords(Note&& note) {
    const auto is_near_leg = [&](const Leg& leg, std::size_t state) {
      return internal::is_near(leg, &states_[state * joints_], tolerance_);
    };
    bool is_begin_near = is_near_leg(legs_.legs[leg_], 0);
    for (std::size_t i = 0; (i + 1) * joints_ < states_.size(); ++i) {
      const bool is_end_near = is_near_leg(legs_.legs[leg_], i + 1);
      const bool was_near = std::exchange(is_begin_near, is_end_near);
      if (was_near && is_end_near) continue;
      const auto found = std::ranges::find_if(legs_.legs, [&](const Leg& leg) {
        return is_near_leg(leg, i) && is_near_leg(leg, i + 1);
      });
      if (found == legs_.legs.end()) {
        note(i);
        continue;
      }
      leg_ = static_cast<std::size_t>(found - legs_.legs.begin());
      is_begin_near = true;
    }
  }

  [[nodiscard]] Trajectory to_trajectory(const TimeSpline& spline) const {
    std::vector<Trajectory::Stretch> stretches;
    for (std::size_t i = 0; i < spline.piece_count(); ++i) {
      Trajectory::Stretch stretch{static_cast<double>(i) * spline.step_s,
                                  std::vector<double>(4 * joints_)};
      for (std::size_t j = 0; j < joints_; ++j) {
        const auto piece = spline.piece(j, i);
        for (std::size_t k = 0; k < 4; ++k) stretch.coefficients[k * joints_ + j] = piece[k];
      }
      stretches.push_back(std::move(stretch));
    }
    return {std::move(stretches), legs_.end, spline.duration_s()};
  }

  const Legs& legs_;
  std::size_t joints_;
  double tolerance_;
  int rounds_;
  double fast_enough_s_;
  const MotionVerifier& verifier_;
  TimeBarrier barrier_;
  TimeSpline spline_;
  std::vector<double> radii_;  ///< per control point
  std::vector<bool> has_failed_;
  std::vector<double> lowest_,
      highest_;  ///< limits of joints; none where they turn, and of padding
  Boxes boxes_;
  PointRows bends_;
  std::vector<float> bow_;
  CheckCounters counters_;
  std::vector<float> states_;
  std::vector<std::uint8_t> is_free_;  ///< of states_
  std::size_t leg_ = 0;                ///< the leg that was found last
};

}  // namespace

std::optional<Trajectory> shorten_time(const Robot& robot, const Trajectory& motion,
                                       const Legs& legs, const RateLimits& limits,
                                       const TrajectorySettings& settings,
                                       const MotionVerifier& verifier) {
  if (!(motion.duration_s() > 0) || settings.time_rounds == 0) return std::nullopt;
  return TimeShortener(robot, legs, limits, settings, verifier).shorten(motion);
}

}  // namespace mneme::internal
