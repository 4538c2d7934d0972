// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Keeping databases in order: verification, merging, compaction, files for other programs.
#pragma once

#include "mneme/base.h"
#include "mneme/store.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mneme {

enum class VerifyMode {
  report,      ///< changes nothing
  quarantine,  ///< sets damaged rows aside, so that the rest can be used
};
/// Checks the structure and every row's checksums. Empty if all is well. Where the file beneath the
/// rows is damaged nothing is set aside: the last entry holds the shell command that saves what can
/// be read in a new file. Errors: io; unsupported if a newer or an older mneme wrote it.
[[nodiscard]] Result<std::vector<Damage>> verify_database(const std::string& url,
                                                          VerifyMode mode = VerifyMode::report);

/// Adds the rows of `from` to `into`, which is created if it is missing: a union of sets, in which
/// rows are the same if their kinds, keys and contents are. Idempotent, and what
/// results does not depend on the order of merging. In transactions of some hundred rows: repeat it
/// if it was interrupted. If `from` is damaged, `into` stays as it was. Errors: wrong_robot if the
/// two are not of one robot; those of Database::open().
[[nodiscard]] Result<MergeSummary> merge_databases(const std::string& into,
                                                   const std::string& from);

/// Says that the experience of `url` is that of `robot` from now on: where only joint limits
/// differ, or where an older mneme said less. Rows stay as they are; returns the robot that it was
/// of. Errors: wrong_robot if the joints stand in other frames, or, unless `is_forced`, if the
/// database does not say in which; invalid if there is nothing in it yet; io.
[[nodiscard]] Result<RobotSignature> adopt_database(const std::string& url,
                                                    const RobotSignature& robot,
                                                    bool is_forced = false);

struct CompactSummary {
  std::int64_t removed = 0;  ///< rows that were set aside
  std::int64_t bytes_before = 0;
  std::int64_t bytes_after = 0;
};
/// Removes rows that were set aside, and gives the space back. Other processes may go on.
[[nodiscard]] Result<CompactSummary> compact_database(const std::string& url);

/// Writes all rows as JSON lines (`.jsonl`, docs/design/database.md) in an order that depends on
/// their content alone, so that equal sets give equal bytes. Returns their number. Errors: invalid
/// if the name ends otherwise; io.
[[nodiscard]] Result<std::int64_t> export_database(const std::string& url, const std::string& path);
/// Adds the rows of a file that export_database() or another program wrote, as merge_databases()
/// does. Errors: parse, naming the line; wrong_robot; those of Database::open().
[[nodiscard]] Result<MergeSummary> import_database(const std::string& url, const std::string& path);

}  // namespace mneme
