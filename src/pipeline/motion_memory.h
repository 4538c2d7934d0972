// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The local motions of a query's memory.
#pragma once

#include "memory/local_motions.h"
#include "pipeline/resolve_goals.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Motions of the memory that a search has found.
struct FoundMotions {
  std::string_view kind;     ///< version of the kind; empty without motions
  MotionPlaces places;       ///< of the motions that were looked for
  std::uint64_t states = 0;  ///< checked to find them
  std::uint64_t saved = 0;   ///< states that finding the motions of the path once took
};

/// Looks for places of the memory's motions in the query's scene, those that were dear to find
/// first. Motions whose places are known come at once.
class MotionMemory final : public MotionSource {
 public:
  /// Refers to the query. Reads nothing before it is first used.
  explicit MotionMemory(const ResolvedQuery& resolved) : resolved_(resolved) {}

  /// True if the query's memory and sampler make use of motions.
  [[nodiscard]] static bool is_used(const Query& query);

  bool find_more(std::vector<PlacedMotion>& placed, CheckCounters& counters) override;
  [[nodiscard]] bool knows_places() const override;
  [[nodiscard]] double trust() const override;
  void report(std::uint64_t states, std::span<const int> followed) override;
  /// Returns what the search has found.
  [[nodiscard]] FoundMotions take_found() { return std::move(found_); }

 private:
  struct Row {
    ContentHash content;
    std::shared_ptr<const Experience> experience;
  };

  void load(std::vector<PlacedMotion>& placed);
  void place(std::size_t row, const std::vector<float>& places,
             std::vector<PlacedMotion>& placed) const;

  const ResolvedQuery& resolved_;
  std::optional<MotionFinder> finder_;  ///< empty until the first use
  std::vector<Row> rows_;               ///< all motions; those with known places first
  std::size_t next_ = 0;
  FoundMotions found_;
};

}  // namespace mneme::internal
