// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/postgres_store.h"

#include "base/fail.h"
#include "engines/row_columns.h"
#include "engines/sqlite_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::string_view kServerJoin =
    "FROM mneme_experience e LEFT JOIN mneme_mixture m ON m.id = e.id AND m.cell = e.cell";

std::string array_of_contents(std::span<const ContentHash> contents) {
  std::string text = "{";
  for (const ContentHash& content : contents) {
    if (text.size() > 1) text += ',';
    text += "\"\\\\x" + to_hex(content) + "\"";
  }
  return text + "}";
}

/// Lets a server work for minutes on one call, such as deleting many rows.
class LongCall {
 public:
  explicit LongCall(PostgresConnection& connection)
      : connection_(connection), usual_s_(connection.set_answer_timeout(kLongest_s)) {}
  LongCall(const LongCall&) = delete;
  LongCall& operator=(const LongCall&) = delete;
  ~LongCall() { connection_.set_answer_timeout(usual_s_); }

 private:
  static constexpr double kLongest_s = 1800;
  PostgresConnection& connection_;
  double usual_s_;
};

class PostgresTransaction final : public StoreTransaction {
 public:
  PostgresTransaction(PostgresConnection& connection, Store::Kind kind, bool is_empty)
      : connection_(connection), kind_(kind), is_empty_(is_empty) {}
  PostgresTransaction(const PostgresTransaction&) = delete;
  PostgresTransaction& operator=(const PostgresTransaction&) = delete;
  ~PostgresTransaction() override {
    if (!is_ended_) (void)connection_.query("ROLLBACK");
  }

  Result<StoreState> head() override {
    if (is_empty_) return StoreState{};
    return read_postgres_head(connection_, kind_ == Store::Kind::write);
  }

  Result<void> read_tombstones(std::int64_t after, const TombstoneVisitor& visit) override {
    if (is_empty_) return {};
    return connection_.stream(
        "SELECT id, row_id, generation, reason, time, checksum FROM mneme_tombstone "
        "WHERE id > $1::bigint ORDER BY id",
        {std::to_string(after)},
        [&](const PostgresAnswer& answer) { return visit(read_tombstone(PostgresRow(answer))); });
  }

  Result<void> read_rows(std::int64_t after, RowParts parts, const RowVisitor& visit) override {
    if (is_empty_) return {};
    const std::string select =
        parts == RowParts::keys
            ? fmt::format("SELECT {} FROM mneme_experience e", kKeyColumns)
            : fmt::format("SELECT {}, {} {}", kKeyColumns, kMixtureColumns, kServerJoin);
    return connection_.stream(
        select + " WHERE e.id > $1::bigint ORDER BY e.id", {std::to_string(after)},
        [&](const PostgresAnswer& answer) { return visit(read_row(PostgresRow(answer), parts)); });
  }

  Result<void> read_rows_by_id(std::span<const std::int64_t> ids,
                               const RowVisitor& visit) override {
    if (is_empty_) return {};
    return connection_.stream(fmt::format("SELECT {}, {} {} WHERE e.id = ANY($1::bigint[])",
                                          kKeyColumns, kMixtureColumns, kServerJoin),
                              {array_of(ids)}, [&](const PostgresAnswer& answer) {
                                return visit(read_row(PostgresRow(answer), RowParts::all));
                              });
  }

  Result<std::vector<KnownRow>> find_contents(std::span<const ContentHash> contents) override {
    std::vector<KnownRow> known;
    MNEME_TRY(connection_.stream(
        fmt::format("SELECT e.id, coalesce(m.tool, ''), coalesce(m.settings, ''), coalesce(m.seed, "
                    "0), coalesce(m.time, ''), e.content {} WHERE e.content = ANY($1::bytea[]) AND "
                    "NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id = e.id) ORDER BY "
                    "e.id DESC",
                    kServerJoin),
        {array_of_contents(contents)}, [&](const PostgresAnswer& answer) {
          known.push_back(read_known_row(PostgresRow(answer), to_content_hash(answer.blob(0, 5))));
          return Result<void>();
        }));
    return known;
  }

  Result<std::optional<std::size_t>> find_key_size(std::string_view kind) override {
    const auto found = MNEME_TRY(
        connection_.query("SELECT length(e.key) FROM mneme_experience e WHERE e.kind = $1 "
                          "AND NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id = e.id) "
                          "ORDER BY e.id LIMIT 1",
                          {std::string(kind)}));
    if (found.row_count() == 0) return std::nullopt;
    return static_cast<std::size_t>(found.integer(0, 0)) / sizeof(double);
  }

