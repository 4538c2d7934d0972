// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include "base/threads.h"
#include "path/waypoints.h"
#include "robot/joint_space.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace mneme {
namespace {

/// Shortening checks states half as densely where verification follows, with a margin that makes up
/// for it.
constexpr double kCoarseRefinement = 0.5;
constexpr double kCoarseMargin = 3e-3;  ///< metres
/// Shortening comes before verification until the finisher has checked this many states more than
/// the planner: about a millisecond.
constexpr std::uint64_t kStatesOfGrace = 40000;
/// Planning again is faster than more repairs than this.
constexpr int kMostRepairs = 4;

/// Repairs motions that fail by a waypoint nearby.
class Repair {
 public:
  Repair(const CollisionChecker& checker, const MotionVerifier& verifier, std::uint64_t seed,
         CheckCounters& counters, const std::function<bool()>& must_stop)
      : checker_(checker),
        verifier_(verifier),
        space_(checker.robot()),
        rng_(seed),
        counters_(counters),
        must_stop_(must_stop) {}

  /// A waypoint between both ends whose motions pass, or an empty vector.
  std::vector<float> find_waypoint(std::span<const float> from, std::span<const float> to,
                                   MotionEnds ends) {
    const std::vector<float> middle = find_blocked_middle(from, to, ends);
    const std::size_t joints = middle.size();
    std::vector<float> candidates(kCandidates * joints);
    std::array<std::uint8_t, kCandidates> is_free;
    for (double sigma = 0.01; sigma < 0.2 && !must_stop_(); sigma *= 2) {
      const std::vector<float> sigmas = internal::joint_deviations(checker_.robot(), sigma);
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        const std::size_t j = i % joints;
        const float value = middle[j] + sigmas[j] * rng_.bell();
        candidates[i] = space_.into_limits(static_cast<int>(j), value);
      }
      checker_.check_states(candidates, is_free, counters_);
      for (std::size_t i = 0; i < kCandidates && !must_stop_(); ++i) {
        const std::span<const float> q(candidates.data() + i * joints, joints);
        if (is_free[i] != 0 && passes(from, q, to, ends)) return {q.begin(), q.end()};
      }
    }
    return {};
  }

 private:
  static constexpr std::size_t kCandidates = 16;

  /// The cheap checks come first.
  bool passes(std::span<const float> from, std::span<const float> q, std::span<const float> to,
              MotionEnds ends) {
    const MotionDetail coarse{1, ends.is_first || ends.is_last ? 0 : kVerificationMargin};
    return checker_.is_motion_valid(from, q, counters_, coarse) &&
           checker_.is_motion_valid(q, to, counters_, coarse) &&
           verifier_.is_free(from, q, {ends.is_first, false}, counters_) &&
           verifier_.is_free(q, to, {false, ends.is_last}, counters_);
  }

  std::vector<float> find_blocked_middle(std::span<const float> from, std::span<const float> to,
                                         MotionEnds ends) {
    constexpr int kParts = 16;
    std::vector<float> delta(from.size()), begin(from.size()), end(from.begin(), from.end());
    space_.difference(from.data(), to.data(), delta.data());
    const auto write = [&](float fraction, std::vector<float>& q) {
      for (std::size_t j = 0; j < q.size(); ++j) q[j] = from[j] + fraction * delta[j];
    };
    int first = kParts, last = 0;
    for (int i = 0; i < kParts && !must_stop_(); ++i) {
      begin = end;
      write(static_cast<float>(i + 1) / kParts, end);
      const MotionEnds part{ends.is_first && i == 0, ends.is_last && i + 1 == kParts};
      if (verifier_.is_free(begin, end, part, counters_)) continue;
      first = std::min(first, i);
      last = i + 1;
    }
    if (first == kParts) first = 0, last = kParts;
    write(0.5f * static_cast<float>(first + last) / kParts, begin);
    return begin;
  }

  const CollisionChecker& checker_;
  const MotionVerifier& verifier_;
  internal::JointSpace space_;
  Rng rng_;
  CheckCounters& counters_;
  const std::function<bool()>& must_stop_;
};

}  // namespace

PathFinisher::PathFinisher(const CollisionChecker& checker, const FinishSettings& settings)
    : checker_(checker),
      settings_(settings),
      verifier_(checker, settings.verification),
      is_coarse_(settings.verification != Verification::none && !checker.robot().is_planar()) {}

