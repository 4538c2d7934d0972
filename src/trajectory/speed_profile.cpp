// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/speed_profile.h"

#include "trajectory/cell_limits.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace mneme::internal {
namespace {

constexpr int kCells = 16;  ///< per parabola

/// A straight curve, or a part of a parabola of constant path acceleration.
struct Cell {
  const Curve* curve = nullptr;
  double begin = 0, length = 0;  ///< arc lengths on the curve
  double cap = 0;                ///< limit of the squared path speed on a straight curve
  double acceleration = 0;       ///< greatest path acceleration on a straight curve
  CellLimits limits{0, 0};       ///< limits on a part of a parabola
};

/// Squared path speed at the begin of each cell and at the end of the last one.
using Profile = std::vector<double>;

Cell straight_cell(const Curve& curve, const RateLimits& limits) {
  double speed = kNoLimit, acceleration = kNoLimit;
  for (std::size_t j = 0; j < curve.direction.size(); ++j) {
    const double share = std::abs(curve.direction[j]);
    if (share == 0) continue;
    speed = std::min(speed, kRoom * limits.velocity[j] / share);
    acceleration = std::min(acceleration, kRoom * limits.acceleration[j] / share);
  }
  return {&curve, 0, curve.length, speed * speed, acceleration, CellLimits(0, 0)};
}

/// The slope of a joint at both ends of a cell.
struct Slopes {
  double first = 0, last = 0;
};

/// Squared path speeds at both ends of a cell such that, linear in between, the joint never exceeds
/// `velocity`. Where q' keeps its sign v^2 / q'^2 is convex, so that its tangent is below it.
CellLimits::Pair most_speeds(const Slopes& slopes, double velocity) {
  constexpr double kSteepest = 0.5;  // of lines, so that they stay well above 0
  const double middle = 0.5 * (slopes.first + slopes.last);
  const double change = slopes.last - slopes.first;
  if (std::abs(change) < kSteepest * std::abs(middle)) {
    const double most = std::pow(velocity / middle, 2), tilt = change / middle;
    return {most * (1 + tilt), most * (1 - tilt)};
  }
  const double steepest = std::max(std::abs(slopes.first), std::abs(slopes.last));
  if (steepest == 0) return {kNoLimit, kNoLimit};
  const double most = std::pow(velocity / steepest, 2);
  return {most, most};
}

/// A joint's acceleration is q' u + q'' x, with path acceleration u = (b - a) / 2h in a cell of
/// length h and squared path speed x.
Cell bent_cell(const Curve& curve, double begin, double length, const RateLimits& limits) {
  const auto slopes = [&](std::size_t joint) {
    return Slopes{curve.slope(joint, begin), curve.slope(joint, begin + length)};
  };
  CellLimits::Pair most{kNoLimit, kNoLimit};
  for (std::size_t j = 0; j < curve.direction.size(); ++j) {
    const CellLimits::Pair own = most_speeds(slopes(j), kRoom * limits.velocity[j]);
    most = {std::min(most.begin, own.begin), std::min(most.end, own.end)};
  }
  CellLimits pairs(most.begin, most.end);
  for (std::size_t j = 0; j < curve.direction.size(); ++j) {
    const auto [first, last] = slopes(j);
    const double bend = 2 * length * curve.bend[j];
    const double bound = 2 * length * kRoom * limits.acceleration[j];
    pairs.add(bend - first, first, bound);
    pairs.add(-last, bend + last, bound);
  }
  return {&curve, begin, length, 0, 0, std::move(pairs)};
}

std::vector<Cell> make_cells(const RoundedPath& path, const RateLimits& limits) {
  std::vector<Cell> cells;
  for (const Curve& curve : path.curves) {
    if (curve.is_straight()) {
      cells.push_back(straight_cell(curve, limits));
      continue;
    }
    const double length = curve.length / kCells;
    for (int i = 0; i < kCells; ++i) cells.push_back(bent_cell(curve, i * length, length, limits));
  }
  return cells;
}

bool begins_at_rest(const Cell& cell) { return cell.begin == 0 && cell.curve->begins_at_rest; }

/// Backward pass: the fastest speeds from which the end of the path can be reached, and the speeds
/// at the ends of the cells that belong to them.
struct Controllable {
  Profile fastest;
  std::vector<double> ends;
};

Controllable find_controllable(std::span<const Cell> cells) {
  Controllable found{Profile(cells.size() + 1, 0.0), std::vector<double>(cells.size(), 0.0)};
  for (std::size_t i = cells.size(); i-- > 0;) {
    const Cell& cell = cells[i];
    const double next = found.fastest[i + 1];
    const CellLimits::Pair pair =
        cell.curve->is_straight()
            ? CellLimits::Pair{std::min(cell.cap, next + 2 * cell.length * cell.acceleration), next}
            : cell.limits.greatest_begin(next);
    found.fastest[i] = begins_at_rest(cell) ? 0 : pair.begin;
    found.ends[i] = pair.end;
  }
  return found;
}

/// Forward pass: as fast as possible within the controllable speeds.
Profile find_profile(std::span<const Cell> cells) {
  const Controllable controllable = find_controllable(cells);
  Profile profile(cells.size() + 1, 0.0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell& cell = cells[i];
    const double begin = profile[i], most = controllable.fastest[i + 1];
    if (cell.curve->is_straight()) {
      profile[i + 1] = std::min({cell.cap, most, begin + 2 * cell.length * cell.acceleration});
      continue;
    }
    // Limits are convex: a slower begin allows the same share of the end, in spite of rounding.
    const double fastest = controllable.fastest[i];
    const double share = fastest > 0 ? std::min(1.0, begin / fastest) : 0;
    profile[i + 1] = std::max(share * controllable.ends[i], cell.limits.greatest_end(begin, most));
  }
  return profile;
}

/// Joins stretches.
class Motion {
 public:
  void add(const Cell& cell, double begin, double end) {
    if (cell.curve->is_straight()) {
      add_straight(cell, begin, end);
    } else {
      add(*cell.curve, cell.begin, std::sqrt(begin), 0.5 * (end - begin) / cell.length,
          2 * cell.length / (std::sqrt(begin) + std::sqrt(end)));
    }
  }

