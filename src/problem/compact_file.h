// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Compact files: many problems of one robot as JSON.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The value of `json`, with lines; `source` names it in messages. Throws InputFailure.
[[nodiscard]] InputValue parse_json(std::string_view json, const std::string& source);

/// FILE.json and NAME of "FILE.json#NAME"; without a file of that extension, nothing.
struct CompactAddress {
  std::string path;
  std::string name;  ///< empty if not given
};
[[nodiscard]] std::optional<CompactAddress> split_address(const std::string& where);

/// The scene of one problem, and the frame that the file names. Throws InputFailure.
[[nodiscard]] FramedScene extract_compact_scene(const CompactAddress& address);

/// Throws InputFailure.
[[nodiscard]] Problem read_compact_problem(const CompactAddress& address,
                                           const ProblemOptions& options);

}  // namespace mneme::internal
