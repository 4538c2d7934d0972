// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading a store: what came since the last time, and whether all of it is there.
#pragma once

#include "store/store.h"

#include <set>

namespace mneme::internal {

/// Follows rows and tombstones as they are read, and compares them with what must be there.
class Tally {
 public:
  explicit Tally(const StoreState& since) : found_(since) {}
  void add(const StoredRow& row);
  void add(const Tombstone& tombstone);
  /// Counts and digests of all that was read.
  [[nodiscard]] const StoreState& found() const { return found_; }
  /// What is missing, or came, or changed its id, if anything did.
  [[nodiscard]] std::optional<std::string> compare(const StoreState& head) const;

 private:
  StoreState found_;
};

/// What changed in a store.
struct StoreChanges {
  StoreState state;
  bool is_complete = false;     ///< all rows were read, not only new ones
  std::set<std::int64_t> dead;  ///< rows that are dead by now, new ones included
};

/// Visits the live rows that came since `since`, or all of them if rows may have vanished in the
/// meantime, in one snapshot. Errors: corrupt if number or checksums of the rows are not those that
/// were inserted.
[[nodiscard]] Result<StoreChanges> read_changes(Store& store, const StoreState& since,
                                                RowParts parts, const RowVisitor& visit);

}  // namespace mneme::internal
