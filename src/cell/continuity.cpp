// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell.h"
#include "mneme/path.h"

#include "base/as_index.h"
#include "cell/cell_data.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace mneme {
namespace {

/// Paths are compared at this number of equal shares of their lengths.
constexpr int kPlaces = 16;
/// Tasks on both sides of a face are this far from it, relative to the box.
constexpr double kBeside = 1e-6;

/// States at equal shares of the path's length.
std::vector<Configuration> places_of(const Path& path) {
  std::vector<double> lengths = {0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const internal::JointVector step =
        internal::to_vector(path[i]) - internal::to_vector(path[i - 1]);
    lengths.push_back(lengths.back() + step.norm());
  }
  std::vector<Configuration> places;
  std::size_t i = 1;
  for (int place = 0; place <= kPlaces; ++place) {
    const double at = lengths.back() * place / kPlaces;
    while (i + 1 < path.size() && lengths[i] < at) ++i;
    const double along = lengths[i] - lengths[i - 1];
    const double share = along > 0 ? std::clamp((at - lengths[i - 1]) / along, 0.0, 1.0) : 1;
    Configuration q = path[i - 1];
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += share * (path[i][j] - q[j]);
    places.push_back(std::move(q));
  }
  return places;
}

/// Largest difference of a joint between paths at equal shares of their lengths.
double change_between(const Path& a, const Path& b) {
  const std::vector<Configuration> as = places_of(a), bs = places_of(b);
  double most = 0;
  for (std::size_t i = 0; i < as.size(); ++i) {
    for (std::size_t j = 0; j < as[i].size(); ++j) {
      most = std::max(most, std::abs(as[i][j] - bs[i][j]));
    }
  }
  return most;
}

}  // namespace

CellContinuity Cell::continuity(std::size_t start, double least) const {
  CellContinuity result;
  const internal::StartCell& cell = data_->starts[start];
  CellAnswer inside, beyond;
  for (const internal::CellBox& box : cell.boxes) {
    for (const int k : data_->frame.varying()) {
      // Each face once, from below.
      CellTask task = box.tasks.center;
      const auto i = internal::as_index(k);
      task[i] += box.tasks.half[i] * (1 - kBeside);
      look_up(task, inside, start);
      task[i] += box.tasks.half[i] * 2 * kBeside;
      if (inside.tier != CellTier::certified || !data_->frame.whole().contains(task)) continue;
      look_up(task, beyond, start);
      if (beyond.tier != CellTier::certified || beyond.box == inside.box) continue;
      ++result.faces;
      const double change = change_between(inside.path, beyond.path);
      if (change >= least) result.jumps.push_back({task, inside.box, beyond.box, change});
    }
  }
  std::ranges::stable_sort(result.jumps, std::greater(), &CellJump::change);
  return result;
}

}  // namespace mneme
