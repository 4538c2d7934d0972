// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/postgres_store.h"

#include "store/postgres_connection.h"
#include "store/sqlite_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace mneme::internal {
namespace {

// Primary keys hold the cell, so that a cluster may spread the two large tables by it.
constexpr std::array kTables = {
    "CREATE TABLE mneme_space (id integer PRIMARY KEY CHECK (id = 1), schema_version integer NOT "
    "NULL, robot_name text NOT NULL, robot_hash text NOT NULL, joint_count integer NOT NULL, "
    "checksum bigint NOT NULL)",
    "CREATE TABLE mneme_head (id integer PRIMARY KEY CHECK (id = 1), generation bigint NOT NULL, "
    "epoch bigint NOT NULL, last_row bigint NOT NULL, last_tombstone bigint NOT NULL, row_count "
    "bigint NOT NULL, row_digest bigint NOT NULL, tombstone_count bigint NOT NULL, "
    "tombstone_digest bigint NOT NULL, checksum bigint NOT NULL)",
    "CREATE TABLE mneme_experience (id bigint NOT NULL, generation bigint NOT NULL, cell bigint "
    "NOT NULL, kind text NOT NULL, content bytea NOT NULL, components bigint NOT NULL, key bytea "
    "NOT NULL, checksum "
    "bigint NOT NULL, PRIMARY KEY (id, cell))",
    "CREATE INDEX mneme_experience_content ON mneme_experience (content)",
    "CREATE INDEX mneme_experience_kind ON mneme_experience (kind, id)",
    "CREATE TABLE mneme_mixture (id bigint NOT NULL, cell bigint NOT NULL, means bytea NOT NULL, "
    "factor_rows bytea NOT NULL, factors bytea NOT NULL, origins bytea NOT NULL, tool text NOT "
    "NULL, settings text NOT NULL, seed bigint NOT NULL, time text NOT NULL, checksum bigint NOT "
    "NULL, PRIMARY KEY (id, cell))",
    "CREATE TABLE mneme_tombstone (id bigint PRIMARY KEY, row_id bigint NOT NULL, generation "
    "bigint NOT NULL, reason text NOT NULL, time text NOT NULL, checksum bigint NOT NULL)",
    "CREATE INDEX mneme_tombstone_row ON mneme_tombstone (row_id)",
};

Result<void> create_all(PostgresConnection& connection, const ExperienceSpace& space) {
  for (const char* sql : kTables) {
    const auto created = connection.query(sql);
    if (!created) return tl::unexpected(created.error());
  }
  const auto inserted = connection.query(
      "INSERT INTO mneme_space VALUES (1, $1::integer, $2, $3, $4::integer, $5::bigint)",
      {std::to_string(kSchemaVersion), space.robot_name, space.robot_hash,
       std::to_string(space.joint_count), std::to_string(checksum_of(space))});
  if (!inserted) return tl::unexpected(inserted.error());
  return write_postgres_head(connection, StoreState{});
}

/// Two processes that create the same tables collide in one of these ways.
bool was_faster(const std::string& state) {
  return state == "42P07" || state == "23505" || state == "42710";
}

tl::unexpected<Error> damaged(const PostgresConnection& connection, const char* what) {
  return fail(ErrorCode::corrupt, fmt::format("{}: {}", connection.name(), what));
}

}  // namespace

Result<int> read_postgres_version(PostgresConnection& connection) {
  const auto exists = connection.query("SELECT to_regclass('mneme_space') IS NOT NULL");
  if (!exists) return tl::unexpected(exists.error());
  if (exists->integer(0, 0) == 0) return 0;
  const auto version = connection.query("SELECT schema_version FROM mneme_space");
  if (!version) return tl::unexpected(version.error());
  if (version->row_count() == 0) {
    return damaged(connection, "the row that names the robot is missing");
  }
  const std::int64_t number = version->integer(0, 0);
  if (number < 1) return damaged(connection, "its schema version was never in use");
  if (number != kSchemaVersion) return refuse_schema(connection.name(), number);
  return static_cast<int>(number);
}

