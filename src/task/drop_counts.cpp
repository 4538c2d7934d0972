// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/drop_counts.h"

#include "base/as_index.h"

#include <fmt/format.h>

#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

/// The alternatives that drops at the stage count: its own, or those of the choice near it.
std::string describe_choice(const Task& task, const Group& group, int stage) {
  const auto count_of = [&](int i) { return count_alternatives(task.stages[as_index(i)]); };
  if (const int count = count_of(stage); count > 0) {
    return count > 1 ? fmt::format(" of {} alternatives", count) : "";
  }
  const int count = group.anchor ? count_of(*group.anchor) : 0;
  if (count < 2) return "";
  return fmt::format(" {} {} alternatives of '{}'", stage < *group.anchor ? "before" : "after",
                     count, stage_name(task, *group.anchor));
}

}  // namespace

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

int count_alternatives(const Stage& stage) {
  return static_cast<int>(stage.goals.size() + stage.poses.poses.size());
}

std::string describe_drops(const Task& task, const Group& group, const DropCounts& drops) {
  std::vector<int> stages = group.local;
  if (group.move) stages.insert(stages.begin(), *group.move);
  std::string text;
  for (const int stage : stages) {
    const std::vector<Dropped> all = drops.of_stage(stage);
    if (all.empty()) continue;
    text += fmt::format("{}stage '{}'{}", text.empty() ? "" : "; ", stage_name(task, stage),
                        describe_choice(task, group, stage));
    std::string reasons;
    for (const Dropped& dropped : all) {
      reasons += reasons.empty() ? ": " : ", ";
      if (dropped.count > 1) reasons += fmt::format("{} times ", dropped.count);
      reasons += to_string(dropped.reason);
      if (!dropped.what.empty()) reasons += fmt::format(" ({})", dropped.what);
    }
    text += reasons;
  }
  return text;
}

}  // namespace mneme::internal