int PathFinisher::operator()(Path& path, CheckCounters& counters) {
  const std::uint64_t states = counters.states;
  const std::uint64_t planning = states - std::min(states, states_);
  const bool is_verified_first = has_refused_often() || states_ > planning + kStatesOfGrace;
  const int invalid = finish(path, is_verified_first, counters);
  states_ += counters.states - states;
  if (invalid >= 0) ++refused_count_;
  return invalid;
}

/// Verifies the shortened path first, which nearly always passes and costs less; the planned path
/// only if that fails.
int PathFinisher::finish(Path& path, bool is_verified_first, CheckCounters& counters) {
  const bool is_shortened_first = settings_.simplify && !is_verified_first;
  if (is_shortened_first) {
    Path shorter = shorten(path, settings_.patience, nullptr, counters);
    if (verify_or_mend(shorter, counters) < 0) {
      path = std::move(shorter);
      return -1;
    }
  }
  if (const int invalid = verify_or_mend(path, counters); invalid >= 0) return invalid;
  if (!settings_.simplify) return -1;
  // Full shortening has failed verification already: now waypoints are only dropped.
  Path shorter = is_shortened_first ? shorten(path, 0, &verifier_, counters)
                                    : shorten(path, settings_.patience, nullptr, counters);
  if (verify_or_mend(shorter, counters) < 0) path = std::move(shorter);
  return -1;
}

std::string PathFinisher::describe_refused() const {
  if (refused_count_ == 0) return {};
  return "; verification refused " + std::to_string(refused_count_) +
         (refused_count_ == 1 ? " path" : " paths");
}

Path PathFinisher::shorten(Path path, int patience, const MotionVerifier* verifier,
                           CheckCounters& counters) {
  // Half of the remaining time is for verification.
  const double begin_s = stopwatch_.elapsed_s();
  const double end_s = 0.5 * (begin_s + settings_.timeout_s);
  ShortenEffort effort;
  effort.patience = patience;
  effort.minimize_time = settings_.minimize_time;
  effort.limits = settings_.limits.get();
  if (is_coarse_) {
    effort.refinement = kCoarseRefinement;
    effort.margin = kCoarseMargin;
  }
  mneme::shorten(checker_, path, derive_seed(settings_.seed, 1), effort, verifier, counters,
                 [&] { return must_stop_at(end_s); });
  simplification_time_s_ += stopwatch_.elapsed_s() - begin_s;
  return path;
}

int PathFinisher::verify_or_mend(Path& path, CheckCounters& counters) {
  if (settings_.verification == Verification::none) return -1;
  const double begin_s = stopwatch_.elapsed_s();
  int invalid = verifier_.find_invalid_motion(path, counters);
  if (invalid >= 0) invalid = mend(path, invalid, counters);
  verification_time_s_ += stopwatch_.elapsed_s() - begin_s;
  return invalid;
}

/// -1, or the index of the first motion that fails; the path is then unchanged.
int PathFinisher::mend(Path& path, int invalid, CheckCounters& counters) {
  const std::function<bool()> must_stop = [this] { return must_stop_at(settings_.timeout_s); };
  Repair repair(checker_, verifier_, derive_seed(settings_.seed, 2), counters, must_stop);
  Path mended = path;
  std::vector<int> motion_of(path.size());
  std::iota(motion_of.begin(), motion_of.end(), 0);
  for (int i = 0; i < kMostRepairs && invalid >= 0; ++i) {
    const MotionEnds ends{invalid == 0, invalid + 2 == static_cast<int>(mended.size())};
    const auto from = mended.begin() + invalid;
    const std::vector<float> q =
        repair.find_waypoint(internal::to_floats(from[0]), internal::to_floats(from[1]), ends);
    if (q.empty()) break;
    mended.insert(from + 1, checker_.robot().normalized(Configuration(q.begin(), q.end())));
    const int planned = motion_of[static_cast<std::size_t>(invalid)];
    motion_of.insert(motion_of.begin() + invalid, planned);
    invalid = verifier_.find_invalid_motion(mended, counters);
  }
  if (invalid >= 0) return motion_of[static_cast<std::size_t>(invalid)];
  path = std::move(mended);
  return -1;
}

bool PathFinisher::must_stop_at(double end_s) const {
  return internal::is_set(settings_.cancel) || stopwatch_.elapsed_s() >= end_s;
}

}  // namespace mneme
