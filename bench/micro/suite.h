// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tools that the micro-benchmarks share. One file per room registers its own benchmarks.
#pragma once

#include "mneme/robot.h"

#include "micro/edges.h"

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

namespace mneme::bench {

/// The instruction sets of this machine, best first.
[[nodiscard]] std::vector<Isa> measured_isas();

/// Registers `body` to be repeated: of a shared machine, the least time counts. `per_item` names
/// what one of the `items` of an iteration is; its time is reported as the counter s/<per_item>.
void register_repeated(const std::string& name, const std::string& per_item,
                       const std::function<std::uint64_t()>& body);

void register_collision(const std::vector<Edges>& recorded);
void register_nearest(const Robot& robot);
void register_random();
void register_cvae(const Problem& problem);
#ifdef MNEME_WITH_OMPL
void register_ompl(const Robot& robot);
#endif

}  // namespace mneme::bench
