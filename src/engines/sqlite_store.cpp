// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/sqlite_store.h"

#include "base/fail.h"
#include "engines/database_file.h"
#include "store/lost_rows.h"
#include "engines/row_columns.h"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <bit>
#include <cerrno>
#include <filesystem>
#include <string>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::string_view kFileJoin = "FROM experience e LEFT JOIN mixture m ON m.id = e.id";

class SqliteTransaction final : public StoreTransaction {
 public:
  /// `is_recorded`: record the state of the commit beside the file.
  SqliteTransaction(Connection& connection, Transaction transaction, bool is_empty,
                    bool is_recorded)
      : connection_(connection),
        transaction_(std::move(transaction)),
        is_empty_(is_empty),
        is_recorded_(is_recorded) {}

  Result<StoreState> head() override { return is_empty_ ? StoreState{} : read_head(connection_); }

  Result<void> read_tombstones(std::int64_t after, const TombstoneVisitor& visit) override {
    if (is_empty_) return {};
    auto statement =
        MNEME_TRY(connection_.prepare("SELECT id, row, generation, reason, time, checksum FROM "
                                      "tombstone WHERE id > ? ORDER BY id"));
    statement.add(after);
    return statement.for_each([&] { return visit(read_tombstone(statement)); });
  }

  Result<void> read_rows(std::int64_t after, RowParts parts, const RowVisitor& visit) override {
    if (is_empty_) return {};
    const std::string select =
        parts == RowParts::keys
            ? fmt::format("SELECT {} FROM experience e", kKeyColumns)
            : fmt::format("SELECT {}, {} {}", kKeyColumns, kMixtureColumns, kFileJoin);
    auto statement = MNEME_TRY(connection_.prepare(select + " WHERE e.id > ? ORDER BY e.id"));
    statement.add(after);
    return statement.for_each([&] { return visit(read_row(statement, parts)); });
  }

  Result<void> read_rows_by_id(std::span<const std::int64_t> ids,
                               const RowVisitor& visit) override {
    if (is_empty_) return {};
    const auto statement = MNEME_TRY(connection_.kept(
        fmt::format("SELECT {}, {} {} WHERE e.id = ?", kKeyColumns, kMixtureColumns, kFileJoin)));
    for (const std::int64_t id : ids) {
      statement->add(id);
      MNEME_TRY(statement->for_each([&] { return visit(read_row(*statement, RowParts::all)); }));
      statement->reset();
    }
    return {};
  }

  Result<std::vector<std::int64_t>> find_orphans() override {
    std::vector<std::int64_t> ids;
    if (is_empty_) return ids;
    auto statement = MNEME_TRY(connection_.prepare(
        "SELECT m.id FROM mixture m LEFT JOIN experience e ON e.id = m.id WHERE e.id IS NULL "
        "AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = m.id) ORDER BY m.id"));
    MNEME_TRY(statement.for_each([&] {
      ids.push_back(statement.integer(0));
      return Result<void>();
    }));
    return ids;
  }

  Result<std::vector<KnownRow>> find_contents(std::span<const ContentHash> contents) override {
    auto statement = MNEME_TRY(connection_.prepare(
        "SELECT e.id, m.tool, m.settings, m.seed, m.time FROM experience e LEFT JOIN mixture m ON "
        "m.id = e.id WHERE e.content = ? AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = "
        "e.id) ORDER BY e.id LIMIT 1"));
    std::vector<KnownRow> known;
    for (const ContentHash& content : contents) {
      statement.add(std::span<const std::byte>(content));
      MNEME_TRY(statement.for_each([&] {
        known.push_back(read_known_row(statement, content));
        return Result<void>();
      }));
      statement.reset();
    }
    return known;
  }

  Result<std::optional<std::size_t>> find_key_size(std::string_view kind) override {
    auto statement = MNEME_TRY(connection_.prepare(
        "SELECT length(e.key) FROM experience e WHERE e.kind = ? "
        "AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = e.id) ORDER BY e.id LIMIT 1"));
    const auto has_row = MNEME_TRY(statement.add(kind).step());
    if (!has_row) return std::nullopt;
    return static_cast<std::size_t>(statement.integer(0)) / sizeof(double);
  }

