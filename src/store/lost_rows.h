// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Detects acknowledged rows that a database file no longer holds, which SQLite itself cannot: it
/// takes a damaged write-ahead log, or one cut short, for the end of what was committed.
#pragma once

#include "store/store.h"

#include <optional>
#include <string>

namespace mneme::internal {

/// The state that the last acknowledged commit left, kept in `FILE.tally`, and with the file's path
/// in an extended attribute of the file, which stays with a file that is renamed or moved.
struct StateRecord {
  StoreState state;
  std::int64_t time = 0;    ///< time of that commit, seconds since 1970
  bool is_settled = false;  ///< the log was merged into the file afterwards; the file may be
                            ///< replaced
  /// Path of the file at that commit, if it was renamed since; empty if not.
  std::string former_path = {};
};

/// The path of a database file with symbolic links followed, also of one that is missing.
[[nodiscard]] std::string real_path(const std::string& path);
/// Path of a database's record, next to the target of a symbolic link.
[[nodiscard]] std::string record_path(const std::string& path);
/// Path of a database's write-ahead log, next to the target of a symbolic link.
[[nodiscard]] std::string log_path(const std::string& path);
/// Records the state of an acknowledged commit. Does not wait for the disk: after a loss of power
/// the record may be an old one, which hides a loss but never reports a false one. An error is
/// ignored. Cost: about 10 us.
void record_state(const std::string& path, const StoreState& state);
/// Notes that a file was closed, if its log is merged: a copy that replaces it later is not
/// compared with the record, except an empty one.
void settle_record(const std::string& path);
/// The record of a file that was renamed is that of its attribute. Nothing if the record is missing
/// or damaged, and for a renamed file on a file system without extended attributes.
[[nodiscard]] std::optional<StateRecord> read_record(const std::string& path);

/// Why a record that exists tells nothing about a file with the head `head`: it is damaged, or of
/// another database. Nothing for a record that is sound or missing. `record` must have been read
/// before the head; null for a head that is not known.
[[nodiscard]] std::optional<std::string> describe_unusable_record(
    const std::string& path, const std::optional<StateRecord>& record, const StoreState* head);

/// Compares a file's head with the record, which must have been read before it. Returns what is
/// missing, in words; nothing if the head is as new as the record.
[[nodiscard]] std::optional<std::string> describe_missing_rows(
    const std::string& path, const std::optional<StateRecord>& record, const StoreState& head);

/// Searches the write-ahead log for transactions behind a damaged part, which SQLite would drop.
/// Call it before SQLite opens the file. Returns what is lost, in words. A damaged last transaction
/// is not reported, because a loss of power leaves one that was never acknowledged. Cost: reads the
/// log, about 1 ms per MB.
[[nodiscard]] std::optional<std::string> describe_damaged_log(
    const std::string& path, const std::optional<StateRecord>& record);

}  // namespace mneme::internal
