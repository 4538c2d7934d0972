// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/sqlite_store.h"

#include "store/database_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

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
  const auto kept = connection.kept(
      fmt::format("SELECT {}, {} {} WHERE e.id = ?", kKeyColumns, kMixtureColumns, kJoin));
  if (!kept) return tl::unexpected(kept.error());
  Statement& statement = **kept;
  for (const std::int64_t id : ids) {
    statement.bind(1, id);
    const auto visited =
        for_each(statement, [&] { return visit(stored_row(statement, RowParts::all)); });
    if (!visited) return visited;
    statement.reset();
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

namespace {

class SqliteTransaction final : public StoreTransaction {
 public:
  SqliteTransaction(Connection& connection, Transaction transaction, bool is_empty)
      : connection_(connection), transaction_(std::move(transaction)), is_empty_(is_empty) {}

  Result<StoreState> head() override { return is_empty_ ? StoreState{} : read_head(connection_); }

  Result<void> read_tombstones(std::int64_t after, const TombstoneVisitor& visit) override {
    if (is_empty_) return {};
    return internal::read_tombstones(connection_, after, visit);
  }

  Result<void> read_rows(std::int64_t after, RowParts parts, const RowVisitor& visit) override {
    if (is_empty_) return {};
    return internal::read_rows(connection_, after, parts, visit);
  }

  Result<void> read_rows_by_id(std::span<const std::int64_t> ids,
                               const RowVisitor& visit) override {
    if (is_empty_) return {};
    return internal::read_rows_by_id(connection_, ids, visit);
  }

  Result<std::vector<std::int64_t>> find_orphans() override {
    if (is_empty_) return std::vector<std::int64_t>{};
    return internal::find_orphans(connection_);
  }

  Result<std::vector<KnownRow>> find_contents(std::span<const ContentHash> contents) override {
    return internal::find_contents(connection_, contents);
  }

  Result<std::optional<std::size_t>> find_key_size(std::string_view kind) override {
    return internal::find_key_size(connection_, kind);
  }

  Result<void> add_rows(std::span<const StoredRow> rows) override {
    return internal::add_rows(connection_, rows);
  }
  Result<void> add_tombstones(std::span<const Tombstone> tombstones) override {
    return internal::add_tombstones(connection_, tombstones);
  }
  Result<void> remove_tombstones(std::span<const std::int64_t> ids) override {
    auto removal = MNEME_TRY(connection_.prepare("DELETE FROM tombstone WHERE id = ?"));
    for (const std::int64_t id : ids) MNEME_TRY(run(removal.bind(1, id)));
    return {};
  }
  Result<void> set_head(const StoreState& state) override { return write_head(connection_, state); }
  Result<void> remove_dead() override { return internal::remove_dead(connection_); }
  Result<void> commit() override { return transaction_.commit(); }

 private:
  Connection& connection_;
  Transaction transaction_;
  bool is_empty_;
};

/// Makes an opened file ready to be written.
Result<void> prepare_for_writing(Connection& connection) {
  MNEME_TRY(check_pages(connection));
  MNEME_TRY(mark(connection));
  MNEME_TRY(connection.enter_wal_mode());
  // Content hashes are spread over their index at random: it should stay in memory.
  return connection.execute("PRAGMA cache_size = -65536");
}

class SqliteStore final : public Store {
 public:
  SqliteStore(Connection connection, OpenMode mode)
      : connection_(std::move(connection)), mode_(mode) {}

  const std::string& name() const override { return connection_.path(); }

  Result<int> schema_version() override {
    const auto transaction = Transaction::begin(connection_, Transaction::Kind::read);
    if (!transaction) return tl::unexpected(transaction.error());
    return current_version();
  }

  Result<ExperienceSpace> space() override { return read_space(connection_); }

  Result<void> create(const ExperienceSpace& space) override {
    return create_schema(connection_, space).and_then([&] {
      return prepare_for_writing(connection_);
    });
  }

  Result<void> set_space(const ExperienceSpace& space) override {
    return replace_space(connection_, space);
  }

  Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) override {
    if (kind == Kind::write && mode_ == OpenMode::read_only) {
      return fail(ErrorCode::io, fmt::format("{}: is open for reading only", name()));
    }
    if (const auto fresh = look_again(); !fresh) return tl::unexpected(fresh.error());
    auto transaction = Transaction::begin(
        connection_, kind == Kind::read ? Transaction::Kind::read : Transaction::Kind::write);
    if (!transaction) return tl::unexpected(transaction.error());
    const auto version = current_version();
    if (!version) return tl::unexpected(version.error());
    return std::make_unique<SqliteTransaction>(connection_, std::move(*transaction), *version == 0);
  }

  Result<std::int64_t> bytes() override { return bytes_on_disk(connection_.lasting_path()); }

  Result<void> check_structure(std::vector<Damage>& damages) override {
    auto statement = connection_.prepare("PRAGMA integrity_check");
    if (!statement) return tl::unexpected(statement.error());
    for (;;) {
      const auto has_row = statement->step();
      if (!has_row) return tl::unexpected(has_row.error());
      if (!*has_row) return {};
      std::string what(statement->text(0));
      std::ranges::replace(what, '\n', ' ');
      if (what != "ok") damages.push_back({0, std::move(what)});
    }
  }

  Result<void> reclaim() override {
    return connection_.execute("VACUUM; PRAGMA wal_checkpoint(TRUNCATE)");
  }

 private:
  /// What SQLite reads as immutable it never looks at again by itself.
  Result<void> look_again() {
    if (!connection_.is_immutable()) return {};
    auto connection = open_for_reading(connection_.lasting_path());
    if (!connection) return tl::unexpected(connection.error());
    connection_ = std::move(*connection);
    return {};
  }

  /// Identifies the file, unless its tables are those that it had the last time.
  Result<int> current_version() {
    const auto cookie = connection_.integer("PRAGMA schema_version");
    if (!cookie) return tl::unexpected(cookie.error());
    if (version_ > 0 && cookie_ == *cookie) return version_;
    const auto version = identify(connection_);
    if (!version) return version;
    cookie_ = *cookie;
    version_ = *version;
    return version_;
  }

  Connection connection_;
  OpenMode mode_;
  std::int64_t cookie_ = -1;
  int version_ = 0;
};

/// In one snapshot, because another process may be creating the tables.
Result<int> identify_once(Connection& connection) {
  const auto transaction = Transaction::begin(connection, Transaction::Kind::read);
  if (!transaction) return tl::unexpected(transaction.error());
  return identify(connection);
}

}  // namespace

Result<std::unique_ptr<Store>> open_sqlite_store(const std::string& path, OpenMode mode) {
  const bool is_writer = mode != OpenMode::read_only;
  auto connection =
      is_writer ? open_for_writing(path, mode == OpenMode::create) : open_for_reading(path);
  if (!connection) return tl::unexpected(connection.error());
  // Before anything is written: a stranger's file stays as it is.
  const auto version = identify_once(*connection);
  if (!version) return tl::unexpected(version.error());
  // A new file gets its page size, which a log would fix, before it gets a log.
  if (is_writer && *version != 0) {
    const auto prepared = prepare_for_writing(*connection);
    if (!prepared) return tl::unexpected(prepared.error());
  }
  return std::make_unique<SqliteStore>(std::move(*connection), mode);
}

}  // namespace mneme::internal
