// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Searches the notes of a result.
#pragma once

#include "mneme/pipeline.h"

#include "support/support.h"

#include <algorithm>
#include <string>

namespace mneme::test {

inline bool has_note(const SolveResult& result, const std::string& text) {
  return std::ranges::any_of(result.notes,
                             [&](const std::string& note) { return contains(note, text); });
}

}  // namespace mneme::test
