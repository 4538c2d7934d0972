// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"

#include <algorithm>

namespace mneme::test {
namespace {

void create_database(const std::string& path) {
  Rng rng(71);
  REQUIRE(open_database(path).insert(random_rows(rng, 6)));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a database is adopted by a robot with other limits, not by another arm") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    const RobotSignature arm{"arm", "11111111aaaaaaaa", "0123456789abcdef", 3};
    const RobotSignature limited{"limited", "11111111bbbbbbbb", "0123456789abcdef", 3};
    const RobotSignature other{"other", "22222222aaaaaaaa", "0123456789abcdef", 3};
    Rng rng(70);
    REQUIRE(Database::open(path, arm, OpenMode::create)->insert(random_rows(rng, 6)));
    CHECK(Database::open(path, limited, OpenMode::read_only).error().code ==
          ErrorCode::wrong_robot);
    CHECK(require(adopt_database(path, limited)).robot_name == "arm");
    CHECK(Database::open(path, limited, OpenMode::read_only)->size() == 6);
    CHECK(Database::inspect(path)->signature().robot_name == "limited");
    CHECK(verify_database(path)->empty());
    CHECK_FALSE(Database::open(path, arm, OpenMode::read_only).has_value());
    for (const bool is_forced : {false, true}) {
      CHECK(require_error(adopt_database(path, other, is_forced)).code == ErrorCode::wrong_robot);
    }
    CHECK(Database::inspect(path)->signature().robot_name == "limited");
  }

  TEST_CASE("an older database is adopted if that is forced, and an empty one not at all") {
    const TemporaryDirectory directory;
    create_database(directory / "old.db");
    const RobotSignature limited{"limited", "11111111bbbbbbbb", "ffffffffffffffff", 3};
    const Error refused = require_error(adopt_database(directory / "old.db", limited));
    CHECK(refused.code == ErrorCode::wrong_robot);
    CHECK(contains(refused.message, "--force"));
    CHECK(adopt_database(directory / "old.db", limited, true).has_value());
    CHECK(Database::open(directory / "old.db", limited, OpenMode::read_only)->size() == 6);
    write_file(directory / "empty.db", "");
    CHECK(adopt_database(directory / "empty.db", limited).error().code == ErrorCode::invalid);
    CHECK(adopt_database(directory / "none.db", limited).error().code == ErrorCode::io);
  }

  TEST_CASE("a sound database has no damage, also while it is being written") {
    const TemporaryDirectory directory;
    create_database(directory / "a.db");
    CHECK(verify_database(directory / "a.db")->empty());
    Rng rng(72);
    Database database = open_database(directory / "a.db", OpenMode::read_write);
    REQUIRE(database.insert(random_rows(rng, 1)));
    CHECK(verify_database(directory / "a.db")->empty());
  }

