// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads the rows that were added since a known state, and verifies that none is missing.
#pragma once

#include "store/store.h"

#include <set>

namespace mneme::internal {

/// Counts rows and tombstones as they are read, for comparison with the store's head.
class Tally {
 public:
  explicit Tally(const StoreState& since) : found_(since) {}
  void add(const StoredRow& row);
  void add(const Tombstone& tombstone);
  /// Counts and digests of everything read so far.
  [[nodiscard]] const StoreState& found() const { return found_; }
  /// Difference from `head` in words: rows missing, added or renumbered. Nothing if equal.
  [[nodiscard]] std::optional<std::string> compare(const StoreState& head) const;

 private:
  StoreState found_;
};

/// Changes of a store since a known state.
struct StoreChanges {
  StoreState state;
  bool is_complete = false;     ///< all rows were read, not only new ones
  std::set<std::int64_t> dead;  ///< all dead rows, including newly dead ones
};

/// Visits the live rows added after `since` in one snapshot; all live rows if some may have been
/// deleted. Error: corrupt if count or checksums differ from what was inserted.
[[nodiscard]] Result<StoreChanges> read_changes(Store& store, const StoreState& since,
                                                RowParts parts, const RowVisitor& visit);

}  // namespace mneme::internal