Result<ExperienceSpace> read_postgres_space(PostgresConnection& connection) {
  const auto row =
      connection.query("SELECT robot_name, robot_hash, joint_count, checksum FROM mneme_space");
  if (!row) return tl::unexpected(row.error());
  if (row->row_count() == 0) {
    return damaged(connection, "the row that names the robot is missing");
  }
  ExperienceSpace space;
  space.robot_name = row->text(0, 0);
  space.robot_hash = row->text(0, 1);
  space.joint_count = static_cast<int>(row->integer(0, 2));
  if (row->integer(0, 3) != checksum_of(space) || space.joint_count < 1) {
    return damaged(connection, "the row that names the robot is damaged");
  }
  return space;
}

Result<void> create_postgres_schema(PostgresConnection& connection, const ExperienceSpace& space) {
  const auto begun = connection.query("BEGIN");
  if (!begun) return tl::unexpected(begun.error());
  const auto created = create_all(connection, space);
  const std::string state = connection.last_state();
  const auto ended = connection.query(created ? "COMMIT" : "ROLLBACK");
  if (!created) return was_faster(state) ? Result<void>() : created;
  if (!ended) return tl::unexpected(ended.error());
  return {};
}

Result<void> replace_postgres_space(PostgresConnection& connection, const ExperienceSpace& space) {
  const auto updated = connection.query(
      "UPDATE mneme_space SET robot_name = $1, robot_hash = $2, joint_count = $3::integer, "
      "checksum = $4::bigint",
      {space.robot_name, space.robot_hash, std::to_string(space.joint_count),
       std::to_string(checksum_of(space))});
  if (!updated) return tl::unexpected(updated.error());
  return {};
}

Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked) {
  constexpr const char* kSelect =
      "SELECT generation, epoch, last_row, last_tombstone, row_count, row_digest, "
      "tombstone_count, tombstone_digest, checksum FROM mneme_head";
  constexpr const char* kSelectLocked =
      "SELECT generation, epoch, last_row, last_tombstone, row_count, row_digest, "
      "tombstone_count, tombstone_digest, checksum FROM mneme_head FOR UPDATE";
  const auto row = connection.query(is_locked ? kSelectLocked : kSelect);
  if (!row) return tl::unexpected(row.error());
  if (row->row_count() != 1) return damaged(connection, "the tally of rows is missing");
  std::array<std::int64_t, kHeadSize> numbers{};
  for (int i = 0; i < kHeadSize; ++i) numbers[static_cast<std::size_t>(i)] = row->integer(0, i);
  if (row->integer(0, kHeadSize) != hash_numbers(numbers)) {
    return damaged(connection, "the tally of rows is damaged");
  }
  return to_state(numbers);
}

Result<void> write_postgres_head(PostgresConnection& connection, const StoreState& state) {
  const auto numbers = to_numbers(state);
  std::vector<std::string> parameters;
  for (const std::int64_t number : numbers) parameters.push_back(std::to_string(number));
  parameters.push_back(std::to_string(hash_numbers(numbers)));
  const auto written = connection.query(
      "INSERT INTO mneme_head VALUES (1, $1::bigint, $2::bigint, $3::bigint, $4::bigint, "
      "$5::bigint, $6::bigint, $7::bigint, $8::bigint, $9::bigint) ON CONFLICT (id) DO UPDATE SET "
      "generation = excluded.generation, epoch = excluded.epoch, last_row = excluded.last_row, "
      "last_tombstone = excluded.last_tombstone, row_count = excluded.row_count, row_digest = "
      "excluded.row_digest, tombstone_count = excluded.tombstone_count, tombstone_digest = "
      "excluded.tombstone_digest, checksum = excluded.checksum",
      parameters);
  if (!written) return tl::unexpected(written.error());
  return {};
}