  TEST_CASE("every damaged row is listed with its id, and opening names the first") {
    const TemporaryDirectory directory;
    create_database(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id IN (2, 5)");
    const auto damages = require(verify_database(directory / "a.db"));
    REQUIRE(damages.size() == 2);
    CHECK(damages.at(0).id == 2);
    CHECK(damages.at(1).id == 5);
    CHECK(contains(damages.at(0).what, "checksum"));

    const Error error = open_error(directory / "a.db");
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(contains(error.message, "row 2 is damaged"));
    CHECK(contains(error.message, "`mneme db verify " + (directory / "a.db") + "`"));
  }

  TEST_CASE("rows that lost a part are named, and one that lost both is counted") {
    const TemporaryDirectory directory;
    create_database(directory / "a.db");
    run_sql(directory / "a.db",
            "DELETE FROM experience WHERE id IN (3, 6); DELETE FROM mixture WHERE id IN (4, 6)");
    const auto damages = require(verify_database(directory / "a.db"));
    REQUIRE(damages.size() == 3);
    CHECK(damages.at(0).id == 4);
    CHECK(contains(damages.at(0).what, "mixture is missing"));
    CHECK(damages.at(1).id == 0);
    CHECK(contains(damages.at(1).what, "holds 4 rows, but 6 were inserted"));
    CHECK(damages.at(2).id == 3);
    CHECK(open_error(directory / "a.db").code == ErrorCode::corrupt);
  }

  TEST_CASE("reporting changes nothing, quarantine leaves what can be used") {
    const TemporaryDirectory directory;
    create_database(directory / "a.db");
    run_sql(directory / "a.db",
            "UPDATE mixture SET seed = seed + 1 WHERE id = 2;"
            "UPDATE experience SET cell = cell + 1 WHERE id = 5");
    CHECK(verify_database(directory / "a.db")->size() == 2);
    // A changed checksum or key also changes what the head counts.
    const auto damages = verify_database(directory / "a.db", VerifyMode::quarantine);
    REQUIRE(damages->size() == 2);
    for (const Damage& damage : *damages) CHECK(damage.is_quarantined);
    CHECK(verify_database(directory / "a.db")->empty());
    Database database = open_database(directory / "a.db", OpenMode::read_write);
    REQUIRE(database.size() == 4);
    CHECK(database.get(1)->id == 3);
    CHECK(database.info().tombstones == 2);
    Rng rng(73);
    CHECK(database.insert(random_rows(rng, 1)) == std::vector<std::int64_t>{7});
  }

  TEST_CASE("a head that does not fit the rows is written anew") {
    for (const std::string change :
         {"DELETE FROM head", "UPDATE head SET row_count = 7", "DELETE FROM mixture WHERE id = 6",
          "UPDATE experience SET checksum = 5 WHERE id = 6", "UPDATE tombstone SET row = 3",
          "DELETE FROM tombstone"}) {
      const TemporaryDirectory directory;
      create_database(directory / "a.db");
      run_sql(directory / "a.db", "DELETE FROM mixture WHERE id = 1");
      REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
      run_sql(directory / "a.db", change);
      INFO(change);
      REQUIRE(!verify_database(directory / "a.db", VerifyMode::quarantine)->empty());
      CHECK(verify_database(directory / "a.db")->empty());
      Rng rng(74);
      Database database = open_database(directory / "a.db", OpenMode::read_write);
      CHECK(database.size() >= 4);
      CHECK(database.get(0)->id == 2);
      CHECK(database.insert(random_rows(rng, 1)) == std::vector<std::int64_t>{7});
    }
  }

  TEST_CASE("what cannot be cured says why") {
    const TemporaryDirectory directory;
    create_database(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE robot SET model_hash = 'other'");
    const auto damages = verify_database(directory / "a.db", VerifyMode::quarantine);
    REQUIRE(damages->size() == 2);
    CHECK(!damages->at(0).is_quarantined);
    CHECK(contains(damages->at(0).what, "names the robot is damaged"));
    CHECK(damages->at(1).what.find("nothing was set aside") == 0);
  }

  TEST_CASE("a file that is no database is damaged, and one that is not there is an error") {
    const TemporaryDirectory directory;
    write_file(directory / "text.db", "This is a letter.");
    write_file(directory / "long.db", std::string(100000, '#'));
    for (const std::string name : {"text.db", "long.db"}) {
      CHECK(contains(first_damage(directory / name), "not a mneme database"));
      for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
        CHECK(open_error(directory / name, mode).code == ErrorCode::corrupt);
      }
    }
    CHECK(read_file(directory / "text.db") == "This is a letter.");
    CHECK(require_error(verify_database(directory / "none.db")).code == ErrorCode::io);
  }

  TEST_CASE("the database of another program is damaged and stays untouched") {
    const TemporaryDirectory directory;
    run_sql(directory / "a.db", "CREATE TABLE birds (name)");
    const std::string before = read_file(directory / "a.db");
    const auto damages = verify_database(directory / "a.db", VerifyMode::quarantine);
    REQUIRE(damages->size() == 2);
    CHECK(contains(damages->at(0).what, "not a mneme database"));
    CHECK(damages->at(1).what.find("nothing was set aside") == 0);
    CHECK(!std::filesystem::exists(directory / "a.db.damaged"));
    CHECK(open_error(directory / "a.db", OpenMode::create).code == ErrorCode::corrupt);
    CHECK(read_file(directory / "a.db") == before);
  }

  TEST_CASE("a database of a newer mneme is refused rather than judged") {
    const TemporaryDirectory directory;
    create_database(directory / "a.db");
    run_sql(directory / "a.db", "PRAGMA user_version = 5; CREATE TABLE more (a)");
    CHECK(require_error(verify_database(directory / "a.db")).code == ErrorCode::unsupported);
    CHECK(open_error(directory / "a.db").code == ErrorCode::unsupported);
  }
}

namespace {

void fill_database(const std::string& path, const std::vector<Experience>& rows) {
  require(open_database(path).insert(rows));
}

/// The rows of a database without their ids.
std::vector<std::string> contents(const std::string& path) {
  const Database database = open_database(path, OpenMode::read_only);
  std::vector<std::string> result;
  for (std::int64_t i = 0; i < database.size(); ++i) {
    const Experience row = *database.get(i);
    std::string text = row.provenance.time + row.provenance.tool;
    for (const double number : row.key) text += " " + std::to_string(number);
    result.push_back(text + std::to_string(row.provenance.seed));
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("merging is idempotent, commutative and associative") {
    const TemporaryDirectory directory;
    Rng rng(24);
    const auto rows = random_rows(rng, 30);
    std::vector<std::vector<Experience>> parts(3);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // Every row is in one part or more, each time with another provenance.
      for (std::size_t part = 0; part < 3; ++part) {
        if (i % 3 != part && rng.index(3) > 0) continue;
        Experience row = rows[i];
        row.provenance.time = "20" + std::to_string(20 + rng.index(5));
        row.provenance.tool = "tool " + std::to_string(rng.index(3));
        parts[part].push_back(row);
      }
    }
    const std::vector<std::vector<int>> orders = {{0, 1, 2}, {2, 1, 0}, {1, 0, 2, 1, 0, 0}};
    std::vector<std::vector<std::string>> results;
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const std::string into = directory / ("into" + std::to_string(i));
      for (const int part : orders[i]) {
        const std::string from = directory / ("part" + std::to_string(part));
        if (!std::filesystem::exists(from))
          fill_database(from, parts[static_cast<std::size_t>(part)]);
        require(merge_databases(into, from));
      }
      CHECK(verify_database(into)->empty());
      results.push_back(contents(into));
      CHECK(merge_databases(into, into)->added == 0);
      CHECK(contents(into) == results.back());
    }
    CHECK(results[0].size() == rows.size());
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the rows of another robot are not merged, and neither are damaged ones") {
    const TemporaryDirectory directory;
    Rng rng(25);
    fill_database(directory / "a.db", random_rows(rng, 2));
    RobotSignature other = arm_signature();
    other.model_hash = "other";
    write_file(directory / "b.db", "");
    require(Database::open(directory / "b.db", other, OpenMode::create));
    CHECK(merge_databases(directory / "a.db", directory / "b.db").error().code ==
          ErrorCode::wrong_robot);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = 0 WHERE id = 2");
    const Error error = require_error(merge_databases(directory / "c.db", directory / "a.db"));
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(contains(error.message, "row 2"));
    CHECK(!std::filesystem::exists(directory / "c.db"));
    CHECK(merge_databases(directory / "c.db", directory / "none.db").error().code == ErrorCode::io);
    write_file(directory / "empty.db", "");
    CHECK(merge_databases(directory / "d.db", directory / "empty.db")->read == 0);
  }

