// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/cell_limits.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Ends loops that rounding might keep alive: each step finds another line, and there are few.
constexpr int kMaxSteps = 64;
constexpr double kRounding = 1e-12;

}  // namespace

void CellLimits::add(double at_begin, double at_end, double bound) {
  strips_.push_back({at_begin, at_end, bound});
}

CellLimits::Range CellLimits::begins(double end) const {
  Range range{{0, 0}, {most_begin_, 0}};
  for (const Strip& strip : strips_) {
    if (std::abs(strip.at_begin) <= kRounding * std::abs(strip.at_end)) continue;
    const double slope = -strip.at_end / strip.at_begin;
    const double width = strip.bound / std::abs(strip.at_begin);
    const double middle = slope * end;
    if (middle + width < range.most.value) range.most = {middle + width, slope};
    if (middle - width > range.least.value) range.least = {middle - width, slope};
  }
  return range;
}

/// The greatest end up to `end` that is feasible with some begin.
double CellLimits::shrink_to_feasible(double end) const {
  for (const Strip& strip : strips_) {
    if (std::abs(strip.at_begin) > kRounding * std::abs(strip.at_end)) continue;
    end = std::min(end, strip.bound / std::abs(strip.at_end));
  }
  for (int i = 0; i < kMaxSteps && end > 0; ++i) {
    const auto [least, most] = begins(end);
    if (least.value <= most.value + kRounding * std::abs(least.value)) break;
    // To the intersection of the two lines that contradict each other here.
    end = std::max(0.0, end - (least.value - most.value) / (least.slope - most.slope));
  }
  return end;
}

CellLimits::Pair CellLimits::greatest_begin(double most_end) const {
  double high = shrink_to_feasible(std::min(most_end, most_end_));
  Line falling = begins(high).most;
  if (falling.slope >= 0) return {falling.value, high};
  double low = 0;
  Line rising = begins(low).most;
  if (rising.slope <= 0) return {rising.value, low};
  // The minimum of the lines is concave: its maximum is where a rising line meets a falling one.
  for (int i = 0; i < kMaxSteps; ++i) {
    const double gap = falling.value - falling.slope * (high - low) - rising.value;
    const double end = std::clamp(low + gap / (rising.slope - falling.slope), low, high);
    const Line line = begins(end).most;
    const double expected = rising.value + rising.slope * (end - low);
    if (line.slope == 0 || line.value >= expected * (1 - kRounding)) return {line.value, end};
    (line.slope > 0 ? low : high) = end;
    (line.slope > 0 ? rising : falling) = line;
  }
  return {begins(low).most.value, low};
}

double CellLimits::greatest_end(double begin, double most_end) const {
  double end = std::min(most_end, most_end_);
  for (const Strip& strip : strips_) {
    if (strip.at_end == 0) continue;
    const double sign = strip.at_end > 0 ? 1 : -1;
    end = std::min(end, (strip.bound - sign * strip.at_begin * begin) / std::abs(strip.at_end));
  }
  return end;
}

}  // namespace mneme::internal
