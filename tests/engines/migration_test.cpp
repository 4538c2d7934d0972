// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "engines/sqlite_store.h"
#include "support/planar_memory.h"

#include <map>

namespace mneme::test {
namespace {

/// Copies a database of schema 3, which mneme 0.1.0 wrote.
std::string copy_of(const std::string& name, const TemporaryDirectory& directory) {
  const std::string path = directory / "a.db";
  std::filesystem::copy_file(source_file("tests/engines/" + name), path);
  std::filesystem::permissions(path, std::filesystem::perms::owner_write,
                               std::filesystem::perm_options::add);
  return path;
}

/// The rows of tests/engines/schema3.db.
std::vector<Experience> golden_rows() {
  Experience full;
  full.kind = kPairs;
  full.key = {3.5, 1.25, 1, 3.5, -1.25, 1.5};
  full.sampler() = {
      {3, {0.5f, -1, 2, 3, 0.25f, -0.125f}, {-1, 0}, {1, 0.5f, 1, 0, 0.25f, 2}, {4, -1}}};
  full.provenance = {"mneme 0.1.0", "starts-per-link=3", 0xfedcba9876543210u,
                     "2020-01-02T03:04:05Z"};
  Experience empty;
  empty.kind = kPairs;
  empty.key = {2, 0.5, 1, 6, -0.5, 2};
  empty.sampler().joint_count = 3;
  empty.provenance = {"mneme 0.1.0", "", 1, "2020-01-02T03:04:06Z"};
  return {full, empty};
}

/// tests/engines/schema3_planar.db: lessons that a budget ended, a solved path, the same under a
/// constraint and with another number of states, and pairs of bodies, some of them superseded.
Database open_planar(const std::string& path, OpenMode mode) {
  return require(Database::open(path, make_signature(planar8()), mode));
}

std::map<std::int64_t, Experience> rows_by_id(const Database& database) {
  std::map<std::int64_t, Experience> rows;
  for (std::int64_t i = 0; i < database.size(); ++i) {
    rows.emplace(database.get(i)->id, *database.get(i));
  }
  return rows;
}

std::int64_t version_of(const std::string& path) {
  auto connection =
      require(internal::Connection::open(path, internal::Connection::Access::read_write));
  return connection.integer("PRAGMA user_version").value();
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a database of schema 3 is brought up by whoever opens it to write, once") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3.db", directory);
    const auto rows = golden_rows();
    for (int i = 0; i < 2; ++i) {
      Database database = open_database(path, OpenMode::read_write);
      CHECK(database.info().schema_version == 4);
      REQUIRE(database.size() == 2);
      CHECK(is_same_content(*database.get(0), rows[0]));
      CHECK(is_same_content(*database.get(1), rows[1]));
      CHECK(database.insert(rows) == std::vector<std::int64_t>{1, 2});
    }
    CHECK(version_of(path) == 4);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a reader of a database of schema 3 sees the same and leaves it as it is") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3_planar.db", directory);
    const std::string before = read_file(path);
    const Database reader = open_planar(path, OpenMode::read_only);
    CHECK(reader.info().bytes == static_cast<std::int64_t>(before.size()));
    const auto seen = rows_by_id(reader);
    CHECK(verify_database(path)->empty());
    CHECK(read_file(path) == before);
    const auto migrated = rows_by_id(open_planar(path, OpenMode::read_write));
    REQUIRE(seen.size() == migrated.size());
    for (const auto& [id, row] : seen) CHECK(is_same_content(row, migrated.at(id)));
  }

  TEST_CASE("what stood in texts and keys of schema 3 becomes fields, and each row stays once") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3_planar.db", directory);
    const Database database = open_planar(path, OpenMode::read_write);
    auto rows = rows_by_id(database);
    REQUIRE(rows.size() == 9);
    for (const std::int64_t id : {1, 2}) {
      CHECK_FALSE(rows.at(id).sampler().is_complete);
      CHECK(rows.at(id).provenance.settings.ends_with(" budget cut short"));
    }
    for (const std::int64_t id : {9, 10, 11}) CHECK(rows.at(id).sampler().is_complete);
    CHECK(rows.at(3).path().planning_states == 6608);
    CHECK(rows.at(4).path().planning_states == 8296);
    CHECK_FALSE(rows.at(7).path().planning_states.has_value());
    CHECK(rows.at(8).path().planning_states == 6608);
    for (const std::int64_t id : {3, 4, 7}) CHECK(rows.at(id).path().constraints == 0);
    CHECK(rows.at(8).path().constraints == 591);
    CHECK(rows.at(8).key == rows.at(3).key);
    CHECK(rows.at(8).path().waypoints == rows.at(3).path().waypoints);
    CHECK(database.info().tombstones == 0);
    CHECK(database.kinds().size() == 3);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("paths of schema 3 are found under their constraints alone") {
    const TemporaryDirectory directory;
    const Database database =
        open_planar(copy_of("schema3_planar.db", directory), OpenMode::read_only);
    const Problem problem = planar_problem("scenario1");
    const auto found_under = [&](const std::vector<OrientationConstraint>& constraints) {
      const LocalPrimitive query =
          make_query_primitive(problem.robot, problem.start, problem.goals.front(), constraints);
      const auto found = require(database.find(query.kind, std::vector<PrimitiveKey>{query.key},
                                               1e-12, 0, nullptr, query.constraints));
      std::vector<std::int64_t> ids;
      for (const KeyMatch& match : found) ids.push_back(match.experience->id);
      return ids;
    };
    CHECK(found_under({}) == std::vector<std::int64_t>{3});
    CHECK(found_under({{"link_8", Vec3::UnitZ(), Vec3::UnitZ(), 0.2}}) ==
          std::vector<std::int64_t>{8});
    CHECK(found_under({{"link_8", Vec3::UnitZ(), Vec3::UnitZ(), 0.3}}).empty());
  }

  TEST_CASE("what is damaged in a database of schema 3 stays damaged, and can be set aside") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3_planar.db", directory);
    run_sql(path, "UPDATE mixture SET seed = seed + 1 WHERE id = 2");
    CHECK(contains(require_error(Database::inspect(path)).message, "row 2 is damaged"));
    const auto damages = require(verify_database(path, VerifyMode::quarantine));
    REQUIRE(damages.size() == 1);
    CHECK(damages.front().id == 2);
    CHECK(damages.front().is_quarantined);
    CHECK(rows_by_id(open_planar(path, OpenMode::read_only)).size() == 8);
  }

  TEST_CASE("a damaged row of schema 3 does not hide a sound one that becomes the same") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3_planar.db", directory);
    // Rows 3 and 12 differ only in the number of states, which is no part of what a row is.
    CHECK(!rows_by_id(open_planar(path, OpenMode::read_only)).contains(12));
    run_sql(path, "UPDATE mixture SET seed = seed + 1 WHERE id = 3");
    const auto damages = require(verify_database(path, VerifyMode::quarantine));
    REQUIRE(damages.size() == 1);
    CHECK(damages.front().id == 3);
    const auto rows = rows_by_id(open_planar(path, OpenMode::read_only));
    CHECK(rows.size() == 9);
    CHECK(rows.at(12).path().planning_states == 9999);
  }

  TEST_CASE("a database of schema 3 that sqlite3's .dump saved is brought up, too") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3.db", directory);
    run_sql(path, "PRAGMA application_id = 0; PRAGMA user_version = 0");
    CHECK(open_database(path, OpenMode::read_only).size() == 2);
    CHECK(open_database(path, OpenMode::read_write).size() == 2);
    CHECK(version_of(path) == 4);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("who cannot wait for another process that migrates is told of it") {
    const TemporaryDirectory directory;
    const std::string path = copy_of("schema3.db", directory);
    auto other =
        require(internal::Connection::open(path, internal::Connection::Access::read_write));
    REQUIRE(other.execute("BEGIN IMMEDIATE"));
    const auto refused =
        internal::open_sqlite_store(path, OpenMode::read_write, internal::LossCheck::refuse, 20);
    REQUIRE(!refused.has_value());
    CHECK(refused.error().code == ErrorCode::io);
    CHECK(contains(refused.error().message, "is migrated when it is opened"));
    REQUIRE(other.execute("ROLLBACK"));
    CHECK(internal::open_sqlite_store(path, OpenMode::read_write).has_value());
  }

  TEST_CASE("a database of schema 3 that has lost rows is not brought up") {
    for (const std::string change :
         {"DELETE FROM experience WHERE id = 2; DELETE FROM mixture WHERE id = 2",
          "UPDATE tombstone SET row = 3", "UPDATE head SET row_count = 5",
          "UPDATE space SET joint_count = 7"}) {
      const TemporaryDirectory directory;
      const std::string path = copy_of("schema3_planar.db", directory);
      run_sql(path, change);
      INFO(change);
      for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write}) {
        const Error error = require_error(Database::open(path, make_signature(planar8()), mode));
        CHECK(error.code == ErrorCode::corrupt);
      }
      CHECK(version_of(path) == 3);
      CHECK(!verify_database(path, VerifyMode::quarantine)->empty());
    }
  }
}

}  // namespace mneme::test
