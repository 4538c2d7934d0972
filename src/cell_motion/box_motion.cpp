// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell_motion/box_motion.h"

#include "bent_path/bent_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::size_t kTerms = std::tuple_size_v<TimedShare>;
/// Motions are proven as straight ones between states this far apart, seconds.
constexpr double kProofStep = 0.005;
constexpr std::uint64_t kMostStates = 100000;
/// Bounds are found in this number of parts of a stretch.
constexpr int kParts = 4;
/// Slower than bounds ask for by this share, for rounding.
constexpr double kRounding = 1e-9;

/// The same polynomial from `later_s` on.
TimedShare begin_later(TimedShare terms, double later_s) {
  for (std::size_t first = 0; first < kTerms; ++first) {
    for (std::size_t i = kTerms - 1; i-- > first;) terms[i] += later_s * terms[i + 1];
  }
  return terms;
}

double value_at(const TimedShare& terms, double time_s) {
  double value = 0;
  for (std::size_t i = kTerms; i-- > 0;) value = value * time_s + terms[i];
  return value;
}

TimedShare derivative(const TimedShare& terms) {
  TimedShare result = {};
  for (std::size_t i = 1; i < kTerms; ++i) result[i - 1] = static_cast<double>(i) * terms[i];
  return result;
}

/// Bounds of a polynomial from 0 to `end_s`: its least and greatest Bernstein coefficient.
std::pair<double, double> bounds_of(TimedShare terms, double end_s) {
  double power = 1, choices = 1;  // of kTerms - 1
  for (std::size_t i = 0; i < kTerms; ++i) {
    terms[i] *= power / choices;
    power *= end_s;
    choices *= static_cast<double>(kTerms - 1 - i) / static_cast<double>(i + 1);
  }
  for (std::size_t first = 1; first < kTerms; ++first) {
    for (std::size_t i = kTerms - 1; i >= first; --i) terms[i] += terms[i - 1];
  }
  const auto [least, most] = std::ranges::minmax(terms);
  return {least, most};
}

/// The motion of a joint in a stretch with `change` times its share.
TimedShare terms_of(const Trajectory::Stretch& stretch, const TimedShare& share, std::size_t joint,
                    std::size_t joints, double change) {
  TimedShare terms;
  for (std::size_t i = 0; i < kTerms; ++i) {
    const std::size_t at = i * joints + joint;
    terms[i] =
        change * share[i] + (at < stretch.coefficients.size() ? stretch.coefficients[at] : 0);
  }
  return terms;
}

double length_of(const Trajectory& motion, std::size_t stretch) {
  const auto& stretches = motion.stretches();
  const bool is_last = stretch + 1 == stretches.size();
  return (is_last ? motion.duration_s() : stretches[stretch + 1].begin_s) -
         stretches[stretch].begin_s;
}

/// Greatest change of each joint's goal in a box, by its model and rest.
JointVector widest_change(const GoalShift& shift) {
  const std::size_t joints = shift.constant.size();
  JointVector widest = JointVector::Zero(std::ssize(shift.constant));
  for (std::size_t j = 0; j < joints; ++j) {
    double& sum = widest[static_cast<Eigen::Index>(j)];
    sum = std::abs(double{shift.constant[j]}) + shift.rest[j];
    for (std::size_t i = j; i < shift.slopes.size(); i += joints) {
      sum += std::abs(double{shift.slopes[i]});
    }
    for (std::size_t i = j; i < shift.curvatures.size(); i += joints) {
      sum += 0.5 * std::abs(double{shift.curvatures[i]});
    }
  }
  return widest;
}

/// Greatest derivatives of first to third order of a joint in a stretch, for all changes of up to
/// `widest`.
std::array<double, 3> rates_of(const BoxMotion& motion, std::size_t stretch, std::size_t joint,
                               const JointVector& widest) {
  const Trajectory::Stretch& along = motion.middle.stretches()[stretch];
  const auto joints = static_cast<std::size_t>(widest.size());
  const double part_s = length_of(motion.middle, stretch) / kParts;
  const double greatest_change = widest[static_cast<Eigen::Index>(joint)];
  std::array<double, 3> most = {};
  for (const double change : {-greatest_change, greatest_change}) {
    TimedShare terms = terms_of(along, motion.shares[stretch], joint, joints, change);
    for (int part = 0; part < kParts; ++part, terms = begin_later(terms, part_s)) {
      TimedShare rate = terms;
      for (double& greatest : most) {
        rate = derivative(rate);
        const auto [least, largest] = bounds_of(rate, part_s);
        greatest = std::max({greatest, -least, largest});
      }
    }
  }
  return most;
}

