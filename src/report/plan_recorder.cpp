// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

namespace mneme {

PlanRecorder::PlanRecorder(const TraceSettings& settings)
    : uniform_(settings.samples), memory_(settings.samples), edges_(settings.edges) {}

void PlanRecorder::on_sample(std::span<const float> q, Origin origin) {
  ++draws_[origin];
  Thinned<Sample>& samples = origin == kUniformOrigin ? uniform_ : memory_;
  if (samples.counts_next()) samples.add({origin, {q.begin(), q.end()}});
}

void PlanRecorder::on_edge(std::span<const float> from, std::span<const float> to, int graph) {
  if (edges_.counts_next()) {
    edges_.add({graph, {from.begin(), from.end()}, {to.begin(), to.end()}});
  }
}

}  // namespace mneme
