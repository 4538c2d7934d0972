// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/postgres_server.h"
#include "engines/postgres_store.h"
#include "support/environment.h"

#include <array>
#include <set>
#include <thread>

namespace mneme::test {

using internal::PostgresConnection;

TEST_SUITE("unit") {
  TEST_CASE("there is no schema before it is created, and creating it again changes nothing") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->new_url());
    CHECK(internal::read_postgres_version(connection) == 0);
    REQUIRE(internal::create_postgres_schema(connection, arm_signature()));
    CHECK(internal::read_postgres_version(connection) == 4);
    RobotSignature other = arm_signature();
    other.robot_name = "other";
    REQUIRE(internal::create_postgres_schema(connection, other));
    const auto space = require(internal::read_postgres_signature(connection));
    CHECK(space.robot_name == "arm");
    CHECK(space.joint_count == 3);
  }

  TEST_CASE("a newer or older schema is refused, and a changed space or head is damage") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->new_url());
    REQUIRE(internal::create_postgres_schema(connection, arm_signature()));
    CHECK(internal::read_postgres_head(connection, false) == internal::StoreState{});
    const internal::StoreState state{1, 2, 3, 4, 5, -6, 7, -8};
    REQUIRE(internal::write_postgres_head(connection, state));
    CHECK(internal::read_postgres_head(connection, true) == state);
    REQUIRE(connection.query("UPDATE mneme_head SET epoch = 9"));
    CHECK(internal::read_postgres_head(connection, false).error().code == ErrorCode::corrupt);
    REQUIRE(connection.query("UPDATE mneme_robot SET joint_count = 4"));
    CHECK(internal::read_postgres_signature(connection).error().code == ErrorCode::corrupt);
    for (const char* other : {"9", "2"}) {
      REQUIRE(connection.query("UPDATE mneme_robot SET schema_version = $1::integer", {other}));
      CHECK(internal::read_postgres_version(connection).error().code == ErrorCode::unsupported);
    }
    REQUIRE(connection.query("DELETE FROM mneme_robot"));
    CHECK(internal::read_postgres_version(connection).error().code == ErrorCode::corrupt);
  }
}

namespace {

void run_on_server(const std::string& url, const std::string& sql) {
  auto connection = connect_to(url);
  require(connection.query(sql.c_str()));
}

}  // namespace

