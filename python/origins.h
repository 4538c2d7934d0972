// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which files the robots, scenes and memories of Python were read from, so that no output replaces
/// them. Parallel-safe.
#pragma once

#include "mneme/experience.h"
#include "mneme/report.h"

#include "problem.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme::python {

/// Keeps what `object` was read from for as long as it lives.
void set_origin(const std::weak_ptr<const void>& object, std::vector<ReadFile> files);
/// What set_origin was told of `object`; nothing if it was not read from files.
[[nodiscard]] std::vector<ReadFile> origin_of(const std::weak_ptr<const void>& object);

/// Raises what check_outputs() says of `output` beside what the problems and the memory, which may
/// be null, were read from. `what` is what it calls the problems' files.
void check_output(const std::string& output, std::span<const SharedProblem> problems,
                  const std::shared_ptr<Database>& memory, std::string_view what);

}  // namespace mneme::python