  Result<void> add_rows(std::span<const StoredRow> rows) override {
    auto key =
        MNEME_TRY(connection_.prepare("INSERT INTO experience VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)"));
    auto mixture = MNEME_TRY(connection_.prepare(
        "INSERT INTO mixture VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
    for (const StoredRow& row : rows) {
      write_key(key, row);
      MNEME_TRY(key.run());
      write_mixture(mixture, row);
      MNEME_TRY(mixture.run());
    }
    return {};
  }

  Result<void> add_tombstones(std::span<const Tombstone> tombstones) override {
    auto insert = MNEME_TRY(connection_.prepare("INSERT INTO tombstone VALUES (?, ?, ?, ?, ?, ?)"));
    for (const Tombstone& tombstone : tombstones) {
      write_tombstone(insert, tombstone);
      MNEME_TRY(insert.run());
    }
    return {};
  }

  Result<std::vector<LessonMark>> read_lessons() override {
    std::vector<LessonMark> marks;
    const bool has_table = !is_empty_ && has_lessons(connection_).value_or(false);
    if (!has_table) return marks;
    auto statement = MNEME_TRY(connection_.prepare(
        "SELECT l.lesson, l.content, EXISTS (SELECT 1 FROM experience e WHERE e.content = "
        "l.content "
        "AND NOT EXISTS (SELECT 1 FROM tombstone t WHERE t.row = e.id)) FROM lesson l"));
    MNEME_TRY(statement.for_each([&] {
      marks.push_back(read_lesson(statement));
      return Result<void>();
    }));
    return marks;
  }

  Result<void> add_lessons(std::span<const LessonMark> marks) override {
    if (marks.empty()) return {};
    MNEME_TRY(create_lessons(connection_));
    auto insert = MNEME_TRY(connection_.prepare("INSERT OR IGNORE INTO lesson VALUES (?, ?)"));
    for (const LessonMark& mark : marks) {
      insert.add(std::bit_cast<std::int64_t>(mark.lesson));
      MNEME_TRY(insert.add(std::span<const std::byte>(mark.content)).run());
    }
    return {};
  }

  Result<void> remove_tombstones(std::span<const std::int64_t> ids) override {
    auto removal = MNEME_TRY(connection_.prepare("DELETE FROM tombstone WHERE id = ?"));
    for (const std::int64_t id : ids) MNEME_TRY(removal.add(id).run());
    return {};
  }

  Result<void> remove_dead() override {
    return connection_.execute(
        "DELETE FROM mixture WHERE id IN (SELECT row FROM tombstone);"
        "DELETE FROM experience WHERE id IN (SELECT row FROM tombstone);"
        "DELETE FROM tombstone");
  }

  Result<void> set_head(const StoreState& state) override {
    new_head_ = state;
    return write_head(connection_, state);
  }
  Result<void> commit() override {
    MNEME_TRY(transaction_.commit());
    if (new_head_ && is_recorded_) record_state(connection_.lasting_path(), *new_head_);
    return {};
  }

 private:
  Connection& connection_;
  Transaction transaction_;
  bool is_empty_;
  bool is_recorded_;
  std::optional<StoreState> new_head_;
};

/// Prepares an opened file for writing.
Result<void> prepare_for_writing(Connection& connection) {
  MNEME_TRY(check_pages(connection));
  MNEME_TRY(mark(connection));
  MNEME_TRY(connection.enter_wal_mode());
  // Content hashes are random, so their index should stay in memory.
  return connection.execute("PRAGMA cache_size = -65536");
}

/// Migrates a database of kOldSchema, unless another process already did.
Result<void> migrate(Connection& connection, bool is_file) {
  auto writing = MNEME_TRY(Transaction::begin(connection, Transaction::Kind::write));
  const auto version = MNEME_TRY(identify(connection));
  if (version != kOldSchema) return {};
  SqliteTransaction transaction(connection, std::move(writing), false, is_file);
  MNEME_TRY(migrate_tables(connection, [&](const OldRows& old_rows) {
    return migrate_rows(connection.path(), old_rows, transaction);
  }));
  return transaction.commit();
}

class SqliteStore final : public Store {
 public:
  SqliteStore(Connection connection, OpenMode mode, std::optional<std::string> loss,
              std::string record_flaw)
      : connection_(std::move(connection)),
        mode_(mode),
        loss_(std::move(loss)),
        record_flaw_(std::move(record_flaw)) {}
  SqliteStore(const SqliteStore&) = delete;
  SqliteStore& operator=(const SqliteStore&) = delete;
  ~SqliteStore() override {
    const std::string file = connection_.lasting_path();
    const bool is_in_place = connection_.check_in_place().has_value();
    { const Connection closed = std::move(connection_); }  // the last one merges the log
    if (mode_ != OpenMode::read_only && is_in_place) settle_record(file);
  }

  const std::string& name() const override { return connection_.path(); }

  Result<int> schema_version() override {
    const auto transaction = MNEME_TRY(Transaction::begin(connection_, Transaction::Kind::read));
    return current_version();
  }

  Result<RobotSignature> signature() override { return read_signature(connection_); }

  Result<void> create(const RobotSignature& robot) override {
    const auto version = MNEME_TRY(create_schema(connection_, robot));
    if (version == 0) {
      const auto head = MNEME_TRY(read_head(connection_));
      record_state(connection_.lasting_path(), head);
    }
    return prepare_for_writing(connection_);
  }

  Result<void> set_signature(const RobotSignature& robot) override {
    auto transaction = MNEME_TRY(Transaction::begin(connection_, Transaction::Kind::write));
    MNEME_TRY(write_signature(connection_, robot));
    return transaction.commit();
  }

  Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) override {
    if (kind == Kind::write && mode_ == OpenMode::read_only) {
      return fail(ErrorCode::io, "{}: is open for reading only", name());
    }
    MNEME_TRY(reopen_if_immutable());
    auto transaction = MNEME_TRY(Transaction::begin(
        connection_, kind == Kind::read ? Transaction::Kind::read : Transaction::Kind::write));
    const auto version = MNEME_TRY(current_version());
    return std::make_unique<SqliteTransaction>(connection_, std::move(transaction), version == 0,
                                               kind == Kind::write);
  }

  Result<std::int64_t> bytes() override { return bytes_on_disk(connection_.lasting_path()); }

  const std::optional<std::string>& loss() const override { return loss_; }
  const std::string& record_flaw() const override { return record_flaw_; }

  Result<void> check_structure(std::vector<Damage>& damages) override {
    auto statement = MNEME_TRY(connection_.prepare("PRAGMA integrity_check"));
    return statement.for_each([&] {
      std::string what(statement.text(0));
      std::ranges::replace(what, '\n', ' ');
      if (what != "ok") damages.push_back({0, std::move(what)});
      return Result<void>();
    });
  }

  Result<void> reclaim() override {
    return connection_.execute("VACUUM; PRAGMA wal_checkpoint(TRUNCATE)");
  }

 private:
  /// SQLite never rereads an immutable file; open it again to see changes.
  Result<void> reopen_if_immutable() {
    if (!connection_.is_immutable()) return {};
    connection_ = MNEME_TRY(open_for_reading(connection_.lasting_path()));
    return {};
  }

  /// Identifies the file; cached while its schema is unchanged.
  Result<int> current_version() {
    const auto cookie = MNEME_TRY(connection_.integer("PRAGMA schema_version"));
    if (version_ > 0 && cookie_ == cookie) return version_;
    const auto version = MNEME_TRY(identify(connection_));
    if (version == kOldSchema) return refuse_schema(name(), version);
    cookie_ = cookie;
    version_ = version;
    return version_;
  }

  Connection connection_;
  OpenMode mode_;
  std::optional<std::string> loss_;
  std::string record_flaw_;
  std::int64_t cookie_ = -1;
  int version_ = 0;
};

/// In one snapshot, because another process may be creating the tables.
Result<int> identify_once(Connection& connection) {
  const auto transaction = MNEME_TRY(Transaction::begin(connection, Transaction::Kind::read));
  return identify(connection);
}

/// Why the record beside an open file of schema `version` is of no use; empty if it is of use. A
/// record of another database is dropped.
std::string drop_unusable_record(Connection& connection, int version, bool is_writer,
                                 std::optional<StateRecord>& record) {
  std::optional<StoreState> head;
  if (version == kSchemaVersion) {
    if (auto found = read_head(connection)) head = *found;
  }
  auto flaw = describe_unusable_record(connection.path(), record, head ? &*head : nullptr);
  if (flaw) record.reset();
  const std::string file = record_path(connection.path());
  if (!flaw && is_writer && ::access(file.c_str(), F_OK) == 0 &&
      ::access(file.c_str(), W_OK) != 0) {
    flaw = fmt::format("{} cannot be written: {}", file, std::generic_category().message(errno));
  }
  if (!flaw) return {};
  return fmt::format("{}: whether the last rows of the file were lost is not known", *flaw);
}

/// Rows that are missing in an open file of schema `version`; nothing for kOldSchema, which kept no
/// record, and for a damaged head, which reading it reports.
std::optional<std::string> find_missing_rows(Connection& connection, int version,
                                             const std::optional<StateRecord>& record) {
  if (version == kSchemaVersion) {
    if (record && record->is_settled) return std::nullopt;
    const auto head = read_head(connection);
    return head ? describe_missing_rows(connection.path(), record, *head) : std::nullopt;
  }
  auto missing =
      version == 0 ? describe_missing_rows(connection.path(), record, StoreState{}) : std::nullopt;
  if (missing && record->former_path.empty()) {
    *missing += "; remove that file to begin an empty database";
  }
  return missing;
}

tl::unexpected<Error> refuse_loss(const std::string& path, const std::string& loss) {
  return fail(ErrorCode::corrupt, "{}: {}", path, loss);
}

/// Migrates an open file or, for a reader, a copy of it in memory. Waits for another process that
/// does the same.
Result<Connection> migrated(Connection connection, bool is_writer, int timeout_ms) {
  if (!is_writer) {
    connection = MNEME_TRY(connection.copy_in_memory());
    MNEME_TRY(migrate(connection, false));
    return connection;
  }
  MNEME_TRY(check_pages(connection));
  connection.set_busy_timeout(timeout_ms);
  auto done = migrate(connection, true);
  connection.set_busy_timeout(Connection::kBusyTimeoutMs);
  if (!done && done.error().code == ErrorCode::io) {
    done.error().message += fmt::format(
        "; a database of schema {} is migrated when it is opened for writing, perhaps by another "
        "process now: try again when that is done",
        kOldSchema);
  }
  if (!done) return tl::unexpected(done.error());
  return connection;
}

}  // namespace

