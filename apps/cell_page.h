// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The trace of a cell's path, with the region as coloured boxes.
#pragma once

#include "mneme/cell.h"
#include "mneme/report.h"

namespace mneme::app {

/// Returns the trace of the path to the proven task that is nearest to the region's middle, for
/// to_page(). Columns of the region are green where all tasks are proven, red where the link is in
/// contact in all, and yellow to the share that is not proven. Errors: invalid without a proven
/// task; those of make_trace().
[[nodiscard]] Result<PlanTrace> trace_cell(const Cell& cell, std::size_t start);

}  // namespace mneme::app
