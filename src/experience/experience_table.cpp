// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/experience_table.h"

#include <fmt/format.h>

namespace mneme::internal {
namespace {

struct Tally {
  std::int64_t row_count = 0;
  std::int64_t digest = 0;

  void add(std::int64_t id, std::int64_t checksum) {
    ++row_count;
    digest ^= tally_mark(id, checksum);
  }
};

Result<void> check_tally(Connection& connection, const Tally& found) {
  auto statement = connection.prepare("SELECT row_count, digest FROM tally");
  if (!statement) return tl::unexpected(statement.error());
  const auto has_row = statement->step();
  if (!has_row) return tl::unexpected(has_row.error());
  const auto refuse = [&](const std::string& what) {
    return fail(ErrorCode::corrupt, fmt::format("{}: {}", connection.path(), what));
  };
  if (!*has_row) return refuse("the tally of rows is missing");
  const std::int64_t expected = statement->integer(0);
  if (expected != found.row_count) {
    return refuse(fmt::format("holds {} rows, but {} were inserted", found.row_count, expected));
  }
  if (statement->integer(1) != found.digest) {
    return refuse("the ids or checksums of its rows are not those that were inserted");
  }
  return {};
}

// SQLite has no operator for exclusive or.
constexpr std::string_view kUpdateTally =
    "UPDATE tally SET row_count = row_count + ?1, digest = (digest | ?2) & ~(digest & ?2)";

Result<void> update_tally(Connection& connection, const Tally& added) {
  auto statement = connection.prepare(kUpdateTally);
  if (!statement) return tl::unexpected(statement.error());
  const auto updated = statement->bind(1, added.row_count).bind(2, added.digest).step();
  if (!updated) return tl::unexpected(updated.error());
  return {};
}

Result<std::int64_t> insert_row(Statement& insert, const RowView& row, std::int64_t checksum) {
  insert.bind(1, row.key).bind(2, row.means).bind(3, row.factor_rows).bind(4, row.factors);
  insert.bind(5, row.origins).bind(6, row.tool).bind(7, row.settings).bind(8, row.seed);
  insert.bind(9, row.time).bind(10, checksum);
  const auto inserted = insert.step();
  if (!inserted) return tl::unexpected(inserted.error());
  const std::int64_t id = insert.integer(0);
  const auto finished = insert.step();
  if (!finished) return tl::unexpected(finished.error());
  insert.reset();
  return id;
}

StoredRow stored_row(const Statement& statement) {
  StoredRow row;
  row.id = statement.integer(0);
  row.content.key = statement.blob(1);
  row.content.means = statement.blob(2);
  row.content.factor_rows = statement.blob(3);
  row.content.factors = statement.blob(4);
  row.content.origins = statement.blob(5);
  row.content.tool = statement.text(6);
  row.content.settings = statement.text(7);
  row.content.seed = statement.integer(8);
  row.content.time = statement.text(9);
  row.checksum = statement.integer(10);
  return row;
}

}  // namespace

Result<void> read_rows(Connection& connection,
                       const std::function<Result<void>(const StoredRow&)>& visit) {
  auto statement = connection.prepare(
      "SELECT id, key, means, factor_rows, factors, origins, tool, settings, seed, time, checksum "
      "FROM experience ORDER BY id");
  if (!statement) return tl::unexpected(statement.error());
  Tally found;
  for (;;) {
    const auto has_row = statement->step();
    if (!has_row) return tl::unexpected(has_row.error());
    if (!*has_row) break;
    const StoredRow row = stored_row(*statement);
    found.add(row.id, row.checksum);
    const auto visited = visit(row);
    if (!visited) return visited;
  }
  return check_tally(connection, found);
}

Result<std::vector<std::int64_t>> append_rows(Connection& connection,
                                              std::span<const Experience> rows) {
  auto transaction = Transaction::begin(connection, Transaction::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  std::vector<std::int64_t> ids;
  {
    auto insert = connection.prepare(
        "INSERT INTO experience (key, means, factor_rows, factors, origins, tool, settings, seed, "
        "time, checksum) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?) RETURNING id");
    if (!insert) return tl::unexpected(insert.error());
    Tally added;
    for (const Experience& experience : rows) {
      const EncodedRow row(experience);
      const std::int64_t checksum = checksum_of(row.view());
      const auto id = insert_row(*insert, row.view(), checksum);
      if (!id) return tl::unexpected(id.error());
      added.add(*id, checksum);
      ids.push_back(*id);
    }
    const auto updated = update_tally(connection, added);
    if (!updated) return tl::unexpected(updated.error());
  }
  const auto committed = transaction->commit();
  if (!committed) return tl::unexpected(committed.error());
  return ids;
}

}  // namespace mneme::internal
