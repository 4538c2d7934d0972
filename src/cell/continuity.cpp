// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell.h"
#include "mneme/path.h"

#include "base/as_index.h"
#include "cell/cell_data.h"

#include <algorithm>
#include <functional>

namespace mneme {
namespace {

/// Paths are compared at this number of equal shares of their lengths.
constexpr int kPlaces = 16;
/// Tasks on both sides of a face are this far from it, relative to the box.
constexpr double kBeside = 1e-6;

/// States at equal shares of the path's length.
internal::JointPath places_of(const Path& path) {
  internal::JointPath states;
  for (const Configuration& q : path) states.push_back(internal::to_vector(q));
  const std::vector<double> lengths = internal::arc_lengths(states);
  internal::JointPath places;
  std::size_t i = 1;
  for (int place = 0; place <= kPlaces; ++place) {
    const double at = lengths.back() * place / kPlaces;
    while (i + 1 < path.size() && lengths[i] < at) ++i;
    const double along = lengths[i] - lengths[i - 1];
    const double share = along > 0 ? std::clamp((at - lengths[i - 1]) / along, 0.0, 1.0) : 1;
    places.emplace_back(states[i - 1] + share * (states[i] - states[i - 1]));
  }
  return places;
}

/// Largest difference of a joint between paths at equal shares of their lengths.
double change_between(const Path& a, const Path& b) {
  const internal::JointPath as = places_of(a), bs = places_of(b);
  double most = 0;
  for (std::size_t i = 0; i < as.size(); ++i) {
    most = std::max(most, (as[i] - bs[i]).cwiseAbs().maxCoeff());
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
