// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Samples of a motion are control points of a spline that keeps the same limits, because its
// derivatives are averages of those of the motion. Rounds make it faster, each within boxes around
// the control points of the last one that passed. Where a piece does not pass, the boxes of its
// control points shrink.
#include "trajectory/shorten_time.h"

#include "trajectory/time_barrier.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mneme::internal {
namespace {

constexpr double kPieceTime = 0.02;  ///< seconds of a piece, within the numbers of pieces below
constexpr double kLeastPieces = 32, kMostPieces = 96;
/// The first spline is slower by this factor: barriers need room.
constexpr double kSlower = 1.01;
/// Half of the width of a box, radians or metres, at first and at most.
constexpr double kRadius = 0.1, kMostRadius = 0.5;
/// Factors on it after a round in which a point's pieces passed, or one did not.
constexpr double kGrow = 1.5, kShrink = 0.3;
constexpr double kLeastRoom = 1e-8;  ///< of a box around a joint's limit
/// Share of time that barriers may cost, at first and at last.
constexpr double kGap = 0.1, kLeastGap = 0.01;
constexpr double kGapFactor = 0.1;    ///< per round
constexpr double kLeastGain = 0.001;  ///< relative
constexpr int kIdleRounds = 3;        ///< without this gain end the search
/// Deviation of verified chords from the motion, L2 joint distance.
constexpr double kChordError = 1e-4;

/// States on a piece of a spline, and how far it is from the chords between them.
struct Chords {
  std::vector<Configuration> states;
  std::vector<float> bow;
};

Chords chords_of(const TimeSpline& spline, std::size_t piece) {
  Chords chords;
  std::vector<std::array<double, 4>> joints;
  double bow = 0;  // of the whole piece
  for (std::size_t j = 0; j < spline.joint_count(); ++j) {
    joints.push_back(spline.piece(j, piece));
    const double begin = 2 * joints[j][2], end = begin + 6 * joints[j][3] * spline.step_s;
    const double most = std::max(std::abs(begin), std::abs(end)) * spline.step_s * spline.step_s;
    chords.bow.push_back(static_cast<float>(most / 8));
    bow = std::hypot(bow, most / 8);
  }
  const int count = std::max(1, static_cast<int>(std::ceil(std::sqrt(bow / kChordError))));
  for (float& value : chords.bow) value /= static_cast<float>(count * count);
  for (int k = 0; k <= count; ++k) {
    const double t = spline.step_s * k / count;
    Configuration& q = chords.states.emplace_back();
    for (const auto& c : joints) q.push_back(c[0] + t * (c[1] + t * (c[2] + t * c[3])));
  }
  return chords;
}

bool is_near(const Leg& leg, const Configuration& q, double tolerance) {
  double along = 0, whole = 0;
  for (std::size_t j = 0; j < q.size(); ++j) {
    const double offset = q[j] - leg.begin[j];
    along += offset * leg.direction[j];
    whole += offset * offset;
  }
  const double nearest = std::clamp(along, 0.0, leg.length);
  return whole + nearest * (nearest - 2 * along) <= tolerance * tolerance;
}

class TimeShortener {
 public:
  TimeShortener(const Robot& robot, const Legs& legs, const RateLimits& limits,
                const TrajectorySettings& settings, const MotionVerifier& verifier)
      : robot_(robot),
        legs_(legs),
        tolerance_(settings.path_tolerance - kChordError),
        rounds_(settings.time_rounds),
        verifier_(verifier),
        barrier_(limits) {}

  Trajectory shorten(Trajectory motion) {
    sample(motion);
    if (tolerance_ <= 0 || !barrier_.admits(spline_)) return motion;
    double gap = kGap;
    int idle = 0;
    for (int round = 0; round < rounds_ && idle < kIdleRounds; ++round) {
      TimeSpline next = spline_;
      const bool is_centred = barrier_.shorten(next, boxes(), gap);
      if (!find_failures(next)) {
        const double gain = 1 - next.duration_s() / spline_.duration_s();
        spline_ = std::move(next);
        idle = gap <= kLeastGap && gain < kLeastGain ? idle + 1 : 0;
        if (is_centred) gap = std::max(kLeastGap, kGapFactor * gap);
      }
      for (std::size_t i = 0; i < radii_.size(); ++i) {
        radii_[i] = has_failed_[i] ? kShrink * radii_[i] : std::min(kGrow * radii_[i], kMostRadius);
      }
    }
    const bool is_faster = spline_.duration_s() < motion.duration_s();
    return is_faster && barrier_.admits(spline_) ? to_trajectory() : motion;
  }

