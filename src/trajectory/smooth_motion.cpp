// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The average of positions over a window of time keeps the motion's limits of velocity and
// acceleration, because its derivatives are averages, too. Its jerk is a difference of two
// accelerations over the window. By Taylor's theorem it deviates by at most
// acceleration window^2 / 24.
#include "trajectory/speed_profile.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

constexpr double kLeastWindow = 1e-4;  ///< seconds; shorter windows are lost to rounding
constexpr double kSlower = 0.75;       ///< factor on accelerations per attempt
/// Deviation of verified chords from the motion: a share of the tolerance, and at least radians.
constexpr double kChordError = 1.0 / 128, kLeastChordError = 2e-5;

double find_window(const RateLimits& limits) {
  double window = kLeastWindow;
  for (std::size_t j = 0; j < limits.jerk.size(); ++j) {
    window = std::max(window, 2 * limits.acceleration[j] / limits.jerk[j]);
  }
  return window;
}

/// Bounds the distance of the average from the motion.
double find_deviation(const RateLimits& limits) {
  return norm(limits.acceleration) * std::pow(find_window(limits), 2) / 24;
}

/// False also for a parabola between parallel legs.
bool is_bent(const Curve& curve) {
  return std::ranges::any_of(curve.bend, [](double bend) { return bend != 0; });
}

/// Replaces a parabola by the corner that it rounds.
void stop_at(RoundedPath& path, std::size_t i) {
  const Curve& curve = path.curves[i];
  Curve in{curve.begin, curve.direction, {}, curve.length / 2, curve.begins_at_rest};
  Curve out{in.begin, in.direction, {}, in.length, true};
  for (std::size_t j = 0; j < curve.begin.size(); ++j) {
    out.begin[j] = in.value(j, in.length);
    out.direction[j] = curve.slope(j, curve.length);
  }
  path.curves[i] = std::move(in);
  path.curves.insert(path.curves.begin() + static_cast<std::ptrdiff_t>(i) + 1, std::move(out));
}

/// From the end, so that earlier indices stay valid.
void stop_at_all(RoundedPath& path, std::size_t first, std::size_t last) {
  for (std::size_t i = last + 1; i-- > first;) {
    if (is_bent(path.curves[i])) stop_at(path, i);
  }
}

struct Average {
  Followed followed;
  double window_s = 0;
  std::vector<double> accelerations;  ///< the limits that it keeps
};

/// Lowers accelerations for as long as the shorter window makes the motion faster.
Average follow_fastest_average(const RoundedPath& path, RateLimits limits, double tolerance) {
  const bool may_deviate = std::ranges::none_of(path.curves, is_bent);
  std::optional<Average> best;
  for (;;) {
    if (may_deviate || find_deviation(limits) <= tolerance) {
      const double window = find_window(limits);
      Followed followed = follow_fastest(path, limits, window);
      const double duration_s = followed.motion.duration_s();
      if (best && duration_s >= best->followed.motion.duration_s()) return *std::move(best);
      best = {std::move(followed), window, limits.acceleration};
    }
    for (double& acceleration : limits.acceleration) acceleration *= kSlower;
  }
}

/// Stops at all corners if that is faster than slowing down to keep the tolerance.
void forgo_slow_corners(RoundedPath& path, const RateLimits& limits, double tolerance) {
  if (path.curves.empty() || find_deviation(limits) <= tolerance) return;
  RoundedPath stopping = path;
  stop_at_all(stopping, 0, path.curves.size() - 1);
  const auto duration_s = [&](const RoundedPath& rounded) {
    return follow_fastest_average(rounded, limits, tolerance).followed.motion.duration_s();
  };
  if (duration_s(stopping) < duration_s(path)) path = std::move(stopping);
}

/// Consecutive curves whose averages may overlap. Times are those of the average.
struct Stretch {
  std::size_t first = 0, last = 0;
  double begin_s = 0, end_s = 0;
};

/// The stretches at which the average may leave the path.
std::vector<Stretch> find_bent(const RoundedPath& path, const Average& average) {
  const std::vector<double>& begins_s = average.followed.begins_s;
  std::vector<Stretch> bent;
  for (std::size_t i = 0; i < path.curves.size(); ++i) {
    if (!is_bent(path.curves[i])) continue;
    const double begin_s = begins_s[i], end_s = begins_s[i + 1] + average.window_s;
    if (bent.empty() || bent.back().end_s < begin_s) bent.push_back({i, i, begin_s, end_s});
    bent.back().last = i;
    bent.back().end_s = end_s;
  }
  return bent;
}

bool is_free(const Average& average, const Stretch& stretch, double tolerance,
             const MotionVerifier& verifier) {
  // The motion deviates from a chord over dt by at most acceleration dt^2 / 8.
  const double duration_s = stretch.end_s - stretch.begin_s;
  const double error = std::max(kChordError * tolerance, kLeastChordError);
  const double longest_s = std::sqrt(8 * error / norm(average.accelerations));
  const int count = static_cast<int>(std::ceil(duration_s / longest_s));
  const double dt = duration_s / count;
  std::vector<float> states, bow;
  for (int i = 0; i <= count; ++i) {
    const Configuration q = average.followed.motion.at(stretch.begin_s + i * dt).position;
    states.insert(states.end(), q.begin(), q.end());
  }
  for (const double acceleration : average.accelerations) {
    bow.push_back(static_cast<float>(acceleration * dt * dt / 8));
  }
  CheckCounters counters;
  return verifier.is_curve_free(states, bow, counters);
}

}  // namespace

bool has_jerk_limit(const RateLimits& limits) {
  return std::ranges::any_of(limits.jerk, [](double jerk) { return std::isfinite(jerk); });
}

Trajectory follow_smoothly(RoundedPath path, const RateLimits& limits, double tolerance,
                           const MotionVerifier* verifier) {
  forgo_slow_corners(path, limits, tolerance);
  for (;;) {
    Average average = follow_fastest_average(path, limits, tolerance);
    const std::vector<Stretch> bent = find_bent(path, average);
    bool has_passed = true;
    for (std::size_t k = bent.size(); k-- > 0;) {
      if (is_free(average, bent[k], tolerance, *verifier)) continue;
      has_passed = false;
      stop_at_all(path, bent[k].first, bent[k].last);
    }
    if (has_passed) return std::move(average.followed.motion);
  }
}

}  // namespace mneme::internal
