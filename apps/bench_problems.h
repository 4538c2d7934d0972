// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The problems that `mneme bench run` is given: files, single problems and directories.
#pragma once

#include <string>
#include <vector>

#include "mneme/problem.h"

namespace mneme::app {

struct BenchProblem {
  std::string set;    ///< of the problem, for tables
  std::string where;  ///< what load_problem takes
};

/// The problems of `arguments`, in order. A compact file stands for all its problems, and a
/// directory for all problems below it, sorted by path. A set is a file of many problems, or a
/// directory of files of one.
[[nodiscard]] Result<std::vector<BenchProblem>> find_bench_problems(
    const std::vector<std::string>& arguments);

}  // namespace mneme::app
