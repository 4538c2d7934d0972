// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

namespace mneme::test {
namespace {

void create(const std::string& path) {
  Rng rng(71);
  REQUIRE(open_database(path).insert(random_rows(rng, 6)));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a sound database has no damage, also while it is being written") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    CHECK(verify_database(directory / "a.db")->empty());
    Rng rng(72);
    Database database = open_database(directory / "a.db", OpenMode::read_write);
    REQUIRE(database.insert(random_rows(rng, 1)));
    CHECK(verify_database(directory / "a.db")->empty());
  }

  TEST_CASE("every damaged row is listed with its id, and opening names the first") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE experience SET seed = seed + 1 WHERE id IN (2, 5)");
    const auto damages = verify_database(directory / "a.db");
    REQUIRE(damages.has_value());
    REQUIRE(damages->size() == 2);
    CHECK(damages->at(0).id == 2);
    CHECK(damages->at(1).id == 5);
    CHECK(damages->at(0).what.find("checksum") != std::string::npos);

    const Error error = open_error(directory / "a.db");
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(error.message.find("row 2 is damaged") != std::string::npos);
    CHECK(error.message.find("`mneme db verify " + (directory / "a.db") + "`") !=
          std::string::npos);
  }

  TEST_CASE("a missing row is damage to the file itself") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    run_sql(directory / "a.db", "DELETE FROM experience WHERE id = 6");
    const auto damages = verify_database(directory / "a.db");
    REQUIRE(damages.has_value());
    REQUIRE(damages->size() == 1);
    CHECK(damages->at(0).id == 0);
    CHECK(damages->at(0).what.find("holds 5 rows, but 6 were inserted") != std::string::npos);
    CHECK(open_error(directory / "a.db").code == ErrorCode::corrupt);
  }

  TEST_CASE("a file that is no database is damaged, and one that is not there is an error") {
    const TemporaryDirectory directory;
    write_file(directory / "text.db", "This is a letter.");
    write_file(directory / "long.db", std::string(100000, '#'));
    for (const std::string name : {"text.db", "long.db"}) {
      CHECK(first_damage(directory / name).find("not a mneme database") != std::string::npos);
      for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
        CHECK(open_error(directory / name, mode).code == ErrorCode::corrupt);
      }
    }
    CHECK(read_file(directory / "text.db") == "This is a letter.");
    const auto missing = verify_database(directory / "none.db");
    REQUIRE(!missing.has_value());
    CHECK(missing.error().code == ErrorCode::io);
  }

  TEST_CASE("the database of another program is damaged and stays untouched") {
    const TemporaryDirectory directory;
    run_sql(directory / "a.db", "CREATE TABLE birds (name)");
    const std::string before = read_file(directory / "a.db");
    CHECK(first_damage(directory / "a.db").find("no mneme database") != std::string::npos);
    CHECK(open_error(directory / "a.db", OpenMode::create).code == ErrorCode::corrupt);
    CHECK(read_file(directory / "a.db") == before);
  }

  TEST_CASE("a database of a newer mneme is refused rather than judged") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    run_sql(directory / "a.db", "PRAGMA user_version = 2");
    const auto damages = verify_database(directory / "a.db");
    REQUIRE(!damages.has_value());
    CHECK(damages.error().code == ErrorCode::unsupported);
    CHECK(open_error(directory / "a.db").code == ErrorCode::unsupported);
  }
}

}  // namespace mneme::test