namespace {

constexpr const char* kSelectKeys =
    "SELECT e.id, e.generation, e.cell, e.kind, e.content, e.components, e.key, e.checksum "
    "FROM mneme_experience e WHERE e.id > $1::bigint ORDER BY e.id";
constexpr const char* kSelectRows =
    "SELECT e.id, e.generation, e.cell, e.kind, e.content, e.components, e.key, e.checksum, "
    "m.means, "
    "m.factor_rows, m.factors, m.origins, m.tool, m.settings, m.seed, m.time, m.checksum "
    "FROM mneme_experience e LEFT JOIN mneme_mixture m ON m.id = e.id AND m.cell = e.cell "
    "WHERE e.id > $1::bigint ORDER BY e.id";
constexpr const char* kSelectRowsById =
    "SELECT e.id, e.generation, e.cell, e.kind, e.content, e.components, e.key, e.checksum, "
    "m.means, "
    "m.factor_rows, m.factors, m.origins, m.tool, m.settings, m.seed, m.time, m.checksum "
    "FROM mneme_experience e LEFT JOIN mneme_mixture m ON m.id = e.id AND m.cell = e.cell "
    "WHERE e.id = ANY($1::bigint[])";

StoredRow stored_row(const PostgresAnswer& answer, RowParts parts) {
  StoredRow row;
  row.id = answer.integer(0, 0);
  row.generation = answer.integer(0, 1);
  row.cell = answer.integer(0, 2);
  row.columns.kind = answer.text(0, 3);
  row.content = answer.blob(0, 4);
  row.components = answer.integer(0, 5);
  row.columns.key = answer.blob(0, 6);
  row.key_checksum = answer.integer(0, 7);
  if (parts == RowParts::keys) return row;
  row.columns.means = answer.blob(0, 8);
  row.columns.factor_rows = answer.blob(0, 9);
  row.columns.factors = answer.blob(0, 10);
  row.columns.origins = answer.blob(0, 11);
  row.columns.tool = answer.text(0, 12);
  row.columns.settings = answer.text(0, 13);
  row.columns.seed = answer.integer(0, 14);
  row.columns.time = answer.text(0, 15);
  row.mixture_checksum = answer.integer(0, 16);
  if (answer.is_null(0, 16)) row.flaw = "its mixture is missing";
  return row;
}

std::string array_of_contents(std::span<const ContentHash> contents) {
  std::string text = "{";
  for (const ContentHash& content : contents) {
    if (text.size() > 1) text += ',';
    text += "\"\\\\x" + to_hex(content) + "\"";
  }
  return text + "}";
}

class PostgresTransaction final : public StoreTransaction {
 public:
  PostgresTransaction(PostgresConnection& connection, Store::Kind kind, bool is_empty)
      : connection_(connection), kind_(kind), is_empty_(is_empty) {}
  PostgresTransaction(const PostgresTransaction&) = delete;
  PostgresTransaction& operator=(const PostgresTransaction&) = delete;
  ~PostgresTransaction() override {
    if (!is_over_) (void)connection_.query("ROLLBACK");
  }

  Result<StoreState> head() override {
    if (is_empty_) return StoreState{};
    return read_postgres_head(connection_, kind_ == Store::Kind::write);
  }

  Result<void> read_tombstones(std::int64_t after, const TombstoneVisitor& visit) override {
    if (is_empty_) return {};
    const auto visit_row = [&](const PostgresAnswer& answer) {
      return visit({answer.integer(0, 0), answer.integer(0, 1), answer.integer(0, 2),
                    std::string(answer.text(0, 3)), std::string(answer.text(0, 4)),
                    answer.integer(0, 5)});
    };
    return connection_.stream(
        "SELECT id, row_id, generation, reason, time, checksum FROM mneme_tombstone "
        "WHERE id > $1::bigint ORDER BY id",
        {std::to_string(after)}, visit_row);
  }

  Result<void> read_rows(std::int64_t after, RowParts parts, const RowVisitor& visit) override {
    if (is_empty_) return {};
    return connection_.stream(
        parts == RowParts::keys ? kSelectKeys : kSelectRows, {std::to_string(after)},
        [&](const PostgresAnswer& answer) { return visit(stored_row(answer, parts)); });
  }

  Result<void> read_rows_by_id(std::span<const std::int64_t> ids,
                               const RowVisitor& visit) override {
    if (is_empty_) return {};
    return connection_.stream(kSelectRowsById, {array_of(ids)}, [&](const PostgresAnswer& answer) {
      return visit(stored_row(answer, RowParts::all));
    });
  }

