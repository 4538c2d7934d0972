// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "engines/sqlite_store.h"

namespace mneme::test {
namespace {

using internal::Connection;

Connection open_connection(const std::string& path) {
  return require(Connection::open(path, Connection::Access::create));
}

void create(const std::string& path) {
  Connection connection = open_connection(path);
  REQUIRE(internal::create_schema(connection, arm_signature()));
}

/// Reads a database after running `sql` in it.
Result<int> kind_after(const std::string& sql) {
  const TemporaryDirectory directory;
  create(directory / "a.db");
  run_sql(directory / "a.db", sql);
  Connection connection = open_connection(directory / "a.db");
  return internal::identify(connection);
}

void check_refused(const std::string& sql, ErrorCode code, const std::string& reason) {
  INFO(sql);
  const Error error = require_error(kind_after(sql));
  CHECK(error.code == code);
  CHECK_MESSAGE(contains(error.message, reason), error.message);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file is empty before its schema is created and a database after") {
    const TemporaryDirectory directory;
    Connection connection = open_connection(directory / "a.db");
    CHECK(internal::identify(connection) == 0);
    REQUIRE(internal::create_schema(connection, arm_signature()));
    CHECK(internal::identify(connection) == internal::kSchemaVersion);
    const auto space = require(internal::read_signature(connection));
    CHECK(space.robot_name == "arm");
    CHECK(space.model_hash == "0123456789abcdef");
    CHECK(space.joint_count == 3);
  }

  TEST_CASE("creating a schema that another process has created changes nothing") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    Connection connection = open_connection(directory / "a.db");
    RobotSignature other = arm_signature();
    other.robot_name = "other";
    REQUIRE(internal::create_schema(connection, other));
    CHECK(internal::read_signature(connection)->robot_name == "arm");
  }

  TEST_CASE("the pragmas that tell what the file is are set") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    Connection connection = open_connection(directory / "a.db");
    CHECK(connection.integer("PRAGMA application_id") == 0x6d6e656d);
    CHECK(connection.integer("PRAGMA user_version") == 4);
    CHECK(connection.integer("PRAGMA page_size") == 8192);
  }

  TEST_CASE("a database of a newer schema is refused as such") {
    check_refused("PRAGMA user_version = 7; CREATE TABLE more (a)", ErrorCode::unsupported,
                  "was written by a newer mneme (schema 7); this one reads schemas 3 and 4");
  }

  TEST_CASE("a version of its own is damage if the tables are known ones") {
    check_refused("PRAGMA user_version = 7", ErrorCode::corrupt, "user_version is 7");
  }

  TEST_CASE("a file that is no database of ours is refused") {
    check_refused("PRAGMA user_version = 0", ErrorCode::corrupt, "user_version is 0");
    check_refused("PRAGMA application_id = 5", ErrorCode::corrupt, "not a mneme database");
    check_refused("PRAGMA application_id = 0", ErrorCode::corrupt, "not a mneme database");
  }

  TEST_CASE(
      "a file that .dump saved is known by its tables, and what .recover adds is passed over") {
    CHECK(kind_after("PRAGMA application_id = 0; PRAGMA user_version = 0; "
                     "CREATE TABLE lost_and_found (a)") == internal::kSchemaVersion);
  }

  TEST_CASE("tables that are not as they were created are damage") {
    check_refused("DROP INDEX tombstone_row", ErrorCode::corrupt,
                  "table 'tombstone_row' is missing");
    check_refused("CREATE TABLE more (a)", ErrorCode::corrupt, "'more' is not a table of mneme");
    check_refused("CREATE TRIGGER t AFTER INSERT ON experience BEGIN DELETE FROM experience; END",
                  ErrorCode::corrupt, "'t' is not a table of mneme");
    check_refused("ALTER TABLE experience RENAME COLUMN key TO key2", ErrorCode::corrupt,
                  "'experience' is not a table of mneme");
  }

  TEST_CASE("a database of an older schema is refused, and told what to do") {
    check_refused(
        "PRAGMA user_version = 2; ALTER TABLE experience DROP COLUMN cell", ErrorCode::unsupported,
        "was written by an older mneme (schema 2); this one reads schemas 3 and 4: learn anew");
    check_refused("PRAGMA user_version = 2", ErrorCode::corrupt, "user_version is 2");
  }

  TEST_CASE("statistics that SQLite keeps for itself are no damage") {
    CHECK(kind_after("ANALYZE") == internal::kSchemaVersion);
  }

  TEST_CASE("a changed or missing signature is damage, not another robot") {
    for (const std::string change :
         {"UPDATE robot SET model_hash = '0123456789abcdee'",
          "UPDATE robot SET kinematics_hash = 'x'", "UPDATE robot SET joint_count = 4",
          "UPDATE robot SET checksum = checksum + 1", "DELETE FROM robot"}) {
      const TemporaryDirectory directory;
      create(directory / "a.db");
      run_sql(directory / "a.db", change);
      Connection connection = open_connection(directory / "a.db");
      INFO(change);
      CHECK(require_error(internal::read_signature(connection)).code == ErrorCode::corrupt);
    }
  }

  TEST_CASE("pages that do not fit together are found") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    {
      Connection connection = open_connection(directory / "a.db");
      CHECK(internal::check_pages(connection).has_value());
    }
    std::string bytes = read_file(directory / "a.db");
    bytes[39] = 1;  // the header now counts one free page, but the list of free pages is empty
    write_file(directory / "a.db", bytes);
    Connection connection = open_connection(directory / "a.db");
    CHECK(require_error(internal::check_pages(connection)).code == ErrorCode::corrupt);
  }
}

