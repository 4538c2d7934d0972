// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/merge_rows.h"

#include "experience/store_writes.h"

#include <algorithm>

namespace mneme::internal {

Result<void> merge_rows(Store& target, std::span<const Experience> rows, MergeSummary& summary) {
  return append_rows(target, rows, Duplicates::keep_earliest).map([&](const Appended& appended) {
    const auto added = std::ranges::count(appended.is_new, true);
    summary.read += static_cast<std::int64_t>(rows.size());
    summary.replaced += appended.replaced_count;
    summary.added += added - appended.replaced_count;
  });
}

}  // namespace mneme::internal
