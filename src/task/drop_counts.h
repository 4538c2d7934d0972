// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Why alternatives were dropped.
#pragma once

#include "task/follow.h"
#include "task/groups.h"

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace mneme::internal {

/// Counts dropped alternatives per stage and reason: each once, however often the search meets it.
class DropCounts {
 public:
  explicit DropCounts(std::size_t stages) : stages_(stages) {}
  /// `alternative` is an index among those of the stage, or of the choice that the stage follows;
  /// negative: there is none.
  void add(int stage, const Failure& failure, int alternative);
  /// Leaves `chosen` out: it was dropped together with other choices only.
  [[nodiscard]] std::vector<Dropped> of_stage(int stage, int chosen = -1) const;
  /// True for the first few of a stage and reason: naming bodies costs more than most tests.
  [[nodiscard]] bool wants_what(int stage, DropReason reason) const;

 private:
  struct Entry {
    int times = 0;
    std::set<int> alternatives;
    std::map<std::string, int> whats;
  };
  std::vector<std::array<Entry, kDropReasons>> stages_;
};

/// Returns the number of configurations, regions and poses of a stage.
[[nodiscard]] int count_alternatives(const Stage& stage);

/// Returns the stages of a group at which alternatives were dropped, with the reasons; empty if
/// there are none.
[[nodiscard]] std::string describe_drops(const Task& task, const Group& group,
                                         const DropCounts& drops);

}  // namespace mneme::internal