/// The factor by which the motion must be slower, so that all bent ones keep the limits.
double find_slowing(const BoxMotion& motion, const JointVector& widest, const RateLimits& limits) {
  double slowing = 1;
  for (std::size_t i = 0; i < motion.shares.size(); ++i) {
    for (std::size_t j = 0; j < limits.velocity.size(); ++j) {
      const auto rates = rates_of(motion, i, j, widest);
      slowing = std::max(
          {slowing, rates[0] / limits.velocity[j], std::sqrt(rates[1] / limits.acceleration[j])});
      if (!limits.jerk.empty()) slowing = std::max(slowing, std::cbrt(rates[2] / limits.jerk[j]));
    }
  }
  return slowing * (1 + kRounding);
}

BoxMotion slowed(const BoxMotion& motion, double factor) {
  std::vector<Trajectory::Stretch> stretches = motion.middle.stretches();
  std::vector<TimedShare> shares = motion.shares;
  const double duration_s = motion.middle.duration_s();
  Configuration end = motion.middle.at(duration_s).position;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    stretches[i].begin_s *= factor;
    double scale = 1;
    for (std::size_t k = 0; k < stretches[i].coefficients.size(); ++k) {
      if (k > 0 && k % end.size() == 0) scale /= factor;
      stretches[i].coefficients[k] *= scale;
    }
    scale = 1;
    for (double& term : shares[i]) {
      term *= scale;
      scale /= factor;
    }
  }
  return {Trajectory(std::move(stretches), std::move(end), duration_s * factor), std::move(shares)};
}

/// Times at which a motion has gone shares `from` and `to` of its length.
std::pair<double, double> times_at(const Trajectory& motion, double from, double to) {
  const double duration_s = motion.duration_s();
  const int steps = 1 + static_cast<int>(duration_s / kProofStep);
  std::vector<double> lengths = {0};
  JointVector before = to_vector(motion.at(0).position);
  for (int i = 1; i <= steps; ++i) {
    const JointVector q = to_vector(motion.at(duration_s * i / steps).position);
    lengths.push_back(lengths.back() + (q - before).norm());
    before = q;
  }
  const auto time_of = [&](double share) {
    const auto found = std::ranges::lower_bound(lengths, share * lengths.back());
    const auto step = std::min<std::ptrdiff_t>(found - lengths.begin(), steps);
    return duration_s * static_cast<double>(step) / steps;
  };
  return {time_of(from), to >= 1 ? duration_s : time_of(to)};
}

/// Lets the share rise smoothly: at `spread` 0 while the motion goes where the path's shares rise,
/// at 1 all the time. In between the bend begins earlier and ends later than at 0.
BoxMotion spread_smoothly(const Trajectory& motion, const BentPath& path, double spread) {
  double length = 0, from = 0, to = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += (path.waypoint(i) - path.waypoint(i - 1)).norm();
    if (path.shares[i] == 0) from = length;
    if (path.shares[i - 1] < 1) to = length;
  }
  auto [from_s, to_s] = times_at(motion, from / length, to / length);
  // A bend within one step of times would have no finite rates: the whole motion bends instead.
  from_s *= 1 - spread;
  to_s += spread * (motion.duration_s() - to_s);
  if (!(from_s < to_s)) std::tie(from_s, to_s) = std::pair(0.0, motion.duration_s());
  TimedShare rise = {0, 0, 0, 10, -15, 6};
  for (std::size_t i = 3; i < kTerms; ++i) rise[i] /= std::pow(to_s - from_s, i);
  const std::array ends = {0.0, from_s, to_s, motion.duration_s()};
  std::vector<Trajectory::Stretch> stretches;
  std::vector<TimedShare> shares;
  for (std::size_t part = 0; part + 1 < ends.size(); ++part) {
    const Trajectory piece = motion.between(ends[part], ends[part + 1]);
    for (Trajectory::Stretch stretch : piece.stretches()) {
      shares.push_back(part == 1 ? begin_later(rise, stretch.begin_s)
                                 : TimedShare{part == 0 ? 0.0 : 1.0});
      stretch.begin_s += ends[part];
      stretches.push_back(std::move(stretch));
    }
  }
  const double duration_s = motion.duration_s();
  return {Trajectory(std::move(stretches), motion.at(duration_s).position, duration_s),
          std::move(shares)};
}

