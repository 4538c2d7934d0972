// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/carved_rows.h"

#include "experience/fixtures.h"

namespace mneme::test {
namespace {

using internal::CarvedRows;

CarvedRows carve(const std::string& path) {
  auto rows = CarvedRows::read(path);
  REQUIRE_MESSAGE(rows.has_value(), (rows ? "" : rows.error().message));
  return std::move(*rows);
}

std::string flaw_of(CarvedRows& rows, std::int64_t id) {
  const auto row = rows.row(id);
  REQUIRE(row.has_value());
  Experience experience;
  return internal::decode(*row, rows.space(), experience).value_or("");
}

void create(const std::string& path) {
  Rng rng(24);
  REQUIRE(open_database(path).insert(random_rows(rng, 6, 30)));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("all that a sound file holds is found") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    CarvedRows rows = carve(directory / "a.db");
    CHECK(rows.space().robot_name == "arm");
    CHECK(rows.space().joint_count == 3);
    REQUIRE(rows.head().has_value());
    CHECK(rows.head()->row_count == 6);
    CHECK(rows.dead().empty());
    CHECK(rows.ids() == std::vector<std::int64_t>{1, 2, 3, 4, 5, 6});
    const Database database = open_database(directory / "a.db", OpenMode::read_only);
    for (const std::int64_t id : rows.ids()) {
      const auto row = rows.row(id);
      Experience experience;
      REQUIRE(!internal::decode(*row, rows.space(), experience));
      CHECK(is_same_content(experience, *database.get(id - 1)));
    }
  }

  TEST_CASE("parts that are missing or changed are flaws, and tombstones are known") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 1");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    run_sql(directory / "a.db",
            "DELETE FROM experience WHERE id = 3; DELETE FROM mixture WHERE id = 4;"
            "UPDATE experience SET cell = cell + 1 WHERE id = 5; UPDATE head SET epoch = 9");
    CarvedRows rows = carve(directory / "a.db");
    CHECK(rows.dead() == std::set<std::int64_t>{1});
    CHECK(!rows.head().has_value());
    CHECK(flaw_of(rows, 2).empty());
    CHECK(flaw_of(rows, 3) == "its key is missing");
    CHECK(flaw_of(rows, 4) == "its mixture is missing");
    CHECK(flaw_of(rows, 5).find("the checksum of its key") == 0);
  }

  TEST_CASE("a file with no robot, or with two, says so") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    ExperienceSpace other = arm_space();
    other.robot_hash = "f";
    run_sql(directory / "a.db",
            "CREATE TABLE twin (id INTEGER PRIMARY KEY, a, b, c, d);"
            "INSERT INTO twin VALUES (1, 'arm', 'f', 3, " +
                std::to_string(internal::checksum_of(other)) + ")");
    CHECK(CarvedRows::read(directory / "a.db").error().message.find("different robots") !=
          std::string::npos);
    run_sql(directory / "a.db", "DELETE FROM twin; DELETE FROM space");
    const auto none = CarvedRows::read(directory / "a.db");
    CHECK(none.error().code == ErrorCode::corrupt);
    CHECK(none.error().message.find("names the robot is missing") != std::string::npos);
  }
}

}  // namespace mneme::test