  Result<std::vector<KnownRow>> find_contents(std::span<const ContentHash> contents) override {
    std::vector<KnownRow> known;
    const auto found = connection_.stream(
        "SELECT e.content, e.id, coalesce(m.time, ''), coalesce(m.tool, '') FROM mneme_experience "
        "e LEFT JOIN mneme_mixture m ON m.id = e.id AND m.cell = e.cell "
        "WHERE e.content = ANY($1::bytea[]) "
        "AND NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id = e.id) "
        "ORDER BY e.id DESC",
        {array_of_contents(contents)}, [&](const PostgresAnswer& answer) {
          KnownRow& row = known.emplace_back();
          const auto content = answer.blob(0, 0);
          std::copy_n(content.begin(), std::min(content.size(), row.content.size()),
                      row.content.begin());
          row.id = answer.integer(0, 1);
          row.time = answer.text(0, 2);
          row.tool = answer.text(0, 3);
          return Result<void>();
        });
    if (!found) return tl::unexpected(found.error());
    return known;
  }

  Result<std::optional<std::size_t>> find_key_size(std::string_view kind) override {
    const auto found = connection_.query(
        "SELECT length(e.key) FROM mneme_experience e WHERE e.kind = $1 "
        "AND NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id = e.id) "
        "ORDER BY e.id LIMIT 1",
        {std::string(kind)});
    if (!found) return tl::unexpected(found.error());
    if (found->row_count() == 0) return std::nullopt;
    return static_cast<std::size_t>(found->integer(0, 0)) / sizeof(double);
  }

  Result<std::vector<std::int64_t>> find_orphans() override {
    std::vector<std::int64_t> ids;
    if (is_empty_) return ids;
    const auto found = connection_.stream(
        "SELECT m.id FROM mneme_mixture m LEFT JOIN mneme_experience e ON e.id = m.id AND e.cell = "
        "m.cell WHERE e.id IS NULL AND NOT EXISTS (SELECT 1 FROM mneme_tombstone t WHERE t.row_id "
        "= m.id) ORDER BY m.id",
        {}, [&](const PostgresAnswer& answer) {
          ids.push_back(answer.integer(0, 0));
          return Result<void>();
        });
    if (!found) return tl::unexpected(found.error());
    return ids;
  }

  Result<void> add_rows(std::span<const StoredRow> rows) override {
    BinaryCopy keys;
    BinaryCopy mixtures;
    for (const StoredRow& row : rows) {
      const RowView& columns = row.columns;
      keys.row(8).add(row.id).add(row.generation).add(row.cell).add(columns.kind);
      keys.add(row.content).add(row.components).add(columns.key).add(row.key_checksum);
      mixtures.row(11).add(row.id).add(row.cell).add(columns.means).add(columns.factor_rows);
      mixtures.add(columns.factors).add(columns.origins).add(columns.tool).add(columns.settings);
      mixtures.add(columns.seed).add(columns.time).add(row.mixture_checksum);
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
      copy.row(6).add(tombstone.id).add(tombstone.row).add(tombstone.generation);
      copy.add(std::string_view(tombstone.reason)).add(std::string_view(tombstone.time));
      copy.add(tombstone.checksum);
    }
    return connection_.copy_in("COPY mneme_tombstone FROM STDIN WITH (FORMAT binary)",
                               copy.finish());
  }

  Result<void> remove_tombstones(std::span<const std::int64_t> ids) override {
    return connection_
        .query("DELETE FROM mneme_tombstone WHERE id = ANY($1::bigint[])", {array_of(ids)})
        .map([](const PostgresAnswer&) {});
  }

  Result<void> set_head(const StoreState& state) override {
    return write_postgres_head(connection_, state);
  }

  Result<void> remove_dead() override {
    for (const char* sql :
         {"DELETE FROM mneme_mixture WHERE id IN (SELECT row_id FROM mneme_tombstone)",
          "DELETE FROM mneme_experience WHERE id IN (SELECT row_id FROM mneme_tombstone)",
          "DELETE FROM mneme_tombstone"}) {
      const auto removed = connection_.query(sql);
      if (!removed) return tl::unexpected(removed.error());
    }
    return {};
  }

