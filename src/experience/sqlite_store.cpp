// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/sqlite_store.h"

#include "experience/database_file.h"
#include "experience/experience_table.h"
#include "experience/schema.h"

#include <fmt/format.h>

#include <utility>

namespace mneme::internal {
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
  Result<void> set_head(const StoreState& state) override { return write_head(connection_, state); }
  Result<void> remove_dead() override { return internal::remove_dead(connection_); }
  Result<void> commit() override { return transaction_.commit(); }

 private:
  Connection& connection_;
  Transaction transaction_;
  bool is_empty_;
};

/// What makes an opened file ready to be written.
Result<void> prepare_for_writing(Connection& connection) {
  return check_pages(connection)
      .and_then([&] { return connection.enter_wal_mode(); })
      // Content hashes are spread over their index at random: it should stay in memory.
      .and_then([&] { return connection.execute("PRAGMA cache_size = -65536"); });
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

  Result<std::int64_t> bytes() override { return bytes_on_disk(name()); }

  Result<void> check_structure(std::vector<Damage>& damages) override {
    auto statement = connection_.prepare("PRAGMA integrity_check");
    if (!statement) return tl::unexpected(statement.error());
    for (;;) {
      const auto has_row = statement->step();
      if (!has_row) return tl::unexpected(has_row.error());
      if (!*has_row) return {};
      if (statement->text(0) != "ok") damages.push_back({0, std::string(statement->text(0))});
    }
  }

  Result<void> reclaim() override {
    return connection_.execute("VACUUM; PRAGMA wal_checkpoint(TRUNCATE)");
  }

 private:
  /// What SQLite reads as immutable it never looks at again by itself.
  Result<void> look_again() {
    if (!connection_.is_immutable()) return {};
    auto connection = open_for_reading(name());
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