  Result<std::vector<std::int64_t>> find_orphans() override {
    std::vector<std::int64_t> ids;
    if (is_empty_) return ids;
    const LongCall patience(connection_);
    MNEME_TRY(connection_.stream(
        "SELECT m.id FROM mneme_mixture m LEFT JOIN mneme_experience e ON e.id = m.id AND e.cell = "
        "m.cell WHERE e.id IS NULL AND NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id "
        "= m.id) ORDER BY m.id",
        {}, [&](const PostgresAnswer& answer) {
          ids.push_back(answer.integer(0, 0));
          return Result<void>();
        }));
    return ids;
  }

  Result<void> add_rows(std::span<const StoredRow> rows) override {
    BinaryCopy keys, mixtures;
    for (const StoredRow& row : rows) {
      write_key(keys.row(kKeyWidth), row);
      write_mixture(mixtures.row(kMixtureWidth), row);
    }
    if (rows.empty()) return {};
    return connection_
        .copy_in("COPY mneme_experience FROM STDIN WITH (FORMAT binary)", keys.finish())
        .and_then([&] {
          return connection_.copy_in("COPY mneme_mixture FROM STDIN WITH (FORMAT binary)",
                                     mixtures.finish());
        });
  }

  Result<void> add_tombstones(std::span<const Tombstone> tombstones) override {
    if (tombstones.empty()) return {};
    BinaryCopy copy;
    for (const Tombstone& tombstone : tombstones) {
      write_tombstone(copy.row(kTombstoneWidth), tombstone);
    }
    return connection_.copy_in("COPY mneme_tombstone FROM STDIN WITH (FORMAT binary)",
                               copy.finish());
  }

  Result<std::vector<LessonMark>> read_lessons() override {
    std::vector<LessonMark> marks;
    if (is_empty_) return marks;
    const LongCall patience(connection_);
    const bool has_table = MNEME_TRY(has_postgres_lessons(connection_));
    if (!has_table) return marks;
    MNEME_TRY(connection_.stream(
        "SELECT l.lesson, l.content, EXISTS (SELECT 1 FROM mneme_experience e WHERE e.content = "
        "l.content AND NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id = e.id)) FROM "
        "mneme_lesson l",
        {}, [&](const PostgresAnswer& answer) {
          marks.push_back(read_lesson(PostgresRow(answer)));
          return Result<void>();
        }));
    return marks;
  }

  Result<void> add_lessons(std::span<const LessonMark> marks) override {
    if (marks.empty()) return {};
    MNEME_TRY(create_postgres_lessons(connection_));
    std::vector<std::int64_t> lessons;
    std::vector<ContentHash> contents;
    for (const LessonMark& mark : marks) {
      lessons.push_back(std::bit_cast<std::int64_t>(mark.lesson));
      contents.push_back(mark.content);
    }
    return connection_.run(
        "INSERT INTO mneme_lesson SELECT * FROM unnest($1::bigint[], $2::bytea[]) ON CONFLICT "
        "DO NOTHING",
        {array_of(lessons), array_of_contents(contents)});
  }

  Result<void> remove_tombstones(std::span<const std::int64_t> ids) override {
    return connection_.run("DELETE FROM mneme_tombstone WHERE id = ANY($1::bigint[])",
                           {array_of(ids)});
  }

  Result<void> set_head(const StoreState& state) override {
    return write_postgres_head(connection_, state);
  }

  Result<void> remove_dead() override {
    const LongCall patience(connection_);
    return connection_.run_all(
        {"DELETE FROM mneme_mixture WHERE id IN (SELECT row_id FROM mneme_tombstone)",
         "DELETE FROM mneme_experience WHERE id IN (SELECT row_id FROM mneme_tombstone)",
         "DELETE FROM mneme_tombstone"});
  }

  Result<void> commit() override {
    const auto committed = connection_.query("COMMIT");
    is_ended_ = true;
    if (!committed) return tl::unexpected(committed.error());
    if (committed->command() == "COMMIT") return {};
    return fail(ErrorCode::io, "{}: the transaction was rolled back", connection_.name());
  }

 private:
  PostgresConnection& connection_;
  Store::Kind kind_;
  bool is_empty_;
  bool is_ended_ = false;
};

/// Migrates tables of kOldSchema, unless another process already did.
Result<void> migrate(PostgresConnection& connection, OpenMode mode) {
  const bool is_reader = mode == OpenMode::read_only;
  MNEME_TRY(connection.query(is_reader ? "BEGIN ISOLATION LEVEL REPEATABLE READ" : "BEGIN"));
  PostgresTransaction transaction(connection, Store::Kind::write, false);
  // Both locks wait for another process that migrates. The second makes the server notice tables
  // that were replaced meanwhile.
  if (!is_reader) MNEME_TRY(connection.query("SELECT 1 FROM mneme_head FOR UPDATE"));
  MNEME_TRY(connection.query("LOCK TABLE mneme_experience IN ACCESS SHARE MODE"));
  const auto version = MNEME_TRY(read_postgres_version(connection));
  if (version != kOldSchema) return {};
  MNEME_TRY(migrate_tables(connection, mode, [&](const OldRows& old_rows) {
    return migrate_rows(connection.name(), old_rows, transaction);
  }));
  return transaction.commit();
}

