// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Maintenance of databases: verify, merge, adopt, compact, export and import.
#pragma once

#include "mneme/base.h"
#include "mneme/store.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mneme {

enum class VerifyMode {
  report,      ///< report damage only
  quarantine,  ///< set damaged rows aside: searches skip them, and the other rows can be used
};
/// Checks the file structure and every row's checksums. Returns all damage; empty if the database
/// is sound. If the file itself is damaged, nothing is set aside, and the last entry holds the
/// shell command that saves the readable rows into a new file. Errors: io; unsupported if a newer
/// or older mneme wrote it.
[[nodiscard]] Result<std::vector<Damage>> verify_database(const std::string& url,
                                                          VerifyMode mode = VerifyMode::report);

/// Describes why losses of a file's last rows would not be found: the record beside it is missing,
/// as beside a copy, damaged, or of another database. Returns nothing for a file with its record,
/// and for a server.
[[nodiscard]] std::optional<std::string> describe_record_flaw(const std::string& url);

/// Adds the rows of `from` to `into`, which is created if missing. Rows with equal kind, key and
/// content are merged. Idempotent; the result does not depend on the order of merges. Works in
/// transactions of some hundred rows: repeat it after an interruption. If `from` is damaged, `into`
/// is not changed. Errors: wrong_robot if the databases are of different robots; those of
/// Database::open().
[[nodiscard]] Result<MergeSummary> merge_databases(const std::string& into,
                                                   const std::string& from);

/// Assigns the database to `robot`, if only joint limits differ or an older mneme stored no joint
/// frames. Rows are not changed. Returns the previous signature. Errors: wrong_robot if joint
/// frames differ or, unless `is_forced`, are unknown; invalid if the database is empty; io.
[[nodiscard]] Result<RobotSignature> adopt_database(const std::string& url,
                                                    const RobotSignature& robot,
                                                    bool is_forced = false);

struct CompactSummary {
  std::int64_t removed = 0;  ///< rows that were set aside and are now deleted
  std::int64_t bytes_before = 0;
  std::int64_t bytes_after = 0;
};
/// Deletes rows that were set aside and frees their space. Other processes may keep using the
/// database.
[[nodiscard]] Result<CompactSummary> compact_database(const std::string& url);

/// Writes all rows as JSON lines (docs/design/database.md), ordered by content: equal sets of rows
/// give equal files. Returns the number of rows. Errors: invalid if `path` does not end in .jsonl;
/// io.
[[nodiscard]] Result<std::int64_t> export_database(const std::string& url, const std::string& path);
/// Merges the rows of a file written by export_database() or another program, like
/// merge_databases(). Errors: parse, naming the line; wrong_robot; those of Database::open().
[[nodiscard]] Result<MergeSummary> import_database(const std::string& url, const std::string& path);

}  // namespace mneme