  TEST_CASE("nothing of a damaged database is merged, however far down the damage is") {
    const TemporaryDirectory directory;
    Rng rng(27);
    fill_database(directory / "a.db", random_rows(rng, 2000));
    fill_database(directory / "into.db", random_rows(rng, 3));
    const auto before = contents(directory / "into.db");
    run_sql(directory / "a.db", "UPDATE mixture SET seed = 0 WHERE id = 2000");
    CHECK(!merge_databases(directory / "into.db", directory / "a.db").has_value());
    CHECK(contents(directory / "into.db") == before);
  }

  TEST_CASE("a sound copy heals a row that was set aside") {
    const TemporaryDirectory directory;
    Rng rng(26);
    const auto rows = random_rows(rng, 5);
    fill_database(directory / "a.db", rows);
    fill_database(directory / "b.db", rows);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = 0 WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(merge_databases(directory / "a.db", directory / "b.db")->added == 1);
    CHECK(contents(directory / "a.db") == contents(directory / "b.db"));
  }

  TEST_CASE("compacting tells what it removed, and refuses a damaged database") {
    const TemporaryDirectory directory;
    Rng rng(27);
    fill_database(directory / "a.db", random_rows(rng, 100));
    run_sql(directory / "a.db",
            "UPDATE mixture SET seed = 0 WHERE id > 20;"
            "UPDATE experience SET cell = 0 WHERE id = 1");
    CHECK(compact_database(directory / "a.db").error().code == ErrorCode::corrupt);
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 81);
    const auto compacted = require(compact_database(directory / "a.db"));
    CHECK(compacted.removed == 81);
    CHECK(compacted.bytes_after < compacted.bytes_before);
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 19);
  }
}

}  // namespace mneme::test
