// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"
#include "lessons.h"

#include <cmath>

namespace mneme::test {
namespace {

/// Two rows of similar pairs: the first is held out.
Database two_rows(const TemporaryDirectory& directory, const Robot& robot) {
  Database database = make_database(directory / "a.db", robot);
  for (const PrimitiveKey& key : keys_near(near_pair(), 2, 0.05, 1)) {
    learn_into(database, robot, {key});
  }
  return database;
}

/// The configuration of an example; limits of planar8 are half a turn.
Configuration configuration_of(const cvae::Examples& examples, std::size_t example) {
  Configuration q;
  for (std::size_t j = 0; j < 8; ++j) q.push_back(kPi * examples.configurations[8 * example + j]);
  return q;
}

/// How far two values scaled to half a turn are apart; -1 and 1 are the same turn.
float turned_apart(float a, float b) { return std::abs(std::remainder(a - b, 2.0f)); }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a row and its mirror image are in the same set, and mirror each other") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    const Database database = two_rows(directory, robot);
    const auto lessons = require(cvae::make_lessons(robot, database, {.cell = 0.5, .queries = 4}));
    CHECK(lessons.rows == 2);
    const auto n = static_cast<std::size_t>(lessons.cells);
    for (const cvae::Examples* set : {&lessons.training, &lessons.held_out}) {
      REQUIRE(set->scene_count() == 2);
      REQUIRE(set->begins[1] > 0);
      REQUIRE(set->begins[2] == 2 * set->begins[1]);
      for (std::size_t i = 0; i < n * n; ++i) {
        const int upside_down = set->images[(n - 1 - i / n) * n + i % n];
        CHECK(std::abs(set->images[n * n + i] - upside_down) <= 1);
      }
      const std::size_t half = set->configurations.size() / 2;
      for (std::size_t i = 0; i < half; ++i) {
        CHECK(turned_apart(set->configurations[half + i], -set->configurations[i]) < 1e-5);
      }
    }
  }

  TEST_CASE("examples are free among the circles of their row") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    const Database database = two_rows(directory, robot);
    const auto lessons = require(cvae::make_lessons(robot, database, {.cell = 0.5, .queries = 4}));
    const auto checker = make_checker(robot, make_scene(require(database.get(0)).key));
    const auto count = static_cast<std::size_t>(lessons.held_out.begins[1]);
    for (std::size_t i = 0; i < count; ++i) {
      const Configuration q = configuration_of(lessons.held_out, i);
      CHECK(checker.is_valid(std::span<const double>(q)));
    }
  }

  TEST_CASE("a database without two rows of pairs is refused") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    learn_into(database, robot, {near_pair()});
    const Error error = require_error(cvae::make_lessons(robot, database, {}));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "at least 2"));
  }
}

}  // namespace mneme::test
