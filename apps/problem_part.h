// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A part of a list of problems, so that some can be learned from and the others measured.
#pragma once

#include <string>
#include <vector>

#include "bench_problems.h"

namespace mneme::app {

/// "I/N": every N-th of `problems` beginning with the I-th, 1 <= I <= N; all of them if `part` is
/// empty.
[[nodiscard]] Result<std::vector<BenchProblem>> take_part(std::vector<BenchProblem> problems,
                                                          const std::string& part);

}  // namespace mneme::app