/// Another process may replace the old tables between two queries.
Result<int> read_lasting_version(PostgresConnection& connection) {
  auto version = read_postgres_version(connection);
  const bool is_replaced = !version && version.error().code == ErrorCode::corrupt;
  return is_replaced ? read_postgres_version(connection) : version;
}

class PostgresStore final : public Store {
 public:
  PostgresStore(std::shared_ptr<PostgresConnection> connection, OpenMode mode)
      : owner_(std::move(connection)), connection_(*owner_), mode_(mode) {}

  const std::string& name() const override { return connection_.name(); }

  Result<int> schema_version() override {
    MNEME_TRY(revive());
    if (version_ > 0) return version_;
    // Another process may migrate the tables, and locks them meanwhile.
    const LongCall patience(connection_);
    int version = MNEME_TRY(read_lasting_version(connection_));
    if (version == kOldSchema) {
      MNEME_TRY(migrate(connection_, mode_));
      version = kSchemaVersion;
    }
    return version_ = version;
  }

  Result<RobotSignature> signature() override { return read_postgres_signature(connection_); }

  Result<void> create(const RobotSignature& signature) override {
    return create_postgres_schema(connection_, signature);
  }

  Result<void> set_signature(const RobotSignature& signature) override {
    return replace_postgres_signature(connection_, signature);
  }

  Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) override {
    if (kind == Kind::write && mode_ == OpenMode::read_only) {
      return fail(ErrorCode::io, "{}: is open for reading only", name());
    }
    const int version = MNEME_TRY(schema_version());
    MNEME_TRY(connection_.query(kind == Kind::read
                                    ? "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY"
                                    : "BEGIN ISOLATION LEVEL READ COMMITTED"));
    auto transaction = std::make_unique<PostgresTransaction>(connection_, kind, version == 0);
    if (kind == Kind::write) MNEME_TRY(prepare_writing());
    return transaction;
  }

  Result<std::int64_t> bytes() override {
    const auto size = MNEME_TRY(revive().and_then([&] {
      return connection_.query(
          "SELECT coalesce(sum(pg_total_relation_size(to_regclass(name))), 0)::bigint FROM "
          "unnest(ARRAY['mneme_robot', 'mneme_head', 'mneme_experience', 'mneme_mixture', "
          "'mneme_tombstone']) AS name");
    }));
    return size.integer(0, 0);
  }

  const std::optional<std::string>& loss() const override { return loss_; }

  /// The server checks its own files.
  Result<void> check_structure(std::vector<Damage>&) override { return {}; }

  Result<void> reclaim() override {
    const LongCall patience(connection_);
    return connection_.run_all(
        {"VACUUM mneme_experience", "VACUUM mneme_mixture", "VACUUM mneme_tombstone"});
  }

 private:
  /// Reconnects if the connection was lost. A reader then migrates its temporary copy again.
  Result<void> revive() {
    MNEME_TRY(connection_.revive());
    const bool was_lost =
        std::exchange(revivals_, connection_.revivals()) != connection_.revivals();
    if (was_lost && mode_ == OpenMode::read_only) version_ = 0;
    return {};
  }

  /// Locks the head, even a damaged one, and makes commits wait for the disk whatever the server's
  /// default.
  Result<void> prepare_writing() {
    return connection_.run_all({"SELECT 1 FROM mneme_head FOR UPDATE",
                                "SELECT set_config('synchronous_commit', 'on', true) WHERE "
                                "current_setting('synchronous_commit') = 'off'"});
  }

  std::shared_ptr<PostgresConnection> owner_;
  PostgresConnection& connection_;
  OpenMode mode_;
  std::optional<std::string> loss_;  // the server's log is its own business
  int version_ = 0;
  int revivals_ = 0;
};

}  // namespace

Result<std::unique_ptr<Store>> open_postgres_store(const std::string& url, OpenMode mode,
                                                   const ServerPatience& patience) {
  auto connection = MNEME_TRY(PostgresConnection::open(url, patience));
  auto store =
      make_postgres_store(std::make_shared<PostgresConnection>(std::move(connection)), mode);
  MNEME_TRY(store->schema_version());
  return store;
}

std::unique_ptr<Store> make_postgres_store(std::shared_ptr<PostgresConnection> connection,
                                           OpenMode mode) {
  return std::make_unique<PostgresStore>(std::move(connection), mode);
}

}  // namespace mneme::internal
