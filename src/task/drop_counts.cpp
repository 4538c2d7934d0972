// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/drop_counts.h"

#include "base/as_index.h"

#include <tuple>
#include <utility>

namespace mneme::internal {

void DropCounts::add(int stage, const Failure& failure, int alternative) {
  Entry& entry = stages_[as_index(stage)][static_cast<std::size_t>(failure.reason)];
  ++entry.times;
  entry.alternatives.insert(alternative);
  if (!failure.what.empty()) ++entry.whats[failure.what];
}

std::vector<Dropped> DropCounts::of_stage(int stage, int chosen) const {
  std::vector<Dropped> all;
  for (std::size_t i = 0; i < kDropReasons; ++i) {
    const Entry& entry = stages_[as_index(stage)][i];
    const bool has_chosen = chosen >= 0 && entry.alternatives.contains(chosen);
    const auto count = static_cast<int>(entry.alternatives.size()) - (has_chosen ? 1 : 0);
    if (count == 0) continue;
    Dropped dropped{static_cast<DropReason>(i), count, {}};
    int most = 0;
    for (const auto& [what, times] : entry.whats) {
      if (times > most) std::tie(most, dropped.what) = std::pair(times, what);
    }
    all.push_back(std::move(dropped));
  }
  return all;
}

bool DropCounts::wants_what(int stage, DropReason reason) const {
  constexpr int kNamed = 4;
  return stages_[as_index(stage)][static_cast<std::size_t>(reason)].times < kNamed;
}

}  // namespace mneme::internal