 private:
  void sample(const Trajectory& motion) {
    const double duration_s = motion.duration_s();
    const double pieces =
        std::floor(std::clamp(duration_s / kPieceTime, kLeastPieces, kMostPieces));
    const double step_s = duration_s / pieces;
    // Before the first and after the last of them there are two that repeat them.
    const auto count = static_cast<std::size_t>(pieces) + 2 * TimeSpline::kFixed - 1;
    spline_ = {kSlower * step_s, std::vector(legs_.end.size(), std::vector<double>(count))};
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_end = i + TimeSpline::kFixed >= count;
      const double time_s = is_end ? duration_s : step_s * (static_cast<double>(i) - 2);
      const Configuration q = motion.at(time_s).position;
      for (std::size_t j = 0; j < q.size(); ++j) spline_.points[j][i] = q[j];
    }
    radii_.assign(count, kRadius);
  }

  [[nodiscard]] Boxes boxes() const {
    Boxes boxes{spline_.points, spline_.points};
    for (std::size_t j = 0; j < spline_.joint_count(); ++j) {
      const Joint& joint = robot_.group_joint(static_cast<int>(j));
      const bool wraps = joint.type == JointType::continuous;
      for (std::size_t i = 0; i < radii_.size(); ++i) {
        double &lower = boxes.lower[j][i], &upper = boxes.upper[j][i];
        const double least = lower - kLeastRoom, most = upper + kLeastRoom;
        lower -= radii_[i];
        upper += radii_[i];
        if (!wraps) lower = std::min(std::max(lower, joint.lower), least);
        if (!wraps) upper = std::max(std::min(upper, joint.upper), most);
      }
    }
    return boxes;
  }

  /// Notes control points of pieces that do not pass; false if there are none.
  bool find_failures(const TimeSpline& spline) {
    has_failed_.assign(spline.count(), false);
    bool has_any = false;
    for (std::size_t i = 0; i < spline.piece_count(); ++i) {
      if (passes(chords_of(spline, i))) continue;
      has_any = true;
      for (std::size_t k = 0; k <= TimeSpline::kFixed; ++k) has_failed_[i + k] = true;
    }
    return has_any;
  }

  [[nodiscard]] bool passes(const Chords& chords) const {
    std::vector<float> states;
    for (const Configuration& q : chords.states) states.insert(states.end(), q.begin(), q.end());
    for (std::size_t i = 1; i < chords.states.size(); ++i) {
      if (!is_chord_near(chords.states[i - 1], chords.states[i])) return false;
    }
    CheckCounters counters;
    return verifier_.is_curve_free(states, chords.bow, counters);
  }
  /// A chord whose ends are near one leg is near it.
  [[nodiscard]] bool is_chord_near(const Configuration& from, const Configuration& to) const {
    return std::ranges::any_of(legs_.legs, [&](const Leg& leg) {
      return is_near(leg, from, tolerance_) && is_near(leg, to, tolerance_);
    });
  }

  [[nodiscard]] Trajectory to_trajectory() const {
    std::vector<Trajectory::Stretch> stretches;
    const std::size_t joints = spline_.joint_count();
    for (std::size_t i = 0; i < spline_.piece_count(); ++i) {
      Trajectory::Stretch stretch{static_cast<double>(i) * spline_.step_s,
                                  std::vector<double>(4 * joints)};
      for (std::size_t j = 0; j < joints; ++j) {
        const auto piece = spline_.piece(j, i);
        for (std::size_t k = 0; k < 4; ++k) stretch.coefficients[k * joints + j] = piece[k];
      }
      stretches.push_back(std::move(stretch));
    }
    return {std::move(stretches), legs_.end, spline_.duration_s()};
  }

  const Robot& robot_;
  const Legs& legs_;
  double tolerance_;
  int rounds_;
  const MotionVerifier& verifier_;
  TimeBarrier barrier_;
  TimeSpline spline_;
  std::vector<double> radii_;  ///< per control point
  std::vector<bool> has_failed_;
};

}  // namespace

Trajectory shorten_time(const Robot& robot, Trajectory motion, const Legs& legs,
                        const RateLimits& limits, const TrajectorySettings& settings,
                        const MotionVerifier& verifier) {
  if (!(motion.duration_s() > 0) || settings.time_rounds == 0) return motion;
  return TimeShortener(robot, legs, limits, settings, verifier).shorten(std::move(motion));
}

}  // namespace mneme::internal
