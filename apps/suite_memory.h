// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The memories of a suite, learned where they are not there yet.
#pragma once

#include <string>
#include <vector>

#include "bench_runs.h"

namespace mneme::app {

/// The database of `memory`: its file, or `directory`/NAME.db if it is learned.
[[nodiscard]] std::string memory_file(const SuiteMemory& memory, const std::string& directory);

/// Learns into the file `path` what is not there yet, in `jobs` threads; `row` is told what it took
/// and what there is now. `known` are the memories of an earlier run; their times stand for what is
/// not learned again. False if it was interrupted.
[[nodiscard]] Result<bool> learn_memory(const SuiteMemory& memory, const std::string& path,
                                        int jobs, const std::vector<MemoryRow>& known,
                                        MemoryRow& row);

/// Gives those of `cases` whose planner is Lightning or Thunder the experience of the paths that
/// their memory is learned from: `directory`/MEMORY.Lightning, kept if it is there. False if it was
/// interrupted. Errors: a memory that is not learned from problems.
[[nodiscard]] Result<bool> train_experiences(const Suite& suite, const std::string& directory,
                                             std::vector<BenchCase>& cases);

}  // namespace mneme::app
