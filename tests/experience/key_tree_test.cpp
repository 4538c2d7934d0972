// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/key_tree.h"

#include <algorithm>

namespace mneme::test {
namespace {

using internal::IndexRows;
using internal::KeyTree;
using internal::NearestMatches;

IndexRows random_index_rows(Rng& rng, int count, int key_size) {
  IndexRows rows;
  for (int i = 0; i < count; ++i) {
    rows.ids.push_back(100 + 3 * i);
    rows.components.push_back(i % 5);
    for (int k = 0; k < key_size; ++k) rows.keys.push_back(rng.uniform(-2, 2));
  }
  return rows;
}

std::vector<internal::IndexMatch> sorted(const NearestMatches& nearest) {
  auto matches = nearest.matches();
  std::sort(matches.begin(), matches.end(), internal::is_nearer);
  return matches;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a tree gives back its rows in order of their insertion") {
    Rng rng(71);
    for (const int count : {0, 1, 31, 32, 33, 64, 65, 1000}) {
      const IndexRows rows = random_index_rows(rng, count, 5);
      const KeyTree tree(5, rows);
      CHECK(tree.size() == static_cast<std::size_t>(count));
      CHECK(tree.rows().ids == rows.ids);
      CHECK(tree.rows().components == rows.components);
      CHECK(tree.rows().keys == rows.keys);
      NearestMatches all(1e9, 0, 0);
      tree.search(std::vector<double>(5, 0.0).data(), all);
      CHECK(all.matches().size() == static_cast<std::size_t>(count));
    }
  }

  TEST_CASE("a tree of kept data answers like the tree that it was kept of") {
    Rng rng(72);
    const KeyTree tree(6, random_index_rows(rng, 500, 6));
    const KeyTree again(6, tree.data());
    CHECK(again.components() == tree.components());
    for (int i = 0; i < 50; ++i) {
      const IndexRows query = random_index_rows(rng, 1, 6);
      NearestMatches a(2, 7, 0), b(2, 7, 0);
      tree.search(query.keys.data(), a);
      again.search(query.keys.data(), b);
      REQUIRE(std::ranges::equal(sorted(a), sorted(b), {}, &internal::IndexMatch::id,
                                 &internal::IndexMatch::id));
    }
  }

  TEST_CASE("keys that are all the same, and as large as keys may be, are found") {
    IndexRows rows;
    for (int i = 0; i < 200; ++i) {
      rows.ids.push_back(i);
      rows.components.push_back(1);
      for (const double number : {1e6, -1e6, 0.1}) rows.keys.push_back(number);
    }
    const KeyTree tree(3, std::move(rows));
    NearestMatches nearest(1e-12, 3, 0);
    tree.search(std::array{1e6, -1e6, 0.1}.data(), nearest);
    const auto found = sorted(nearest);
    REQUIRE(found.size() == 3);
    for (int i = 0; i < 3; ++i) {
      CHECK(found[static_cast<std::size_t>(i)].id == i);
      CHECK(found[static_cast<std::size_t>(i)].error == 0);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("a search finds what looking at every key finds, however long keys are") {
    const std::uint64_t seed = 73;
    Rng rng(seed);
    for (const int key_size : {1, 2, 3, 6, 7, 12, 20}) {
      const IndexRows rows = random_index_rows(rng, 700, key_size);
      const KeyTree tree(key_size, rows);
      for (int q = 0; q < 40; ++q) {
        const IndexRows query = random_index_rows(rng, 1, key_size);
        const double threshold = rng.uniform(0, 1.5 * key_size);
        const std::size_t wanted = q % 3 == 0 ? 0 : rng.index(60) + 1;
        NearestMatches expected(threshold, wanted, 2);
        for (std::size_t i = 0; i < rows.ids.size(); ++i) {
          double error = 0;
          for (std::size_t k = 0; k < query.keys.size(); ++k) {
            const double difference = rows.keys[i * query.keys.size() + k] - query.keys[k];
            error += difference * difference;
          }
          expected.offer(error, rows.ids[i]);
        }
        NearestMatches found(threshold, wanted, 2);
        tree.search(query.keys.data(), found);
        INFO("seed " << seed << ", " << key_size << " numbers, query " << q);
        REQUIRE(std::ranges::equal(sorted(found), sorted(expected), [](auto& a, auto& b) {
          return a.id == b.id && a.error == b.error && a.image == 2;
        }));
      }
    }
  }
}

}  // namespace mneme::test
