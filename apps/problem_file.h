// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Compact files of problems that generators write.
#pragma once

#include "mneme/problem.h"

#include <nlohmann/json.hpp>

#include <string>

namespace mneme::app {

/// What a file calls `robot`: a name stays a name; a path must hold from wherever the file will be
/// read.
[[nodiscard]] std::string robot_reference(const std::string& robot);

/// Adds `problem` to a file of problems of one robot, which the first one begins; returns its
/// entry.
nlohmann::ordered_json& append_problem(const Problem& problem, const std::string& robot,
                                       nlohmann::ordered_json& file);

}  // namespace mneme::app