namespace {

/// The tables of schema 3 as mneme 0.1.0 created them on a server.
constexpr std::array kOldTables = {
    "CREATE TABLE mneme_space (id integer PRIMARY KEY CHECK (id = 1), schema_version integer NOT "
    "NULL, robot_name text NOT NULL, robot_hash text NOT NULL, joint_count integer NOT NULL, "
    "checksum bigint NOT NULL)",
    "CREATE TABLE mneme_head (id integer PRIMARY KEY CHECK (id = 1), generation bigint NOT NULL, "
    "epoch bigint NOT NULL, last_row bigint NOT NULL, last_tombstone bigint NOT NULL, row_count "
    "bigint NOT NULL, row_digest bigint NOT NULL, tombstone_count bigint NOT NULL, "
    "tombstone_digest bigint NOT NULL, checksum bigint NOT NULL)",
    "CREATE TABLE mneme_experience (id bigint NOT NULL, generation bigint NOT NULL, cell bigint "
    "NOT NULL, kind text NOT NULL, content bytea NOT NULL, components bigint NOT NULL, key bytea "
    "NOT NULL, checksum bigint NOT NULL, PRIMARY KEY (id, cell))",
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

/// The values of a table's rows in a file of schema 3, in the order of the server's columns; blobs
/// in hexadecimal digits.
struct OldValues {
  std::string table;
  std::vector<std::string> columns;
};
const std::vector<OldValues> kOldValues = {
    {"space", {"1", "3", "robot_name", "robot_hash", "joint_count", "checksum"}},
    {"head",
     {"1", "generation", "epoch", "last_row", "last_tombstone", "row_count", "row_digest",
      "tombstone_count", "tombstone_digest", "checksum"}},
    {"experience",
     {"id", "generation", "cell", "kind", "'\\x' || hex(content)", "components",
      "'\\x' || hex(key)", "checksum"}},
    {"mixture",
     {"id", "cell", "'\\x' || hex(means)", "'\\x' || hex(factor_rows)", "'\\x' || hex(factors)",
      "'\\x' || hex(origins)", "tool", "settings", "seed", "time", "checksum"}},
    {"tombstone", {"id", "row", "generation", "reason", "time", "checksum"}},
};

/// Fills the tables with the rows of a file.
void copy_old_rows(const std::string& path, PostgresConnection& connection) {
  auto file = require(internal::Connection::open(path, internal::Connection::Access::read_write));
  for (const OldValues& old : kOldValues) {
    std::string selected;
    for (std::size_t i = 0; i < old.columns.size(); ++i) {
      selected += (i > 0 ? ", quote(" : "quote(") + old.columns[i] + ")";
    }
    auto select = require(file.prepare("SELECT " + selected + " FROM " + old.table));
    REQUIRE(select.for_each([&] {
      std::string values;
      for (int i = 0; i < static_cast<int>(old.columns.size()); ++i) {
        values += (i > 0 ? ", " : "") + std::string(select.text(i));
      }
      return connection.query("INSERT INTO mneme_" + old.table + " VALUES (" + values + ")")
          .map([](const auto&) {});
    }));
  }
}

/// The URL of a database of schema 3 on the server, with the rows of a copy of the file at `path`.
std::string old_database(PostgresServer& server, const std::string& path) {
  std::filesystem::copy_file(source_file("tests/engines/schema3_planar.db"), path);
  const std::string url = server.new_url();
  PostgresConnection connection = connect_to(url);
  for (const char* table : kOldTables) REQUIRE(connection.query(table));
  copy_old_rows(path, connection);
  return url;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("processes that open tables of schema 3 at once all find them brought up") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    for (int round = 0; round < 5; ++round) {
      const TemporaryDirectory directory;
      const std::string url = old_database(*server, directory / "a.db");
      const auto expected = require(Database::inspect(directory / "a.db"));
      std::vector<pid_t> children;
      for (const OpenMode mode : {OpenMode::read_write, OpenMode::read_only, OpenMode::read_write,
                                  OpenMode::read_only, OpenMode::read_write}) {
        children.push_back(start_child([&] {
          const auto database = Database::open(url, expected.signature(), mode);
          if (!database) return 1;
          return database->size() == expected.size() ? 0 : 2;
        }));
      }
      for (const pid_t child : children) CHECK(wait_for(child) == 0);
      CHECK(verify_database(url)->empty());
    }
  }

  TEST_CASE("a reader of tables of schema 3 outlives its connection") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const TemporaryDirectory directory;
    const std::string url = old_database(*server, directory / "a.db");
    auto reader = require(Database::inspect(url));
    const std::int64_t size = reader.size();
    run_on_server(url,
                  "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE "
                  "pid <> pg_backend_pid() AND backend_type = 'client backend'");
    // The first call notices it.
    const auto lost = reader.refresh();
    if (!lost) CHECK(lost.error().code == ErrorCode::io);
    require(reader.refresh());
    CHECK(reader.size() == size);
  }