namespace {

using internal::EncodedRow;
using internal::RowParts;
using internal::Store;
using internal::StoredRow;

std::unique_ptr<Store> make_store(const std::string& path) {
  auto store = require(internal::open_sqlite_store(path, OpenMode::create));
  REQUIRE(store->create(arm_signature()));
  return store;
}

std::unique_ptr<internal::StoreTransaction> begin(Store& store, Store::Kind kind) {
  return require(store.begin(kind));
}

/// A store with these rows under the ids from 1 on.
std::unique_ptr<Store> store_of(const std::string& path, const std::vector<Experience>& rows) {
  auto store = make_store(path);
  const auto transaction = begin(*store, Store::Kind::write);
  std::int64_t id = 0;
  for (const Experience& row : rows) {
    const EncodedRow encoded(row);
    const StoredRow stored = encoded.stored(++id, 1);
    REQUIRE(transaction->add_rows(std::span(&stored, 1)));
  }
  REQUIRE(transaction->commit());
  return store;
}

std::vector<std::int64_t> ids_after(Store& store, std::int64_t after, RowParts parts) {
  std::vector<std::int64_t> ids;
  REQUIRE(begin(store, Store::Kind::read)->read_rows(after, parts, [&](const StoredRow& row) {
    CHECK(row.columns.means.empty() == (parts == RowParts::keys));
    ids.push_back(row.id);
    return Result<void>();
  }));
  return ids;
}

/// The ids of the rows that are read for `wanted`.
std::vector<std::int64_t> ids_of(Store& store, const std::vector<std::int64_t>& wanted) {
  std::vector<std::int64_t> ids;
  REQUIRE(begin(store, Store::Kind::read)->read_rows_by_id(wanted, [&](const StoredRow& row) {
    ids.push_back(row.id);
    return Result<void>();
  }));
  return ids;
}

Result<void> had_enough(const StoredRow&) { return fail(ErrorCode::invalid, "enough"); }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows come back in the order of their ids with what was written") {
    const TemporaryDirectory directory;
    Rng rng(43);
    auto rows = random_rows(rng, 4);
    rows[1].sampler().is_complete = false;
    rows.push_back(random_path(rng));
    const auto store = store_of(directory / "a.db", rows);
    std::size_t position = 0;
    const auto check = [&](const StoredRow& row) {
      Experience experience;
      CHECK(!internal::decode(row, arm_signature(), experience).has_value());
      CHECK(experience.id == static_cast<std::int64_t>(position) + 1);
      CHECK(is_same_content(experience, rows[position++]));
      return Result<void>();
    };
    REQUIRE(begin(*store, Store::Kind::read)->read_rows(0, RowParts::all, check));
    CHECK(position == 5);
    CHECK(ids_after(*store, 3, RowParts::all) == std::vector<std::int64_t>{4, 5});
    CHECK(ids_after(*store, 0, RowParts::keys) == std::vector<std::int64_t>{1, 2, 3, 4, 5});
  }

  TEST_CASE("rows can be asked for by id, and ids that do not exist are passed over") {
    const TemporaryDirectory directory;
    Rng rng(44);
    const auto store = store_of(directory / "a.db", random_rows(rng, 4));
    CHECK(ids_of(*store, {4, 9, 2}) == std::vector<std::int64_t>{4, 2});
  }

  TEST_CASE("an error of the visitor ends the reading, and rows can be asked for again") {
    const TemporaryDirectory directory;
    Rng rng(44);
    const auto store = store_of(directory / "a.db", random_rows(rng, 3));
    const std::vector<std::int64_t> wanted = {3, 1};
    {
      const auto transaction = begin(*store, Store::Kind::read);
      for (const auto& read : {transaction->read_rows(0, RowParts::all, had_enough),
                               transaction->read_rows_by_id(wanted, had_enough)}) {
        REQUIRE(!read.has_value());
        CHECK(read.error().message == "enough");
      }
    }
    CHECK(ids_of(*store, wanted) == wanted);
  }

  TEST_CASE("live rows are found by their content, dead ones are not") {
    const TemporaryDirectory directory;
    Rng rng(45);
    const auto rows = random_rows(rng, 3);
    const auto store = store_of(directory / "a.db", rows);
    std::vector<internal::ContentHash> contents;
    for (const Experience& row : rows) contents.push_back(EncodedRow(row).content());
    contents.push_back(EncodedRow(random_experience(rng)).content());
    internal::Tombstone tombstone{1, 2, 1, "test", "now", 0};
    tombstone.checksum = checksum_of(tombstone);
    const auto transaction = begin(*store, Store::Kind::write);
    REQUIRE(transaction->add_tombstones(std::span(&tombstone, 1)));
    const auto known = require(transaction->find_contents(contents));
    REQUIRE(known.size() == 2);
    CHECK(known.at(0).id == 1);
    CHECK(known.at(1).id == 3);
    CHECK(known.at(1).content == contents[2]);
    CHECK(known.at(1).provenance.time == rows[2].provenance.time);
    CHECK(known.at(1).provenance.seed == rows[2].provenance.seed);
    REQUIRE(transaction->remove_dead());
    REQUIRE(transaction->commit());
    CHECK(ids_after(*store, 0, RowParts::all) == std::vector<std::int64_t>{1, 3});
  }

  TEST_CASE("a mixture without its key is an orphan, a key without its mixture has a flaw") {
    const TemporaryDirectory directory;
    Rng rng(46);
    const auto store = store_of(directory / "a.db", random_rows(rng, 3));
    run_sql(directory / "a.db",
            "DELETE FROM experience WHERE id = 2; DELETE FROM mixture WHERE id = 3");
    const auto transaction = begin(*store, Store::Kind::read);
    CHECK(transaction->find_orphans() == std::vector<std::int64_t>{2});
    std::string flaw;
    REQUIRE(transaction->read_rows(2, RowParts::all, [&](const StoredRow& row) {
      flaw = row.flaw;
      return Result<void>();
    }));
    CHECK(flaw == "its mixture is missing");
  }

  TEST_CASE("the head is one row, and a change of it is noticed") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    Connection connection = open_connection(directory / "a.db");
    const internal::StoreState first = require(internal::read_head(connection));
    CHECK(first == internal::StoreState{.epoch = first.epoch});
    const internal::StoreState state{1, 2, 3, 4, 5, 6, 7, 8};
    REQUIRE(internal::write_head(connection, state));
    CHECK(internal::read_head(connection) == state);
    REQUIRE(connection.execute("UPDATE head SET last_row = 4"));
    CHECK(require_error(internal::read_head(connection)).code == ErrorCode::corrupt);
    REQUIRE(connection.execute("DELETE FROM head"));
    CHECK(internal::read_head(connection).error().code == ErrorCode::corrupt);
  }
}

