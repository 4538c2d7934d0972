// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/kinds.h"
#include "support/planar_memory.h"

#include <atomic>
#include <limits>

namespace mneme::test {
namespace {

double base_distance(const PrimitiveKey& key, std::size_t circle) {
  return std::hypot(key[circle], key[circle + 1]);
}

/// Checks all that the range says of a canonical key.
void check_in_range(const PrimitiveGrid& grid, const PrimitiveKey& key) {
  REQUIRE(key.size() == 6);
  const double slack = 1e-9;
  for (const std::size_t circle : {std::size_t{0}, std::size_t{3}}) {
    CHECK(key[circle + 2] >= grid.radius[0]);
    CHECK(key[circle + 2] <= grid.radius[1]);
    CHECK(base_distance(key, circle) > key[circle + 2]);
  }
  const double dx = key[3] - key[0], dy = key[4] - key[1];
  const double centres = std::hypot(dx, dy), gap = centres - key[2] - key[5];
  CHECK(gap >= grid.gap[0] - slack);
  CHECK(gap <= grid.gap[1] + slack);
  const double along = (key[2] + gap / 2) / centres;
  const double distance = std::hypot(key[0] + along * dx, key[1] + along * dy);
  CHECK(distance >= grid.distance[0] - slack);
  CHECK(distance <= grid.distance[1] + slack);
  // Canonical: the midpoint of the centres lies on the positive x axis.
  CHECK(std::abs(key[1] + key[4]) < 1e-9);
  CHECK(key[0] + key[3] > 0);
}

double nearest_error(const std::vector<PrimitiveKey>& keys, const PrimitiveKey& probe) {
  double least = std::numeric_limits<double>::infinity();
  for (const PrimitiveKey& key : keys) least = std::min(least, pair_error(key, probe));
  return least;
}

const std::string kGood = "radius: [1, 2]\ngap: [0.1, 0.5]\ndistance: [2, 9]\n";

/// Loads `text`, which must fail, and checks that the message names file, line and `word`.
void check_refused(const std::string& text, int line, const std::string& word) {
  const TemporaryDirectory directory;
  const std::string path = directory / "grid.yaml";
  write_file(path, text);
  const Error error = require_error(load_grid(path));
  INFO(text);
  CHECK(error.code == ErrorCode::parse);
  const std::string place = path + ":" + std::to_string(line) + ":";
  CHECK_MESSAGE(contains(error.message, place), error.message);
  CHECK_MESSAGE(contains(error.message, word), error.message);
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("random primitives lie in the range, canonical, the base in neither circle") {
    PrimitiveGrid far;
    far.radius = {0.3, 0.4};
    far.gap = {1, 1};
    far.distance = {0.1, 11};
    for (const PrimitiveGrid& grid : {PrimitiveGrid{}, near_grid(), far}) {
      Rng rng(1);
      for (int i = 0; i < 2000; ++i) check_in_range(grid, sample_primitive(grid, rng));
    }
  }

  TEST_CASE("random primitives fill the range, narrow gaps more often") {
    const PrimitiveGrid grid;
    Rng rng(2);
    int narrow = 0, near = 0, first_larger = 0;
    double least_gap = 1e9, largest_gap = 0;
    for (int i = 0; i < 4000; ++i) {
      const PrimitiveKey key = sample_primitive(grid, rng);
      const double gap = std::hypot(key[3] - key[0], key[4] - key[1]) - key[2] - key[5];
      least_gap = std::min(least_gap, gap);
      largest_gap = std::max(largest_gap, gap);
      narrow += gap < 0.5 * (grid.gap[0] + grid.gap[1]);
      near += 0.5 * (key[0] + key[3]) < 5;
      first_larger += key[2] > key[5];
    }
    CHECK(least_gap < 0.11);
    CHECK(largest_gap > 0.95);
    CHECK(narrow > 2700);
    CHECK(near > 1000);
    CHECK(near < 3000);
    CHECK(first_larger > 1800);
    CHECK(first_larger < 2200);
  }

  TEST_CASE("covering keys lie in the range and leave no random primitive without a match") {
    PrimitiveGrid grid;
    for (const double most : {3.0, 1.5}) {
      grid.max_similarity_error = most;
      const auto keys = cover(grid, 7);
      for (const PrimitiveKey& key : keys) check_in_range(grid, key);
      Rng rng(99);
      int unmatched = 0;
      for (int i = 0; i < 1000; ++i) {
        unmatched += nearest_error(keys, sample_primitive(grid, rng)) >= most;
      }
      // Covered means: 2000 random primitives in a row had a match.
      CHECK(unmatched <= 3);
    }
  }

  TEST_CASE("covering keys are the same for the same seed and grow with the count") {
    PrimitiveGrid grid;
    grid.count = 150;
    const auto keys = cover(grid, 3);
    CHECK(keys == cover(grid, 3));
    CHECK(keys != cover(grid, 4));
    CHECK(keys.size() >= 150);
    grid.count = 260;
    const auto more = cover(grid, 3);
    REQUIRE(more.size() >= 260);
    CHECK(std::equal(keys.begin(), keys.begin() + 150, more.begin()));
    // Keys that complete the cover of a few come after them.
    grid.count = 3;
    const auto few = cover(grid, 3);
    CHECK(few.size() > 10);
    CHECK(std::equal(few.begin(), few.begin() + 3, more.begin()));
  }

  TEST_CASE("chosen keys keep apart better than random ones") {
    PrimitiveGrid grid;
    grid.count = 200;
    const auto chosen = cover(grid, 5);
    Rng rng(5);
    std::vector<PrimitiveKey> random;
    for (std::size_t i = 0; i < chosen.size(); ++i) random.push_back(sample_primitive(grid, rng));
    CHECK(measure_coverage(grid, chosen, 3000, 1).max <
          measure_coverage(grid, random, 3000, 1).max);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the measured coverage is that of a plain search") {
    PrimitiveGrid grid;
    grid.count = 40;
    const auto keys = cover(grid, 6);
    const Coverage coverage = measure_coverage(grid, keys, 500, 21);
    CHECK(coverage.probes == 500);
    Rng rng(21);
    std::vector<double> errors;
    for (int i = 0; i < 500; ++i)
      errors.push_back(nearest_error(keys, sample_primitive(grid, rng)));
    std::sort(errors.begin(), errors.end());
    CHECK(coverage.max == doctest::Approx(errors.back()));
    CHECK(coverage.median >= errors[245]);
    CHECK(coverage.median <= errors[255]);
    CHECK(coverage.p95 >= errors[470]);
    CHECK(coverage.p95 <= errors[480]);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a cancelled cover ends with what it has") {
    PrimitiveGrid grid;
    grid.count = 100000000;
    const std::atomic<bool> is_cancelled = true;
    const auto keys = cover(grid, 7, &is_cancelled);
    grid.count = 10;
    const auto all = cover(grid, 7);
    REQUIRE(keys.size() < 10);
    CHECK(std::equal(keys.begin(), keys.end(), all.begin()));
  }

  TEST_CASE("no keys cover nothing, and no probes show nothing") {
    const double infinite = std::numeric_limits<double>::infinity();
    Rng rng(1);
    const PrimitiveGrid grid;
    const std::vector<PrimitiveKey> keys = {sample_primitive(grid, rng)};
    for (const Coverage& coverage :
         {measure_coverage(grid, {}, 100, 1), measure_coverage(grid, keys, 0, 1)}) {
      CHECK(coverage.median == infinite);
      CHECK(coverage.p95 == infinite);
      CHECK(coverage.max == infinite);
    }
    CHECK(std::isfinite(measure_coverage(grid, keys, 1, 1).max));
  }

  TEST_CASE("what is measured against itself is covered") {
    Rng rng(8), again(8);
    const PrimitiveGrid grid;
    std::vector<PrimitiveKey> keys;
    for (int i = 0; i < 50; ++i) keys.push_back(sample_primitive(grid, again));
    const Coverage coverage = measure_coverage(grid, keys, 50, 8);
    CHECK(coverage.max < 1e-12);
    const Coverage more = measure_coverage(grid, keys, 500, 9);
    CHECK(more.median <= more.p95);
    CHECK(more.p95 <= more.max);
    CHECK(more.median > 0);
  }

  TEST_CASE("a grid is read as it was written, what is left out has its default") {
    const TemporaryDirectory directory;
    write_file(directory / "grid.yaml", kGood);
    const auto grid = require(load_grid(directory / "grid.yaml"));
    CHECK(grid.radius == std::array<double, 2>{1, 2});
    CHECK(grid.gap == std::array<double, 2>{0.1, 0.5});
    CHECK(grid.distance == std::array<double, 2>{2, 9});
    CHECK(grid.max_similarity_error == PrimitiveGrid{}.max_similarity_error);
    CHECK(grid.count == 0);
    write_file(directory / "full.yaml", kGood + "max_similarity_error: 0.5\ncount: 800\n");
    const auto full = require(load_grid(directory / "full.yaml"));
    CHECK(full.max_similarity_error == 0.5);
    CHECK(full.count == 800);
  }

  TEST_CASE("the grid that comes with mneme is one") {
    const auto grid = require(load_grid(source_file("scenes/planar/grid.yaml")));
    CHECK(grid.max_similarity_error <= 3);
    CHECK(grid.count >= 28);
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
    const Error error = require_error(load_grid(directory / "none.yaml"));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "none.yaml"));
    write_file(directory / "empty.yaml", "");
    CHECK(contains(require_error(load_grid(directory / "empty.yaml")).message, "empty.yaml"));
  }
}

}  // namespace mneme::test