  [[nodiscard]] Trajectory finish(Configuration end) && {
    return {std::move(stretches_), std::move(end), time_s_};
  }

 private:
  /// Accelerates, continues at the greatest speed if that is reached, and decelerates.
  void add_straight(const Cell& cell, double begin, double end) {
    const double a = cell.acceleration;
    const double peak =
        std::max({begin, end, std::min(cell.cap, 0.5 * (begin + end) + a * cell.length)});
    const double first = std::sqrt(begin), most = std::sqrt(peak), last = std::sqrt(end);
    const double faster = 0.5 * (peak - begin) / a, slower = 0.5 * (peak - end) / a;
    const double steady = std::max(0.0, cell.length - faster - slower);
    add(*cell.curve, 0, first, a, (most - first) / a);
    add(*cell.curve, faster, most, 0, steady / most);
    add(*cell.curve, cell.length - slower, most, -a, (most - last) / a);
  }

  /// Constant path acceleration: the position is a polynomial of fourth degree in time.
  void add(const Curve& curve, double from, double speed, double acceleration, double time_s) {
    if (!(time_s > 0)) return;
    const std::size_t joints = curve.begin.size();
    Trajectory::Stretch stretch{time_s_,
                                std::vector<double>((curve.is_straight() ? 3 : 5) * joints)};
    for (std::size_t j = 0; j < joints; ++j) {
      const auto of_power = [&](std::size_t power) -> double& {
        return stretch.coefficients[power * joints + j];
      };
      const double slope = curve.slope(j, from);
      of_power(0) = curve.value(j, from);
      of_power(1) = slope * speed;
      of_power(2) = 0.5 * slope * acceleration;
      if (curve.is_straight()) continue;
      of_power(2) += 0.5 * curve.bend[j] * speed * speed;
      of_power(3) = 0.5 * curve.bend[j] * speed * acceleration;
      of_power(4) = 0.125 * curve.bend[j] * acceleration * acceleration;
    }
    stretches_.push_back(std::move(stretch));
    time_s_ += time_s;
  }

  std::vector<Trajectory::Stretch> stretches_;
  double time_s_ = 0;
};

}  // namespace

Trajectory follow_fastest(const RoundedPath& path, const RateLimits& limits) {
  const std::vector<Cell> cells = make_cells(path, limits);
  const Profile profile = find_profile(cells);
  Motion motion;
  for (std::size_t i = 0; i < cells.size(); ++i) motion.add(cells[i], profile[i], profile[i + 1]);
  return std::move(motion).finish(path.end);
}

}  // namespace mneme::internal