namespace {

std::unique_ptr<internal::Store> open(const std::string& path, OpenMode mode) {
  return require(internal::open_sqlite_store(path, mode));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("an empty store has no schema, no rows and no head") {
    const TemporaryDirectory directory;
    const auto store = open(directory / "a.db", OpenMode::create);
    CHECK(store->schema_version() == 0);
    CHECK(store->name() == directory / "a.db");
    const auto transaction = require(store->begin(internal::Store::Kind::read));
    CHECK(transaction->head() == internal::StoreState{});
    const auto read = transaction->read_rows(
        0, internal::RowParts::all, [](const auto&) { return fail(ErrorCode::invalid, "no row"); });
    CHECK(read.has_value());
  }

  TEST_CASE("a reader begins no writing transaction, and two writers do not share one") {
    const TemporaryDirectory directory;
    const auto first = open(directory / "a.db", OpenMode::create);
    REQUIRE(first->create(arm_signature()));
    CHECK(first->schema_version() == 4);
    const auto reader = open(directory / "a.db", OpenMode::read_only);
    CHECK(contains(require_error(reader->begin(internal::Store::Kind::write)).message,
                   "reading only"));
    require(first->begin(internal::Store::Kind::write));
    CHECK(reader->begin(internal::Store::Kind::read).has_value());
  }

  TEST_CASE("a transaction that is not committed leaves nothing") {
    const TemporaryDirectory directory;
    const auto store = open(directory / "a.db", OpenMode::create);
    REQUIRE(store->create(arm_signature()));
    Rng rng(15);
    const Experience row = random_experience(rng);
    const internal::EncodedRow encoded(row);
    const auto stored = encoded.stored(1, 1);
    for (const bool is_committed : {false, true}) {
      {
        const auto writing = store->begin(internal::Store::Kind::write);
        REQUIRE((*writing)->add_rows(std::span(&stored, 1)));
        if (is_committed) REQUIRE((*writing)->commit());
      }
      int count = 0;
      const auto reading = store->begin(internal::Store::Kind::read);
      REQUIRE((*reading)->read_rows(0, internal::RowParts::all, [&](const auto&) {
        ++count;
        return Result<void>();
      }));
      CHECK(count == (is_committed ? 1 : 0));
    }
  }

  TEST_CASE("a sound file's structure has no damage") {
    const TemporaryDirectory directory;
    const auto store = open(directory / "a.db", OpenMode::create);
    REQUIRE(store->create(arm_signature()));
    std::vector<Damage> damages;
    CHECK(store->check_structure(damages));
    CHECK(damages.empty());
    CHECK(store->reclaim());
    CHECK(*store->bytes() > 8192);
  }
}

}  // namespace mneme::test
