// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Adding rows from elsewhere.
#pragma once

#include "experience/store.h"

#include <span>

namespace mneme::internal {

/// Adds rows that `target` does not have, in one transaction, and counts them. The rows must be
/// sound.
[[nodiscard]] Result<void> merge_rows(Store& target, std::span<const Experience> rows,
                                      MergeSummary& summary);

}  // namespace mneme::internal
