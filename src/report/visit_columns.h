// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The columns of a benchmark's rows, declared once for CSV and SQLite.
#pragma once

#include "mneme/report.h"

namespace mneme::internal {

/// Calls `visit(name, value)` for every column after problem, set, planner, sampler, seed, status
/// and is_valid, in order.
template <class Row, class Visitor>
void visit_columns(Row& row, Visitor&& visit) {
  visit("planning_time_s", row.planning_time_s);
  visit("total_time_s", row.total_time_s);
  visit("retrieval_time_s", row.retrieval_time_s);
  visit("simplification_time_s", row.simplification_time_s);
  visit("verification_time_s", row.verification_time_s);
  visit("iterations", row.iterations);
  visit("states_checked", row.states_checked);
  visit("motions_checked", row.motions_checked);
  visit("nodes", row.nodes);
  visit("path_length", row.path_length);
  visit("components", row.components);
  visit("timeout_s", row.timeout_s);
  visit("setting", row.setting);
  visit("settings", row.settings);
  visit("learning_time_s", row.learning_time_s);
  visit("isa", row.isa);
  visit("machine", row.machine);
  visit("version", row.version);
  visit("started", row.started);
}

}  // namespace mneme::internal
