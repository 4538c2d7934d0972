// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/migrate.h"

#include "experience/database_file.h"
#include "experience/experience_table.h"
#include "experience/file_copy.h"
#include "experience/legacy_table.h"
#include "experience/schema.h"
#include "experience/store_reads.h"

#include <set>

namespace mneme::internal {
namespace {

/// Moves the rows from the renamed old table to the new ones.
Result<StoreState> move_rows(Connection& connection, MigrateSummary& summary) {
  std::set<ContentHash> contents;
  Tally tally(StoreState{});
  const auto move = [&](const StoredRow& old) -> Result<void> {
    ContentHash content{};
    if (!old.flaw.empty()) {
      summary.left_out.push_back({old.id, old.flaw, true});
      return {};
    }
    std::copy_n(old.content.begin(), content.size(), content.begin());
    if (!contents.insert(content).second) {
      ++summary.duplicates;
      return {};
    }
    StoredRow row = old;
    row.generation = 1;
    row.key_checksum = key_checksum(row);
    row.tally_checksum = row.key_checksum;
    tally.add(row);
    ++summary.rows;
    return add_rows(connection, std::span(&row, 1));
  };
  return read_legacy_rows(connection, 0, move, "experience1").map([&] {
    StoreState state = tally.found();
    state.generation = 1;
    return state;
  });
}

Result<void> change_tables(Connection& connection, MigrateSummary& summary) {
  const auto space = read_space(connection);
  if (!space) return tl::unexpected(space.error());
  const auto head = read_legacy_head(connection);
  if (!head) return tl::unexpected(head.error());
  return connection.execute("ALTER TABLE experience RENAME TO experience1; DROP TABLE space")
      .and_then([&] { return create_tables(connection); })
      .and_then([&] { return write_space(connection, *space); })
      .and_then([&] { return move_rows(connection, summary); })
      .and_then([&](StoreState state) {
        state.last_row = std::max(state.last_row, head->last_row);
        return write_head(connection, state);
      })
      .and_then([&] { return connection.execute("DROP TABLE experience1; DROP TABLE tally"); });
}

/// Copies the file while nobody can write to it, so that the copy is what is migrated.
Result<std::string> copy_file(const std::string& path, int version) {
  auto source = open_for_reading(path);
  if (!source) return tl::unexpected(source.error());
  return copy_beside(*source, path, "schema" + std::to_string(version));
}

}  // namespace

Result<MigrateSummary> migrate_file(const std::string& path) {
  auto connection = open_for_writing(path, false);
  if (!connection) return tl::unexpected(connection.error());
  MigrateSummary summary;
  summary.to = kSchemaVersion;
  {
    auto transaction = Transaction::begin(*connection, Transaction::Kind::write);
    if (!transaction) return tl::unexpected(transaction.error());
    const auto version = identify(*connection);
    if (!version) return tl::unexpected(version.error());
    summary.from = *version;
    if (*version == 0 || *version == kSchemaVersion) return summary;
    const auto checked = check_pages(*connection);
    if (!checked) return tl::unexpected(checked.error());
    auto copy = copy_file(path, *version);
    if (!copy) return tl::unexpected(copy.error());
    summary.copy = std::move(*copy);
    const auto changed =
        change_tables(*connection, summary).and_then([&] { return transaction->commit(); });
    if (!changed) return tl::unexpected(changed.error());
  }
  const auto reclaimed = connection->execute("VACUUM");
  if (!reclaimed) return tl::unexpected(reclaimed.error());
  return summary;
}

}  // namespace mneme::internal
