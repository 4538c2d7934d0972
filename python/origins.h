// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The files that robots, scenes and memories were read from, which outputs must not replace.
/// Thread-safe.
#pragma once

#include "mneme/report.h"

#include "problem.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme::python {

/// Stores the files of `object` for its lifetime.
void set_origin(const std::weak_ptr<const void>& object, std::vector<ReadFile> files);
/// Returns the files of `object`; none if it was not read from files.
[[nodiscard]] std::vector<ReadFile> origin_of(const std::weak_ptr<const void>& object);

/// Raises the error of check_outputs() if `output` is a file of the problems or one of
/// `memory_files`. `what`: the role of the problems' files in messages.
void check_output(const std::string& output, std::span<const SharedProblem> problems,
                  std::vector<ReadFile> memory_files, std::string_view what);

}  // namespace mneme::python
