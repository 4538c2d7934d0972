// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/database_check.h"

#include "support/lifting_arm.h"

namespace mneme::test {
namespace {

Database open_of(const std::string& path, const Robot& robot, const std::string& decomposer = "") {
  const auto space = make_space(robot, decomposer);
  REQUIRE_MESSAGE(space.has_value(), (space ? "" : space.error().message));
  auto database = Database::open(path, *space, OpenMode::create);
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
    check_refused(planar, {}, database,
                  {directory / "a.db", planar.name(), spatial.name(), planar.hash(), spatial.hash(),
                   "body_pairs/1", "pairs/1"});
  }

  TEST_CASE("a database of another decomposer is refused") {
    const TemporaryDirectory directory;
    const Robot robot = planar8();
    const Database bodies = open_of(directory / "bodies.db", robot, "body_pairs");
    check_refused(robot, {}, bodies, {"body_pairs/1", "decomposer pairs/1"});
    CHECK(internal::check_database(robot, decomposed_by("body_pairs"), bodies).has_value());
    const Database circles = open_of(directory / "circles.db", robot);
    check_refused(robot, decomposed_by("body_pairs"), circles, {"body_pairs/1"});
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