/// The limits less what the bend of a motion needs of them, for the motion to the middle.
RateLimits room_beside(const BoxMotion& motion, const JointVector& widest,
                       const RateLimits& limits) {
  std::array<double, 3> most = {};
  for (std::size_t i = 0; i < motion.shares.size(); ++i) {
    TimedShare rate = motion.shares[i];
    for (double& greatest : most) {
      rate = derivative(rate);
      const auto [least, largest] = bounds_of(rate, length_of(motion.middle, i));
      greatest = std::max({greatest, -least, largest});
    }
  }
  constexpr double kLeastRoom = 0.2;
  RateLimits room = limits;
  for (std::size_t j = 0; j < limits.velocity.size(); ++j) {
    const double change = widest[static_cast<Eigen::Index>(j)];
    const auto narrow = [&](double& limit, double rate) {
      limit = std::max(kLeastRoom * limit, limit - rate * change);
    };
    narrow(room.velocity[j], most[0]);
    narrow(room.acceleration[j], most[1]);
    if (!room.jerk.empty()) narrow(room.jerk[j], most[2]);
  }
  return room;
}

/// States of the motion `step_s` apart, as a path of many waypoints.
BentPath chain_of(const BoxMotion& motion, int steps, double step_s) {
  const auto& stretches = motion.middle.stretches();
  BentPath chain;
  std::size_t stretch = 0;
  for (int i = 0; i <= steps; ++i) {
    const double time_s = i * step_s;
    while (stretch + 1 < stretches.size() && stretches[stretch + 1].begin_s <= time_s) ++stretch;
    for (const double value : motion.middle.at(time_s).position) {
      chain.rows.push_back(static_cast<float>(value));
    }
    const double share = value_at(motion.shares[stretch], time_s - stretches[stretch].begin_s);
    chain.shares.push_back(static_cast<float>(std::clamp(share, 0.0, 1.0)));
  }
  return chain;
}

/// Bounds how far, metres, the robot is from straight motions between states of the chain.
double bow_of(const CollisionChecker& checker, const BoxMotion& motion, const BentPath& chain,
              const JointVector& widest, double step_s) {
  std::vector<float> least, most, bow;
  for (std::size_t j = 0; j < static_cast<std::size_t>(widest.size()); ++j) {
    double second = 0;
    for (std::size_t i = 0; i < motion.shares.size(); ++i) {
      second = std::max(second, rates_of(motion, i, j, widest)[1]);
    }
    bow.push_back(static_cast<float>(second * step_s * step_s / 8));
    const auto change = static_cast<float>(widest[static_cast<Eigen::Index>(j)]);
    float low = chain.row(0)[j], high = low;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      low = std::min(low, chain.row(i)[j]);
      high = std::max(high, chain.row(i)[j]);
    }
    least.push_back(low - change);
    most.push_back(high + change);
  }
  return checker.displacement_bound(least, most, bow);
}

/// Proves all bent motions: as straight ones between states, with more margin.
bool prove_motion(const CellData& data, const CellBox& box, const JointVector& widest,
                  const BoxMotion& motion) {
  if (!data.make_tools()) return false;
  const double duration_s = motion.middle.duration_s();
  const int steps = 1 + static_cast<int>(duration_s / kProofStep);
  const double step_s = duration_s / steps;
  const BentPath chain = chain_of(motion, steps, step_s);
  const double bow = bow_of(data.tools().checker, motion, chain, widest, step_s);
  ProofSettings settings;
  settings.margin = static_cast<float>(data.margin + bow);
  settings.most_states = kMostStates;
  settings.has_trials = false;
  ProofFailure failure;
  CheckCounters counters;
  return prove(data.tools().checker, chain, box.shift, settings, failure, counters);
}

/// The path, shortened in time as far as the verifier allows. It ends in the same turn.
Path shortened(const Path& path, const RateLimits& limits, const MotionVerifier& verifier) {
  constexpr std::uint64_t kSeed = 1;
  ShortenEffort effort;
  effort.minimize_time = true;
  effort.limits = &limits;
  CheckCounters counters;
  Path shorter = path;
  shorten(verifier.checker(), shorter, kSeed, effort, &verifier, counters);
  shorter = unwrapped(verifier.checker().robot(), std::move(shorter), path.front());
  constexpr double kSameGoal = 1e-6;
  const double off = (to_vector(shorter.back()) - to_vector(path.back())).norm();
  if (!(off < kSameGoal)) return path;
  shorter.back() = path.back();
  return shorter;
}

/// Looks for the fastest motion of a box that is proven.
class BoxTimer {
 public:
  BoxTimer(const CellData& data, const CellBox& box, const RateLimits& limits,
           const MotionVerifier& verifier)
      : data_(data),
        box_(box),
        limits_(limits),
        verifier_(verifier),
        widest_(widest_change(box.shift)) {}

