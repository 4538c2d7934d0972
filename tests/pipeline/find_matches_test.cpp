// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

PrimitiveKey swapped(const PrimitiveKey& key) {
  return {key[3], key[4], key[5], key[0], key[1], key[2]};
}

double largest_difference(const PrimitiveKey& a, const PrimitiveKey& b) {
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a[i] - b[i]));
  return result;
}
std::vector<Experience> make_rows(Rng& rng, int count) {
  std::vector<Experience> rows(static_cast<std::size_t>(count));
  for (Experience& row : rows) {
    row.kind = "pairs/1";
    row.key = sample_primitive(near_grid(), rng);
    row.sampler = {8, std::vector<float>(8), {}, {}, {}};
  }
  return rows;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("a stored primitive is found wherever it turns up, and its motion takes it there") {
    const TemporaryDirectory directory;
    Rng rng(62);
    Database database = make_database(directory / "a.db", planar8());
    const auto rows = make_rows(rng, 300);
    REQUIRE(database.insert(rows));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Symmetry motion{rng.uniform(-3, 3), rng.index(2) == 1};
      const PrimitiveKey there = moved_key(motion, rows[i].key);
      const PrimitiveKey pair = rng.index(2) == 1 ? swapped(there) : there;
      const auto matches = *find_matches(database, "pairs/1", make_primitive(pair), 1e-9, 0);
      REQUIRE(matches.size() == 1);
      REQUIRE(matches[0].experience->id == static_cast<std::int64_t>(i) + 1);
      const PrimitiveKey arrived = moved_key(matches[0].to_scene, matches[0].experience->key);
      REQUIRE(std::min(largest_difference(arrived, pair),
                       largest_difference(arrived, swapped(pair))) < 1e-11);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("only rows of the kind that is asked for match") {
    const TemporaryDirectory directory;
    Rng rng(63);
    Database database = make_database(directory / "a.db", planar8());
    auto rows = make_rows(rng, 1);
    REQUIRE(database.insert(rows));
    const LocalPrimitive primitive = make_primitive(rows[0].key);
    CHECK(find_matches(database, "pairs/1", primitive, 1e9, 0)->size() == 1);
    CHECK(find_matches(database, "pairs/2", primitive, 1e9, 0)->empty());
  }
}

}  // namespace mneme::test
