// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/database_check.h"

#include "support/lifting_arm.h"

namespace mneme::test {
namespace {

Database open_of(const std::string& path, const Robot& robot) {
  auto database = Database::open(path, make_space(robot), OpenMode::create);
  REQUIRE_MESSAGE(database.has_value(), (database ? "" : database.error().message));
  return std::move(*database);
}

SolveSettings decomposed_by(const std::string& decomposer) {
  SolveSettings settings;
  settings.decompose.decomposer = decomposer;
  return settings;
}

void check_refused(const Robot& robot, const SolveSettings& settings, const Database& database,
                   const std::vector<std::string>& words) {
  const auto checked = internal::check_database(robot, settings, database);
  REQUIRE(!checked.has_value());
  CHECK(checked.error().code == ErrorCode::wrong_robot);
  for (const std::string& word : words) {
    CHECK_MESSAGE(checked.error().message.find(word) != std::string::npos, checked.error().message);
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a database of the robot and its decomposer will do, named or not") {
    const TemporaryDirectory directory;
    for (const Robot& robot : {planar8(), lifting_arm()}) {
      const Database database = open_of(directory / (robot.name() + ".db"), robot);
      CHECK(internal::check_database(robot, {}, database).has_value());
      CHECK(internal::check_database(robot, decomposed_by(default_decomposer(robot)), database)
                .has_value());
    }
  }

  TEST_CASE("a database of another robot is refused with its path and both robots") {
    const TemporaryDirectory directory;
    const Robot planar = planar8(), spatial = lifting_arm();
    const Database database = open_of(directory / "a.db", spatial);
    check_refused(
        planar, {}, database,
        {directory / "a.db", planar.name(), spatial.name(), planar.hash(), spatial.hash()});
  }

  TEST_CASE("a database without rows of a decomposer will do for it, too") {
    const TemporaryDirectory directory;
    const Robot robot = planar8();
    const Database database = open_of(directory / "a.db", robot);
    CHECK(internal::check_database(robot, decomposed_by("body_pairs"), database).has_value());
  }

  TEST_CASE("an empty file that is only looked at is of every robot") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    const auto database = Database::inspect(directory / "a.db");
    REQUIRE(database.has_value());
    CHECK(internal::check_database(planar8(), {}, *database).has_value());
    CHECK(internal::check_database(lifting_arm(), {}, *database).has_value());
  }

  TEST_CASE("an unknown decomposer is an error of its own") {
    const TemporaryDirectory directory;
    const Database database = open_of(directory / "a.db", planar8());
    const auto checked = internal::check_database(planar8(), decomposed_by("triples"), database);
    REQUIRE(!checked.has_value());
    CHECK(checked.error().code == ErrorCode::invalid);
    CHECK(checked.error().message.find("'triples'") != std::string::npos);
  }
}

}  // namespace mneme::test
