// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/legacy_table.h"

#include "experience/schema.h"

#include <fmt/format.h>

namespace mneme::internal {
namespace {

constexpr std::string_view kSelect =
    "SELECT id, key, means, factor_rows, factors, origins, tool, settings, seed, time, checksum ";

RowView columns_of(const Statement& statement) {
  RowView columns;
  columns.key = statement.blob(1);
  columns.means = statement.blob(2);
  columns.factor_rows = statement.blob(3);
  columns.factors = statement.blob(4);
  columns.origins = statement.blob(5);
  columns.tool = statement.text(6);
  columns.settings = statement.text(7);
  columns.seed = statement.integer(8);
  columns.time = statement.text(9);
  return columns;
}

/// Hands the row that the statement stands at to `visit`.
Result<void> visit_row(const Statement& statement, const ExperienceSpace& space,
                       const RowVisitor& visit) {
  const RowView columns = columns_of(statement);
  StoredRow damaged;
  damaged.id = statement.integer(0);
  damaged.tally_checksum = statement.integer(10);
  damaged.columns = columns;
  if (checksum_of(columns) != damaged.tally_checksum) {
    damaged.flaw = "its checksum is not that of its content";
    return visit(damaged);
  }
  Experience experience;
  if (const auto flaw = decode_columns(columns, space, experience)) {
    damaged.flaw = *flaw;
    return visit(damaged);
  }
  const EncodedRow encoded(experience);
  StoredRow row = encoded.stored(damaged.id, damaged.id);
  row.tally_checksum = damaged.tally_checksum;
  return visit(row);
}

Result<void> visit_all(Connection& connection, Statement& statement, const RowVisitor& visit) {
  const auto space = read_space(connection);
  if (!space) return tl::unexpected(space.error());
  for (;;) {
    const auto has_row = statement.step();
    if (!has_row) return tl::unexpected(has_row.error());
    if (!*has_row) return {};
    const auto visited = visit_row(statement, *space, visit);
    if (!visited) return visited;
  }
}

}  // namespace

Result<StoreState> read_legacy_head(Connection& connection) {
  auto statement = connection.prepare(
      "SELECT row_count, digest, (SELECT coalesce(max(id), 0) FROM experience) FROM tally");
  if (!statement) return tl::unexpected(statement.error());
  const auto has_row = statement->step();
  if (!has_row) return tl::unexpected(has_row.error());
  if (!*has_row) {
    return fail(ErrorCode::corrupt,
                fmt::format("{}: the tally of rows is missing", connection.path()));
  }
  StoreState state;
  state.row_count = statement->integer(0);
  state.row_digest = statement->integer(1);
  state.last_row = statement->integer(2);
  state.generation = state.row_count;
  state.epoch = -1;  // no state of a later schema has it
  return state;
}

Result<void> read_legacy_rows(Connection& connection, std::int64_t after, const RowVisitor& visit,
                              const char* table) {
  auto statement =
      connection.prepare(fmt::format("{} FROM {} WHERE id > ? ORDER BY id", kSelect, table));
  if (!statement) return tl::unexpected(statement.error());
  statement->bind(1, after);
  return visit_all(connection, *statement, visit);
}

Result<void> read_legacy_rows_by_id(Connection& connection, std::span<const std::int64_t> ids,
                                    const RowVisitor& visit) {
  auto statement = connection.prepare(fmt::format("{} FROM experience WHERE id = ?", kSelect));
  if (!statement) return tl::unexpected(statement.error());
  for (const std::int64_t id : ids) {
    statement->bind(1, id);
    const auto visited = visit_all(connection, *statement, visit);
    if (!visited) return visited;
    statement->reset();
  }
  return {};
}

}  // namespace mneme::internal