  Result<void> commit() override {
    const auto committed = connection_.query("COMMIT");
    is_over_ = true;
    if (!committed) return tl::unexpected(committed.error());
    if (committed->command() == "COMMIT") return {};
    return fail(ErrorCode::io,
                fmt::format("{}: the transaction was rolled back", connection_.name()));
  }

 private:
  PostgresConnection& connection_;
  Store::Kind kind_;
  bool is_empty_;
  bool is_over_ = false;
};

class PostgresStore final : public Store {
 public:
  PostgresStore(std::shared_ptr<PostgresConnection> connection, OpenMode mode)
      : owner_(std::move(connection)), connection_(*owner_), mode_(mode) {}

  const std::string& name() const override { return connection_.name(); }

  Result<int> schema_version() override {
    if (version_ > 0) return version_;
    return connection_.revive()
        .and_then([&] { return read_postgres_version(connection_); })
        .map([&](int version) { return version_ = version; });
  }

  Result<ExperienceSpace> space() override { return read_postgres_space(connection_); }

  Result<void> create(const ExperienceSpace& space) override {
    return create_postgres_schema(connection_, space);
  }

  Result<void> set_space(const ExperienceSpace& space) override {
    return replace_postgres_space(connection_, space);
  }

  Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) override {
    if (kind == Kind::write && mode_ == OpenMode::read_only) {
      return fail(ErrorCode::io, fmt::format("{}: is open for reading only", name()));
    }
    const auto version = connection_.revive().and_then([&] { return schema_version(); });
    if (!version) return tl::unexpected(version.error());
    const auto begun =
        connection_.query(kind == Kind::read ? "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY"
                                             : "BEGIN ISOLATION LEVEL READ COMMITTED");
    if (!begun) return tl::unexpected(begun.error());
    auto transaction = std::make_unique<PostgresTransaction>(connection_, kind, *version == 0);
    if (kind == Kind::write) {
      const auto prepared = prepare_writing();
      if (!prepared) return tl::unexpected(prepared.error());
    }
    return transaction;
  }

  Result<std::int64_t> bytes() override {
    const auto size = connection_.revive().and_then([&] {
      return connection_.query(
          "SELECT coalesce(sum(pg_total_relation_size(to_regclass(name))), 0)::bigint FROM "
          "unnest(ARRAY['mneme_space', 'mneme_head', 'mneme_experience', 'mneme_mixture', "
          "'mneme_tombstone']) AS name");
    });
    if (!size) return tl::unexpected(size.error());
    return size->integer(0, 0);
  }

  /// A server looks after its own files.
  Result<void> check_structure(std::vector<Damage>&) override { return {}; }

  Result<void> reclaim() override {
    for (const char* sql :
         {"VACUUM mneme_experience", "VACUUM mneme_mixture", "VACUUM mneme_tombstone"}) {
      const auto vacuumed = connection_.query(sql);
      if (!vacuumed) return tl::unexpected(vacuumed.error());
    }
    return {};
  }

 private:
  /// Locks the head, whether or not it is sound, and makes a commit wait for the disk even where
  /// the server's settings do not.
  Result<void> prepare_writing() {
    for (const char* sql : {"SELECT 1 FROM mneme_head FOR UPDATE",
                            "SELECT set_config('synchronous_commit', 'on', true) WHERE "
                            "current_setting('synchronous_commit') = 'off'"}) {
      const auto done = connection_.query(sql);
      if (!done) return tl::unexpected(done.error());
    }
    return {};
  }

  std::shared_ptr<PostgresConnection> owner_;
  PostgresConnection& connection_;
  OpenMode mode_;
  int version_ = 0;
};

}  // namespace

Result<std::unique_ptr<Store>> open_postgres_store(const std::string& url, OpenMode mode) {
  auto connection = PostgresConnection::open(url);
  if (!connection) return tl::unexpected(connection.error());
  return make_postgres_store(std::make_shared<PostgresConnection>(std::move(*connection)), mode);
}

std::unique_ptr<Store> make_postgres_store(std::shared_ptr<PostgresConnection> connection,
                                           OpenMode mode) {
  return std::make_unique<PostgresStore>(std::move(connection), mode);
}

}  // namespace mneme::internal
