// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The planner in a page: its module, and the files that it opens.
#pragma once

#include "mneme/live.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace mneme::internal {

/// Returns the files of robot and problem that the module opens, and the address of the problem
/// among them.
[[nodiscard]] nlohmann::ordered_json planner_json(const Problem& problem);
/// Returns the elements of a page that hold the module.
[[nodiscard]] std::string planner_elements(const PlannerModule& module);

}  // namespace mneme::internal
