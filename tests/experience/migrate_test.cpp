// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/migrate.h"

#include "experience/fixtures.h"

namespace mneme::test {
namespace {

std::string old_file(const TemporaryDirectory& directory) {
  const std::string path = directory / "a.db";
  std::filesystem::copy_file(source_file("tests/experience/schema1.db"), path);
  return path;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a migration moves all rows under their ids and leaves a copy") {
    const TemporaryDirectory directory;
    const std::string path = old_file(directory);
    const auto migrated = internal::migrate_file(path);
    REQUIRE_MESSAGE(migrated.has_value(), (migrated ? "" : migrated.error().message));
    CHECK(migrated->from == 1);
    CHECK(migrated->to == 2);
    CHECK(migrated->rows == 2);
    CHECK(migrated->duplicates == 0);
    CHECK(migrated->left_out.empty());
    CHECK(migrated->copy == path + ".schema1");
    const Database database = open_database(path, OpenMode::read_only);
    CHECK(database.info().schema_version == 2);
    const Database copy = open_database(migrated->copy, OpenMode::read_only);
    CHECK(copy.info().schema_version == 1);
    REQUIRE(copy.size() == 2);
    for (int i = 0; i < 2; ++i) {
      CHECK(copy.get(i)->id == database.get(i)->id);
      CHECK(is_same_content(*copy.get(i), *database.get(i)));
    }
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a database of the present schema stays as it is") {
    const TemporaryDirectory directory;
    open_database(directory / "a.db");
    const auto migrated = internal::migrate_file(directory / "a.db");
    REQUIRE(migrated.has_value());
    CHECK(migrated->from == 2);
    CHECK(migrated->to == 2);
    CHECK(migrated->copy.empty());
  }

  TEST_CASE("damaged rows and repetitions stay behind in the copy, and are named") {
    const TemporaryDirectory directory;
    const std::string path = old_file(directory);
    run_sql(path,
            "INSERT INTO experience SELECT 3, key, means, factor_rows, factors, origins, "
            "tool, settings, seed, time, checksum FROM experience WHERE id = 1;"
            "UPDATE experience SET seed = 5 WHERE id = 2");
    const auto migrated = internal::migrate_file(path);
    REQUIRE(migrated.has_value());
    CHECK(migrated->rows == 1);
    CHECK(migrated->duplicates == 1);
    REQUIRE(migrated->left_out.size() == 1);
    CHECK(migrated->left_out[0].id == 2);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a running reader goes on across a migration") {
    const TemporaryDirectory directory;
    const std::string path = old_file(directory);
    Database reader = open_database(path, OpenMode::read_only);
    REQUIRE(internal::migrate_file(path).has_value());
    CHECK(reader.refresh() == 0);
    CHECK(reader.size() == 2);
    Rng rng(16);
    REQUIRE(open_database(path, OpenMode::read_write).insert(random_rows(rng, 1)));
    CHECK(reader.refresh() == 1);
  }

  TEST_CASE("a newer database and a missing one are refused") {
    const TemporaryDirectory directory;
    open_database(directory / "a.db");
    run_sql(directory / "a.db", "PRAGMA user_version = 9; CREATE TABLE more (a)");
    CHECK(internal::migrate_file(directory / "a.db").error().code == ErrorCode::unsupported);
    CHECK(internal::migrate_file(directory / "b.db").error().code == ErrorCode::io);
  }
}

}  // namespace mneme::test
