// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

namespace mneme::test {
namespace {

const std::string kGood = "radius: [1, 2]\ngap: [0.1, 0.5]\ndistance: [2, 9]\n";

/// Loads `text`, which must fail, and checks that the message names file, line and `word`.
void check_refused(const std::string& text, int line, const std::string& word) {
  const TemporaryDirectory directory;
  const std::string path = directory / "grid.yaml";
  write_file(path, text);
  const auto grid = load_grid(path);
  INFO(text);
  REQUIRE(!grid.has_value());
  CHECK(grid.error().code == ErrorCode::parse);
  const std::string place = path + ":" + std::to_string(line) + ":";
  CHECK_MESSAGE(grid.error().message.find(place) != std::string::npos, grid.error().message);
  CHECK_MESSAGE(grid.error().message.find(word) != std::string::npos, grid.error().message);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a grid is read as it was written, what is left out has its default") {
    const TemporaryDirectory directory;
    write_file(directory / "grid.yaml", kGood);
    const auto grid = load_grid(directory / "grid.yaml");
    REQUIRE_MESSAGE(grid.has_value(), (grid ? "" : grid.error().message));
    CHECK(grid->radius == std::array<double, 2>{1, 2});
    CHECK(grid->gap == std::array<double, 2>{0.1, 0.5});
    CHECK(grid->distance == std::array<double, 2>{2, 9});
    CHECK(grid->max_similarity_error == PrimitiveGrid{}.max_similarity_error);
    CHECK(grid->count == 0);
    write_file(directory / "full.yaml", kGood + "max_similarity_error: 0.5\ncount: 800\n");
    const auto full = load_grid(directory / "full.yaml");
    REQUIRE(full.has_value());
    CHECK(full->max_similarity_error == 0.5);
    CHECK(full->count == 800);
  }

  TEST_CASE("the grid that comes with mneme is one") {
    const auto grid = load_grid(source_file("scenes/planar/grid.yaml"));
    REQUIRE_MESSAGE(grid.has_value(), (grid ? "" : grid.error().message));
    CHECK(grid->max_similarity_error <= 3);
    CHECK(grid->count >= 28);
  }

  TEST_CASE("a malformed grid is refused with file, line and what was expected") {
    check_refused("radius: [1, 2]\ndistance: [2, 9]\n", 1, "gap");
    check_refused(kGood + "radii: 3\n", 4, "radii");
    check_refused("radius: 1\ngap: [0.1, 0.5]\ndistance: [2, 9]\n", 1, "radius");
    check_refused("radius: [1, 2, 3]\ngap: [0.1, 0.5]\ndistance: [2, 9]\n", 1, "radius");
    check_refused("radius: [1, 2]\ngap: [0.5, 0.1]\ndistance: [2, 9]\n", 2, "gap");
    check_refused("radius: [1, 2]\ngap: [0, 0.1]\ndistance: [2, 9]\n", 2, "gap");
    check_refused("radius: [1, 2]\ngap: [-1, 0.1]\ndistance: [2, 9]\n", 2, "least");
    check_refused("radius: [1, 1e17]\ngap: [0.1, 0.5]\ndistance: [2, 9]\n", 1, "1e6");
    check_refused("radius: [1, 2]\ngap: [0.1, 0.5]\ndistance: [near, far]\n", 3, "distance");
    check_refused("radius: [1, 2]\ngap: [0.1, 0.5]\ndistance: [2, .nan]\n", 3, "distance");
    check_refused("radius: [1, 2]\ngap: [0.1, 0.5]\ndistance: [2, .inf]\n", 3, "distance");
    check_refused(kGood + "max_similarity_error: 0\n", 4, "max_similarity_error");
    check_refused(kGood + "max_similarity_error: tight\n", 4, "max_similarity_error");
    check_refused(kGood + "count: 2.5\n", 4, "whole number");
    check_refused(kGood + "count: -1\n", 4, "count");
    check_refused(kGood + "count: 1e12\n", 4, "count");
    check_refused(kGood + "count: many\n", 4, "count");
    check_refused(kGood + "gap: [0.1, 0.2]\n", 4, "gap");
    check_refused("- 1\n- 2\n", 1, "expected");
    check_refused("radius: [1, 2\ngap: 3\n", 2, "");
  }

  TEST_CASE("a file that is not there, or empty, is refused by name") {
    const TemporaryDirectory directory;
    const auto missing = load_grid(directory / "none.yaml");
    REQUIRE(!missing.has_value());
    CHECK(missing.error().code == ErrorCode::io);
    CHECK(missing.error().message.find("none.yaml") != std::string::npos);
    write_file(directory / "empty.yaml", "");
    const auto empty = load_grid(directory / "empty.yaml");
    REQUIRE(!empty.has_value());
    CHECK(empty.error().message.find("empty.yaml") != std::string::npos);
  }
}

}  // namespace mneme::test