  /// `path` leads to the middle of the box. Returns nothing if no motion is proven.
  std::optional<BoxMotion> run(const Path& path, const TrajectorySettings& settings) {
    constexpr int kHalvings = 3, kRounds = 3;
    const Robot& robot = data_.region.problem.robot;
    const auto first = parameterize(robot, path, limits_, settings, &verifier_);
    if (!first || !consider(*first, 0)) return std::nullopt;
    // A bend takes less of the limits the longer it lasts.
    double spread = 0, beyond = 1;
    if (consider(*first, 1)) spread = 1;
    for (int i = 0; i < kHalvings && spread < 1; ++i) {
      const double between = 0.5 * (spread + beyond);
      (consider(*first, between) ? spread : beyond) = between;
    }
    // What the bend takes slows down the joints and times that need it, not the whole motion.
    for (int i = 0; i < kRounds; ++i) {
      const RateLimits room = room_beside(*best_, widest_, limits_);
      const auto motion = parameterize(robot, path, room, settings, &verifier_);
      if (!motion || !consider(*motion, spread)) break;
    }
    return std::exchange(best_, std::nullopt);
  }

 private:
  /// Keeps the motion, with this spread of its bend, if it is the fastest that is proven.
  bool consider(const Trajectory& motion, double spread) {
    if (motion.stretches().empty()) return false;
    BoxMotion timed = spread_smoothly(motion, box_.path, spread);
    timed = slowed(timed, find_slowing(timed, widest_, limits_));
    const bool is_faster =
        !best_ || timed.middle.duration_s() < best_->middle.duration_s() * (1 - kLeastGain);
    if (!is_faster || !prove_motion(data_, box_, widest_, timed)) return false;
    best_ = std::move(timed);
    return true;
  }

  static constexpr double kLeastGain = 0.002;

  const CellData& data_;
  const CellBox& box_;
  const RateLimits& limits_;
  const MotionVerifier& verifier_;
  JointVector widest_;
  std::optional<BoxMotion> best_;
};

}  // namespace

std::optional<Trajectory> BoxMotion::bent(const LinkChain& chain, const JointVector& change) const {
  const auto joints = static_cast<std::size_t>(change.size());
  std::vector<Trajectory::Stretch> stretches;
  stretches.reserve(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const Trajectory::Stretch& along = middle.stretches()[i];
    std::vector<double> coefficients(kTerms * joints);
    for (std::size_t j = 0; j < joints; ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      const TimedShare terms = terms_of(along, shares[i], j, joints, change[row]);
      const auto [least, most] = bounds_of(terms, length_of(middle, i));
      if (least < chain.lower()[row] || most > chain.upper()[row]) return std::nullopt;
      for (std::size_t k = 0; k < kTerms; ++k) coefficients[k * joints + j] = terms[k];
    }
    stretches.push_back({along.begin_s, std::move(coefficients)});
  }
  const double duration_s = middle.duration_s();
  JointVector end = to_vector(middle.at(duration_s).position) + change;
  return Trajectory(std::move(stretches), to_configuration(end), duration_s);
}

std::optional<BoxMotion> time_box(const CellData& data, const CellBox& box,
                                  const Configuration& start, const RateLimits& limits,
                                  const TrajectorySettings& settings,
                                  const MotionVerifier& verifier) {
  const Robot& robot = data.region.problem.robot;
  Path path = {start};
  for (std::size_t i = 1; i < box.path.size(); ++i) {
    path.push_back(to_configuration(box.path.waypoint(i)));
  }
  // Continuous joints that turn by pi or more would go the other way.
  constexpr double kSameTurn = 1;
  const JointVector shortest = to_vector(unwrapped(robot, path, start).back());
  if ((shortest - to_vector(path.back())).norm() > kSameTurn) return std::nullopt;
  constexpr double kNear = 0.1;
  TrajectorySettings near = settings;
  near.time_rounds = 0;
  near.path_tolerance = std::min(settings.path_tolerance, kNear);
  BoxTimer timer(data, box, limits, verifier);
  // Paths of boxes keep far from obstacles, so that boxes are large. Faster ones may serve, too.
  std::optional<BoxMotion> best = timer.run(shortened(path, limits, verifier), settings);
  std::optional<BoxMotion> usual = timer.run(path, settings);
  const auto duration_of = [](const std::optional<BoxMotion>& timed) {
    return timed ? timed->middle.duration_s() : std::numeric_limits<double>::infinity();
  };
  if (duration_of(usual) < duration_of(best)) best = std::move(usual);
  return best ? std::move(best) : timer.run(path, near);
}

}  // namespace mneme::internal
