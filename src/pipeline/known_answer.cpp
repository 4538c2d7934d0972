// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/known_answer.h"

#include "pipeline/unsolved.h"
#include "replay/replay.h"

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

/// Looking for a known task in vain, and storing another path, takes about as long as checking this
/// number of states.
constexpr std::uint64_t kStatesPerQuestion = 600;
/// Share of what replay saves in long searches that pays for asking before short ones. A hit after
/// kAlone iterations shows that tasks repeat, not that asking early pays.
constexpr std::uint64_t kLateHitsPerCredit = 4;

void add_counts(const PlanResult& work, PlanResult& all) {
  all.states_checked += work.states_checked;
  all.motions_checked += work.motions_checked;
}

}  // namespace

KnownAnswer::KnownAnswer(const ResolvedQuery& resolved, Replay& report)
    : query_(resolved.query),
      resolved_(resolved),
      report_(report),
      is_asked_(query_.database == nullptr || resolved.refusal.has_value()) {}

bool KnownAnswer::needs_search() {
  if (!query_.ask_after && !is_asked_) ask();
  return !has_answered();
}

bool KnownAnswer::may_go_on(std::uint64_t iterations) {
  if (!is_asked_ && iterations >= query_.ask_after.value_or(0)) {
    was_asked_within_ = true;
    ask();
  }
  return !has_answered();
}

void KnownAnswer::ask_at_last() {
  if (!is_asked_) ask();
}

void KnownAnswer::ask() {
  is_asked_ = true;
  const KindSettings* kind = query_.replayed_kind();
  if (kind != nullptr && query_.settings.plan.timeout_s > 0) {
    PlanResult replayed = replay(*kind);
    book(*kind);
    (replayed.is_solved() ? answer_.emplace() : in_vain_) = std::move(replayed);
  }
  if (has_answered()) return;
  answer_ = find_unsolved(query_);
  if (!has_answered()) return;
  add_counts(in_vain_, *answer_);
  answer_->planning_time_s = report_.time_s;
}

PlanResult KnownAnswer::replay(const KindSettings& kind) {
  PlanSettings settings = query_.settings.plan;
  settings.timeout_s = query_.remaining_s();
  const MemoryQuery ends = memory_query(query_.problem, resolved_.ends.start, resolved_.ends.goals);
  return internal::replay({*query_.database, *kind.kind, kind.max_gap, kind.replay, ends,
                           resolved_.ends, resolved_.checker, resolved_.cell.get(), settings},
                          report_);
}

void KnownAnswer::book(const KindSettings& kind) const {
  if (!query_.may_change_memory()) return;
  const std::uint64_t saved =
      report_.is_hit() ? std::max(report_.planning_states, report_.states) : 0;
  const bool is_late = query_.ask_after.value_or(0) > 0;
  query_.database->book(kind.kind->version, is_late ? 0 : kStatesPerQuestion + report_.states,
                        is_late ? saved / kLateHitsPerCredit : saved);
}

PlanResult KnownAnswer::take(const PlanResult& search) {
  PlanResult answer = *std::exchange(answer_, std::nullopt);
  add_counts(search, answer);
  answer.iterations += search.iterations;
  answer.nodes = search.nodes;
  answer.planning_time_s += search.planning_time_s;
  if (was_asked_within_) answer.planning_time_s -= report_.time_s;
  return answer;
}

void KnownAnswer::add_work(PlanResult& search) const {
  add_counts(in_vain_, search);
  if (!was_asked_within_) search.planning_time_s += report_.time_s;
}

}  // namespace mneme::internal
