// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Answers of memory that replace a search or end it early.
#pragma once

#include "pipeline/resolve_goals.h"

#include <cstdint>
#include <optional>

namespace mneme::internal {

/// The path of a known task, or the failure of a remembered search. Memory is asked once, at the
/// time that Query::ask_after says. Replay goes by the same path whenever it is asked.
class KnownAnswer final : public SearchLimit {
 public:
  /// Refers to its arguments.
  KnownAnswer(const ResolvedQuery& resolved, Replay& report);

  /// Asks memory if it is due before the search. Returns false if it has answered.
  [[nodiscard]] bool needs_search();
  /// Asks memory once it is due. Returns false from then on if it has answered.
  [[nodiscard]] bool may_go_on(std::uint64_t iterations) override;
  /// Asks memory if it was not yet, as when a search ended before it was due.
  void ask_at_last();
  [[nodiscard]] bool has_answered() const { return answer_.has_value(); }
  /// Returns the answer, with the work of the search that it has ended.
  [[nodiscard]] PlanResult take(const PlanResult& search);
  /// Adds the work of asking in vain; the iterations of repairs are in the report.
  void add_work(PlanResult& search) const;

 private:
  void ask();
  [[nodiscard]] PlanResult replay(const KindSettings& kind);
  void book(const KindSettings& kind) const;

  const Query& query_;
  const ResolvedQuery& resolved_;
  Replay& report_;
  bool is_asked_;
  bool was_asked_within_ = false;  ///< while the clock of the search ran
  PlanResult in_vain_;             ///< the work without an answer
  std::optional<PlanResult> answer_;
};

}  // namespace mneme::internal