  TEST_CASE("tables of schema 3 are brought up by who writes, and copied by who reads") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const TemporaryDirectory directory;
    const std::string url = old_database(*server, directory / "a.db");
    const auto expected = require(Database::inspect(directory / "a.db"));
    std::vector<Result<Database>> opened;  // readers that stay keep nobody from it
    for (const OpenMode mode :
         {OpenMode::read_only, OpenMode::read_write, OpenMode::read_write, OpenMode::read_only}) {
      const auto& database = opened.emplace_back(Database::open(url, expected.signature(), mode));
      REQUIRE_MESSAGE(database.has_value(), (database ? "" : database.error().message));
      REQUIRE(database->size() == expected.size());
      for (std::int64_t i = 0; i < database->size(); ++i) {
        CHECK(is_same_content(*database->get(i), *expected.get(i)));
      }
      CHECK(verify_database(url)->empty());
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a database on a server is used like one in a file") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    Rng rng(1);
    auto rows = random_rows(rng, 30);
    rows[3].sampler() = {};
    CHECK(Database::inspect(url)->info().schema_version == 0);
    CHECK(open_database(url, OpenMode::read_only).size() == 0);
    Database writer = open_database(url);
    Database reader = open_database(url, OpenMode::read_only);
    require(writer.insert(rows));
    CHECK(writer.insert({rows[2]}) == std::vector<std::int64_t>{3});
    CHECK(reader.refresh() == 30);
    CHECK(reader.refresh() == 0);
    rows[3].sampler().joint_count = 3;
    const Database again = open_database(url, OpenMode::read_write);
    for (const Database* database :
         std::initializer_list<const Database*>{&writer, &reader, &again}) {
      REQUIRE(database->size() == 30);
      for (int i = 0; i < 30; ++i) {
        CHECK(database->get(i)->id == i + 1);
        CHECK(is_same_content(*database->get(i), rows[static_cast<std::size_t>(i)]));
      }
    }
    CHECK(again.info().bytes > 8192);
    CHECK(again.info().schema_version == 4);
    CHECK(!reader.insert({rows[0]}).has_value());
    RobotSignature other = arm_signature();
    other.model_hash = "other";
    CHECK(Database::open(url, other, OpenMode::create).error().code == ErrorCode::wrong_robot);
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("text that would be SQL is stored as it is, in every field") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string attack =
        "x'); DROP TABLE mneme_experience CASCADE; --\"\\ $1 \\. \n\t{,} E'\\\\'";
    const std::string url = server->new_url();
    const RobotSignature space{attack, attack, attack, 3};
    Rng rng(2);
    Experience row = random_experience(rng);
    row.provenance = {attack, attack, 1, attack};
    require(Database::open(url, space, OpenMode::create)->insert({row}));
    const auto database = require(Database::open(url, space, OpenMode::read_only));
    REQUIRE(database.size() == 1);
    CHECK(is_same_content(*database.get(0), row));
    CHECK(database.signature().robot_name == attack);
    // A URL is for libpq alone: what it does not understand is no SQL either.
    CHECK(
        !Database::inspect(server->url() + "&options=-csearch_path%3D'; DROP TABLE x").has_value());
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("damaged rows are named, set aside, healed by a merge and removed") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const TemporaryDirectory directory;
    const std::string url = server->new_url();
    Rng rng(3);
    const auto rows = random_rows(rng, 10);
    require(open_database(url).insert(rows));
    REQUIRE(merge_databases(directory / "copy.db", url)->added == 10);
    run_on_server(url, "UPDATE mneme_mixture SET seed = seed # 1 WHERE id = 2");
    run_on_server(url, "UPDATE mneme_experience SET generation = 7 WHERE id = 4");
    run_on_server(url, "DELETE FROM mneme_mixture WHERE id = 6");
    run_on_server(url, "DELETE FROM mneme_experience WHERE id = 8");
    CHECK(open_error(url).code == ErrorCode::corrupt);
    std::set<std::int64_t> named;
    const auto damages = require(verify_database(url, VerifyMode::quarantine));
    for (const Damage& damage : damages) {
      named.insert(damage.id);
      CHECK_MESSAGE(damage.is_quarantined, damage.what);
    }
    CHECK(named == std::set<std::int64_t>{0, 2, 4, 6, 8});
    CHECK(verify_database(url)->empty());
    Database database = open_database(url, OpenMode::read_write);
    CHECK(database.size() == 6);
    CHECK(merge_databases(url, directory / "copy.db")->added == 4);
    CHECK(database.refresh() == 4);
    CHECK(require(compact_database(url)).removed == 3);
    CHECK(database.refresh() == 0);
    CHECK(database.size() == 10);
    CHECK(database.info().tombstones == 0);
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("processes that create and fill one database do not lose each other's rows") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    std::vector<pid_t> children;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      children.push_back(start_child([&] {
        auto database = Database::open(url, arm_signature(), OpenMode::create);
        Rng rng(seed);
        for (int i = 0; database && i < 10; ++i) {
          if (!database->insert(random_rows(rng, 2))) return 2;
        }
        return database ? 0 : 1;
      }));
    }
    for (const pid_t child : children) CHECK(wait_for(child) == 0);
    CHECK(open_database(url, OpenMode::read_only).size() == 60);
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("whoever searches or refreshes does not wait for whoever waits to write to a server") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    Rng rng(8);
    const auto rows = random_rows(rng, 20);
    REQUIRE(open_database(url).insert(rows));
    const TemporaryDirectory directory;
    const EnvironmentVariable cache("XDG_CACHE_HOME", directory / "");
    const auto partly = require(Database::open(url, arm_signature(), OpenMode::read_only, {0}));
    Database reader = open_database(url, OpenMode::read_only);
    Database writer = open_database(url);
    auto lock = connect_to(url);
    require(lock.query("BEGIN"));
    require(lock.query("SELECT 1 FROM mneme_head FOR UPDATE"));
    std::atomic<bool> is_inserted = false;
    std::thread waiting([&] {
      Rng other(9);
      is_inserted = writer.insert(random_rows(other, 2)).has_value();
    });
    for (const Experience& row : rows) {
      CHECK(find_like(writer, make_primitive(row.key), 1e-9, 1)->size() == 1);
      const auto matches = find_like(partly, make_primitive(row.key), 1e-9, 1);
      REQUIRE(matches->size() == 1);
      CHECK(is_same_content(*matches->front().experience, row));
    }
    CHECK(reader.refresh() == 0);
    CHECK(!is_inserted);
    require(lock.query("ROLLBACK"));
    waiting.join();
    CHECK(is_inserted);
    CHECK(reader.refresh() == 2);
  }

  TEST_CASE("a role without the right to write can read, and no more") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    Rng rng(4);
    require(open_database(url).insert(random_rows(rng, 2)));
    const std::string schema = url.substr(url.rfind("test"));
    run_on_server(url, "CREATE ROLE reader_" + schema + " LOGIN");
    run_on_server(url, "GRANT USAGE ON SCHEMA " + schema + " TO reader_" + schema);
    run_on_server(url, "GRANT SELECT ON ALL TABLES IN SCHEMA " + schema + " TO reader_" + schema);
    const std::string reader = url + "&user=reader_" + schema;
    CHECK(open_database(reader, OpenMode::read_only).size() == 2);
    auto writer = require(Database::open(reader, arm_signature(), OpenMode::read_write));
    const Error refused = require_error(writer.insert(random_rows(rng, 1)));
    CHECK(refused.code == ErrorCode::io);
    CHECK(contains(refused.message, "permission denied"));
  }

  TEST_CASE("what was acknowledged survives a killed postmaster, and the writer goes on") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    Rng rng(5);
    Database database = open_database(url);
    std::set<std::uint64_t> acknowledged;
    for (int round = 0; round < 2; ++round) {
      std::atomic<bool> is_killed = false;
      std::thread killer;
      for (int i = 0;; ++i) {
        if (i == 5) {
          killer = std::thread([&] {
            server->kill_postmaster();
            is_killed = true;
          });
        }
        const auto rows = random_rows(rng, 20);
        const auto ids = database.insert(rows);
        if (!ids) {
          CHECK(ids.error().code == ErrorCode::io);
          break;
        }
        for (const Experience& row : rows) acknowledged.insert(row.provenance.seed);
        // Backends outlive their postmaster until they are told to end.
        if (is_killed) {
          auto ending = internal::PostgresConnection::open(url);
          if (i > 2000) break;
        }
      }
      killer.join();
      REQUIRE(server->start());
      REQUIRE(verify_database(url)->empty());
      require(database.insert(random_rows(rng, 1)));
      require(database.refresh());
      std::set<std::uint64_t> stored;
      for (std::int64_t i = 0; i < database.size(); ++i) {
        stored.insert(database.get(i)->provenance.seed);
      }
      CHECK(std::includes(stored.begin(), stored.end(), acknowledged.begin(), acknowledged.end()));
    }
  }

  TEST_CASE("a server that hangs holds nobody up, and queued rows are stored when it is back") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    Rng rng(8);
    auto database = require(Database::open(server->new_url(), arm_signature(), OpenMode::create,
                                           {.answer_timeout_s = 0.3}));
    REQUIRE(database.insert(random_rows(rng, 3)));
    struct Hang {
      explicit Hang(const PostgresServer& stopped) : server(stopped) { server.signal(SIGSTOP); }
      Hang(const Hang&) = delete;
      Hang& operator=(const Hang&) = delete;
      ~Hang() { server.signal(SIGCONT); }
      const PostgresServer& server;
    };
    {
      const Hang hang(*server);
      const Stopwatch stopwatch;
      REQUIRE(database.insert_later(random_rows(rng, 4)));
      CHECK(find_like(database, make_primitive(random_key(rng)), 3, 8).has_value());
      CHECK(stopwatch.elapsed_s() < 0.2);
      CHECK(database.refresh().error().code == ErrorCode::io);
      CHECK(database.insert(random_rows(rng, 1)).error().code == ErrorCode::io);
      CHECK(!database.flush(0.1).has_value());
      CHECK(stopwatch.elapsed_s() < 5);
      while (database.queued_rows().failure.empty() && stopwatch.elapsed_s() < 10) {
        std::this_thread::yield();
      }
      CHECK(database.queued_rows().waiting == 4);
      CHECK(contains(database.queued_rows().failure, "did not answer"));
    }
    REQUIRE(database.flush(20));
    CHECK(database.size() == 7);
    const Hang hang(*server);
    REQUIRE(database.insert_later(random_rows(rng, 2)));
    const Stopwatch stopwatch;
    database.stop_waiting();
    CHECK(database.refresh().error().code == ErrorCode::io);
    CHECK(database.queued_rows().waiting == 2);
    { const Database closed = std::move(database); }
    CHECK(stopwatch.elapsed_s() < 1);
  }

  TEST_CASE("a writer that is killed in a transaction leaves nothing of it") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::uint64_t seed = 6;
    const std::string url = server->new_url();
    open_database(url);
    Rng rng(seed);
    for (int round = 0; round < 5; ++round) {
      const std::uint64_t child_seed = rng.next();
      const pid_t child = start_child([&] {
        auto database = Database::open(url, arm_signature(), OpenMode::create);
        Rng child_rng(child_seed);
        while (database && database->insert(random_rows(child_rng, 50))) {
        }
        return 1;
      });
      const auto end =
          std::chrono::steady_clock::now() + std::chrono::microseconds(5000 + rng.index(60000));
      while (std::chrono::steady_clock::now() < end) {
      }
      ::kill(child, SIGKILL);
      (void)wait_for(child);
      INFO("seed " << seed << ", round " << round);
      REQUIRE(verify_database(url)->empty());
      REQUIRE(open_database(url, OpenMode::read_only).size() % 50 == 0);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a server that is not there is an error of its own kind") {
    const auto store =
        internal::open_postgres_store("postgresql://127.0.0.1:1/x", OpenMode::read_only);
    REQUIRE(!store.has_value());
    CHECK(store.error().code == ErrorCode::io);
  }

  TEST_CASE("a server that takes a connection and says nothing is given up") {
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    REQUIRE(::bind(listener, reinterpret_cast<sockaddr*>(&address), size) == 0);
    REQUIRE(::listen(listener, 1) == 0);
    REQUIRE(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) == 0);
    const std::string url =
        fmt::format("postgresql://127.0.0.1:{}/x?connect_timeout=1", ntohs(address.sin_port));
    const Stopwatch stopwatch;
    const Error error = require_error(internal::open_postgres_store(url, OpenMode::read_only));
    CHECK(error.code == ErrorCode::io);
    CHECK_MESSAGE(contains(error.message, "did not answer within 1.0 s"), error.message);
    CHECK(stopwatch.elapsed_s() < 5);
    ::close(listener);
  }
}

}  // namespace mneme::test
