// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Names like one that was misspelt.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Number of letters to insert, delete or replace to make `b` of `a`, whatever their case.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);

/// The `count` names that take the least edits to `name`, nearest first.
[[nodiscard]] std::vector<std::string> close_names(const std::string& name,
                                                   std::vector<std::string> names,
                                                   std::size_t count);

}  // namespace mneme::internal
