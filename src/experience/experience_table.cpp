// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/experience_table.h"

#include <fmt/format.h>

#include <array>
#include <string>

namespace mneme::internal {
namespace {

constexpr std::string_view kKeyColumns =
    "e.id, e.generation, e.cell, e.kind, e.content, e.components, e.key, e.checksum";
constexpr std::string_view kMixtureColumns =
    "m.means, m.factor_rows, m.factors, m.origins, m.tool, m.settings, m.seed, m.time, m.checksum, "
    "m.id";
constexpr std::string_view kJoin = "FROM experience e LEFT JOIN mixture m ON m.id = e.id";

StoredRow stored_row(const Statement& statement, RowParts parts) {
  StoredRow row;
  row.id = statement.integer(0);
  row.generation = statement.integer(1);
  row.cell = statement.integer(2);
  row.columns.kind = statement.text(3);
  row.content = statement.blob(4);
  row.components = statement.integer(5);
  row.columns.key = statement.blob(6);
  row.key_checksum = statement.integer(7);
  if (parts == RowParts::keys) return row;
  row.columns.means = statement.blob(8);
  row.columns.factor_rows = statement.blob(9);
  row.columns.factors = statement.blob(10);
  row.columns.origins = statement.blob(11);
  row.columns.tool = statement.text(12);
  row.columns.settings = statement.text(13);
  row.columns.seed = statement.integer(14);
  row.columns.time = statement.text(15);
  row.mixture_checksum = statement.integer(16);
  if (statement.integer(17) != row.id) row.flaw = "its mixture is missing";
  return row;
}

/// Steps through all answers.
Result<void> for_each(Statement& statement, const std::function<Result<void>()>& visit) {
  for (;;) {
    const auto has_row = statement.step();
    if (!has_row) return tl::unexpected(has_row.error());
    if (!*has_row) return {};
    const auto visited = visit();
    if (!visited) return visited;
  }
}

/// Runs a statement that has no answers, and makes it ready for the next parameters.
Result<void> run(Statement& statement) {
  const auto done = statement.step();
  statement.reset();
  if (!done) return tl::unexpected(done.error());
  return {};
}

Result<void> add_row(Statement& key, Statement& mixture, const StoredRow& row) {
  const RowView& columns = row.columns;
  key.bind(1, row.id).bind(2, row.generation).bind(3, row.cell).bind(4, columns.kind);
  key.bind(5, row.content).bind(6, row.components).bind(7, columns.key).bind(8, row.key_checksum);
  mixture.bind(1, row.id).bind(2, row.cell).bind(3, columns.means).bind(4, columns.factor_rows);
  mixture.bind(5, columns.factors).bind(6, columns.origins).bind(7, columns.tool);
  mixture.bind(8, columns.settings).bind(9, columns.seed).bind(10, columns.time);
  mixture.bind(11, row.mixture_checksum);
  return run(key).and_then([&] { return run(mixture); });
}

}  // namespace

Result<StoreState> read_head(Connection& connection) {
  auto statement = connection.prepare(
      "SELECT generation, epoch, last_row, last_tombstone, row_count, row_digest, "
      "tombstone_count, tombstone_digest, checksum FROM head");
  if (!statement) return tl::unexpected(statement.error());
  const auto has_row = statement->step();
  if (!has_row) return tl::unexpected(has_row.error());
  const auto refuse = [&](const char* what) {
    return fail(ErrorCode::corrupt, fmt::format("{}: {}", connection.path(), what));
  };
  if (!*has_row) return refuse("the tally of rows is missing");
  std::array<std::int64_t, kHeadSize> numbers{};
  for (int i = 0; i < kHeadSize; ++i) numbers[static_cast<std::size_t>(i)] = statement->integer(i);
  if (statement->integer(kHeadSize) != hash_numbers(numbers)) {
    return refuse("the tally of rows is damaged");
  }
  return to_state(numbers);
}

Result<void> write_head(Connection& connection, const StoreState& state) {
  auto statement =
      connection.prepare("INSERT OR REPLACE INTO head VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  if (!statement) return tl::unexpected(statement.error());
  const auto numbers = to_numbers(state);
  for (int i = 0; i < kHeadSize; ++i) {
    statement->bind(i + 1, numbers[static_cast<std::size_t>(i)]);
  }
  statement->bind(kHeadSize + 1, hash_numbers(numbers));
  return run(*statement);
}

Result<void> read_tombstones(Connection& connection, std::int64_t after,
                             const TombstoneVisitor& visit) {
  auto statement = connection.prepare(
      "SELECT id, row, generation, reason, time, checksum FROM tombstone WHERE id > ? ORDER BY id");
  if (!statement) return tl::unexpected(statement.error());
  statement->bind(1, after);
  return for_each(*statement, [&] {
    return visit({statement->integer(0), statement->integer(1), statement->integer(2),
                  std::string(statement->text(3)), std::string(statement->text(4)),
                  statement->integer(5)});
  });
}

Result<void> read_rows(Connection& connection, std::int64_t after, RowParts parts,
                       const RowVisitor& visit) {
  const std::string columns =
      parts == RowParts::keys
          ? fmt::format("SELECT {} FROM experience e", kKeyColumns)
          : fmt::format("SELECT {}, {} {}", kKeyColumns, kMixtureColumns, kJoin);
  auto statement = connection.prepare(columns + " WHERE e.id > ? ORDER BY e.id");
  if (!statement) return tl::unexpected(statement.error());
  statement->bind(1, after);
  return for_each(*statement, [&] { return visit(stored_row(*statement, parts)); });
}

Result<void> read_rows_by_id(Connection& connection, std::span<const std::int64_t> ids,
                             const RowVisitor& visit) {
  auto statement = connection.prepare(
      fmt::format("SELECT {}, {} {} WHERE e.id = ?", kKeyColumns, kMixtureColumns, kJoin));
  if (!statement) return tl::unexpected(statement.error());
  for (const std::int64_t id : ids) {
    statement->bind(1, id);
    const auto visited =
        for_each(*statement, [&] { return visit(stored_row(*statement, RowParts::all)); });
    if (!visited) return visited;
    statement->reset();
  }
  return {};
}

Result<std::vector<KnownRow>> find_contents(Connection& connection,
                                            std::span<const ContentHash> contents) {
  auto statement = connection.prepare(
      "SELECT e.id, m.time, m.tool FROM experience e LEFT JOIN mixture m ON m.id = e.id "
      "WHERE e.content = ? AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = e.id) "
      "ORDER BY e.id LIMIT 1");
  if (!statement) return tl::unexpected(statement.error());
  std::vector<KnownRow> known;
  for (const ContentHash& content : contents) {
    statement->bind(1, std::span<const std::byte>(content));
    const auto found = for_each(*statement, [&] {
      known.push_back({content, statement->integer(0), std::string(statement->text(1)),
                       std::string(statement->text(2))});
      return Result<void>();
    });
    if (!found) return tl::unexpected(found.error());
    statement->reset();
  }
  return known;
}

Result<std::optional<std::size_t>> find_key_size(Connection& connection, std::string_view kind) {
  auto statement = connection.prepare(
      "SELECT length(e.key) FROM experience e WHERE e.kind = ? "
      "AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = e.id) ORDER BY e.id LIMIT 1");
  if (!statement) return tl::unexpected(statement.error());
  statement->bind(1, kind);
  std::optional<std::size_t> size;
  const auto found = for_each(*statement, [&] {
    size = static_cast<std::size_t>(statement->integer(0)) / sizeof(double);
    return Result<void>();
  });
  if (!found) return tl::unexpected(found.error());
  return size;
}

Result<std::vector<std::int64_t>> find_orphans(Connection& connection) {
  auto statement = connection.prepare(
      "SELECT m.id FROM mixture m LEFT JOIN experience e ON e.id = m.id WHERE e.id IS NULL "
      "AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = m.id) ORDER BY m.id");
  if (!statement) return tl::unexpected(statement.error());
  std::vector<std::int64_t> ids;
  const auto found = for_each(*statement, [&] {
    ids.push_back(statement->integer(0));
    return Result<void>();
  });
  if (!found) return tl::unexpected(found.error());
  return ids;
}

Result<void> add_rows(Connection& connection, std::span<const StoredRow> rows) {
  auto key = connection.prepare("INSERT INTO experience VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  if (!key) return tl::unexpected(key.error());
  auto mixture = connection.prepare("INSERT INTO mixture VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  if (!mixture) return tl::unexpected(mixture.error());
  for (const StoredRow& row : rows) {
    const auto added = add_row(*key, *mixture, row);
    if (!added) return added;
  }
  return {};
}

Result<void> add_tombstones(Connection& connection, std::span<const Tombstone> tombstones) {
  auto insert = connection.prepare("INSERT INTO tombstone VALUES (?, ?, ?, ?, ?, ?)");
  if (!insert) return tl::unexpected(insert.error());
  for (const Tombstone& tombstone : tombstones) {
    insert->bind(1, tombstone.id).bind(2, tombstone.row).bind(3, tombstone.generation);
    insert->bind(4, tombstone.reason).bind(5, tombstone.time).bind(6, tombstone.checksum);
    const auto added = run(*insert);
    if (!added) return added;
  }
  return {};
}

Result<void> remove_dead(Connection& connection) {
  return connection.execute(
      "DELETE FROM mixture WHERE id IN (SELECT row FROM tombstone);"
      "DELETE FROM experience WHERE id IN (SELECT row FROM tombstone);"
      "DELETE FROM tombstone");
}

}  // namespace mneme::internal
