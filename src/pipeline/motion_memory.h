// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The local motions of a query's memory.
#pragma once

#include "memory/local_motions.h"
#include "pipeline/resolve_goals.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace mneme::internal {

/// Looks for places of the memory's motions in the query's scene, those that were dear to find
/// first. Motions whose places are known come at once.
class MotionMemory final : public MotionSource {
 public:
  /// Refers to the query. Reads nothing before it is first used.
  explicit MotionMemory(const ResolvedQuery& resolved) : resolved_(resolved) {}

  /// True if the query's memory and sampler make use of motions.
  [[nodiscard]] static bool is_used(const Query& query);

  bool find_more(std::vector<std::vector<float>>& placed, CheckCounters& counters) override;
  /// Returns the places of the motions that were looked for.
  [[nodiscard]] MotionPlaces take_found() { return std::move(found_); }

 private:
  struct Row {
    ContentHash content;
    std::shared_ptr<const Experience> experience;
  };

  void load(std::vector<std::vector<float>>& placed);
  void place(const RememberedPath& motion, const std::vector<float>& places,
             std::vector<std::vector<float>>& placed) const;

  const ResolvedQuery& resolved_;
  std::optional<MotionFinder> finder_;  ///< empty until the first use
  std::vector<Row> rows_;               ///< without known places
  std::size_t next_ = 0;
  MotionPlaces found_;
};

}  // namespace mneme::internal