Result<std::unique_ptr<Store>> open_sqlite_store(const std::string& path, OpenMode mode,
                                                 LossCheck check, int migration_timeout_ms,
                                                 const std::atomic<bool>* stop) {
  const bool is_writer = mode != OpenMode::read_only;
  MNEME_TRY(check_files(path));
  std::error_code error;
  const bool is_new = !std::filesystem::exists(path, error);
  // A file that was deleted on purpose begins anew.
  if (is_new && is_writer) std::filesystem::remove(record_path(path), error);
  auto record = is_new ? std::nullopt : read_record(path);
  auto loss = describe_damaged_log(path, record);
  if (loss && check == LossCheck::refuse) return refuse_loss(path, *loss);
  auto connection = MNEME_TRY(is_writer ? open_for_writing(path, mode == OpenMode::create)
                                        : open_for_reading(path));
  // Identify before writing: another program's file must stay unchanged.
  const auto version = MNEME_TRY(identify_once(connection));
  const std::string record_flaw = drop_unusable_record(connection, version, is_writer, record);
  if (!loss) loss = find_missing_rows(connection, version, record);
  if (loss && check == LossCheck::refuse) return refuse_loss(path, *loss);
  if (version == kOldSchema) {
    connection = MNEME_TRY(migrated(std::move(connection), is_writer, migration_timeout_ms));
  }
  // A new file needs its page size before it enters WAL mode, which fixes it.
  if (is_writer && version != 0) MNEME_TRY(prepare_for_writing(connection));
  connection.set_stop(stop);
  return std::make_unique<SqliteStore>(std::move(connection), mode, std::move(loss), record_flaw);
}

}  // namespace mneme::internal
