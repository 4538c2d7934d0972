// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/key_index.h"
#include "engines/fixtures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

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

  TEST_CASE("keys that differ by next to nothing are found, and nothing by what is no number") {
    const KeyTree tree(1, IndexRows{{1, 2}, {1, 1}, {0, 1e-310}});
    NearestMatches nearest(1e-12, 0, 0), nowhere(1e-12, 0, 0);
    tree.search(std::array{0.0}.data(), nearest);
    CHECK(nearest.matches().size() == 2);
    tree.search(std::array{std::numeric_limits<double>::quiet_NaN()}.data(), nowhere);
    CHECK(nowhere.matches().empty());
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("a search finds what looking at every key finds, however long keys are") {
    const std::uint64_t seed = 73;
    Rng rng(seed);
    for (const int key_size : {1, 2, 3, 6, 7, 12, 20}) {
      IndexRows rows = random_index_rows(rng, 700, key_size);
      // One number may vary far more than others.
      for (std::size_t i = 0; key_size % 2 == 0 && i < rows.ids.size(); ++i) {
        rows.keys[i * static_cast<std::size_t>(key_size)] *= 100;
      }
      const KeyTree tree(key_size, rows);
      for (int q = 0; q < 40; ++q) {
        IndexRows query = random_index_rows(rng, 1, key_size);
        // Some are beyond all keys.
        for (double& number : query.keys) number *= q % 4 == 0 ? rng.uniform(0, 4) : 1;
        const double threshold = rng.uniform(0, q % 4 == 0 ? 9 * key_size : 1.5 * key_size);
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

namespace {

using internal::ExperienceIndex;
using internal::IndexMatch;

void add(ExperienceIndex& index, std::int64_t id, const PrimitiveKey& key) {
  index.append({{id}, {2}, key});
}

/// Looks at every key; the ids are positions.
std::vector<IndexMatch> brute_force(const std::vector<PrimitiveKey>& keys,
                                    const std::set<std::int64_t>& gone, const PrimitiveKey& query,
                                    double threshold, int max_matches) {
  std::vector<IndexMatch> found;
  for (std::size_t id = 0; id < keys.size(); ++id) {
    if (gone.contains(static_cast<std::int64_t>(id))) continue;
    IndexMatch nearest{static_cast<std::int64_t>(id), 0, std::numeric_limits<double>::infinity()};
    std::uint32_t image = 0;
    for (const KeyImage& other : memory_kinds().front()->images(query)) {
      double error = 0;
      for (std::size_t i = 0; i < other.key.size(); ++i) {
        const double difference = other.key[i] - keys[id][i];
        error += difference * difference;
      }
      if (error < nearest.error) nearest = {nearest.id, image, error};
      ++image;
    }
    if (nearest.error < threshold) found.push_back(nearest);
  }
  std::sort(found.begin(), found.end(), internal::is_nearer);
  if (max_matches > 0 && found.size() > static_cast<std::size_t>(max_matches)) {
    found.resize(static_cast<std::size_t>(max_matches));
  }
  return found;
}

bool is_same(const std::vector<IndexMatch>& a, const std::vector<IndexMatch>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const IndexMatch& x, const IndexMatch& y) {
                      return x.id == y.id && x.image == y.image && x.error == y.error;
                    });
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("an index without keys finds nothing") {
    const ExperienceIndex index(6);
    CHECK(index.size() == 0);
    CHECK(index.find(keys_of({1, 0, 1, 2, 0, 1}), 1e9, 0).empty());
  }

  TEST_CASE("an error as large as the threshold does not match") {
    ExperienceIndex index(6);
    add(index, 1, {3, 1, 1, 3, -1, 1});
    const auto queries = keys_of({3, 1, 1, 3, -1, 1.5});
    CHECK(index.find(queries, 0.25, 0).empty());
    CHECK(index.find(queries, 0.2500001, 0).size() == 1);
    CHECK(index.find(queries, 0, 0).empty());
  }

  TEST_CASE("equal keys come in order of their ids, however few are wanted") {
    ExperienceIndex index(6);
    for (int i = 0; i < 610; ++i) add(index, i, {3, 1, 1, 3, -1, 1});
    for (const int wanted : {1, 5, 605}) {
      const auto found = index.find(keys_of({3, 1, 1, 3, -1, 1}), 0.1, wanted);
      REQUIRE(found.size() == static_cast<std::size_t>(wanted));
      for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i].id == std::int64_t(i));
    }
  }

  TEST_CASE("where few keys may be looked at, those in the nearest leaves are") {
    Rng rng(48);
    ExperienceIndex index(6);
    for (int i = 0; i < 5000; ++i) add(index, i, random_key(rng));
    const PrimitiveKey known = random_key(rng);
    add(index, 5000, known);
    const auto exact = index.find(keys_of(known), 1e9, 1);
    std::int64_t left = 1000;
    CHECK(is_same(index.find(keys_of(known), 1e-6, 1, &left), exact));
    CHECK(left < 1000);
    for (const std::int64_t allowed : {0, 1, 100, 300}) {
      left = allowed;
      const auto found = index.find(keys_of(random_key(rng)), 1e9, 0, &left);
      CHECK(left <= 0);
      CHECK(left > -static_cast<std::int64_t>(KeyTree::kLeafSize));
      CHECK(found.size() <= static_cast<std::size_t>(allowed - left));
      CHECK(found.empty() == (allowed == 0));
    }
  }

  TEST_CASE("one number that spreads far leaves the others telling") {
    Rng rng(49);
    ExperienceIndex index(6);
    const PrimitiveKey known = random_key(rng);
    for (int i = 0; i < 5000; ++i) add(index, i, random_key(rng));
    add(index, 5000, known);
    PrimitiveKey apart = known;
    apart[0] += 9e5;
    add(index, 5001, apart);
    for (const auto& [key, id] : {std::pair{known, 5000}, {apart, 5001}}) {
      std::int64_t left = 1000;
      const auto found = index.find(keys_of(key), 0.25, 1, &left);
      REQUIRE(found.size() == 1);
      CHECK(found[0].id == id);
      CHECK(left > 0);
    }
  }

  TEST_CASE("a query that is not a number finds nothing") {
    ExperienceIndex index(6);
    for (int i = 0; i < 600; ++i) add(index, i, {3, 1, 1, 3, -1, 1});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(index.find(keys_of({nan, 1, 1, nan, -1, 1}), 1e9, 0).empty());
  }

  TEST_CASE("positions count rows in order of insertion, and components are summed") {
    ExperienceIndex index(6);
    for (int i = 0; i < 300; ++i) add(index, 1000 + i, {3, 1, 1, 3, -1, 1});
    CHECK(index.size() == 300);
    CHECK(index.components() == 600);
    for (int i = 0; i < 300; ++i) REQUIRE(index.id(i) == 1000 + i);
    index.remove([](std::int64_t id) { return id % 2 == 0; });
    CHECK(index.size() == 150);
    CHECK(index.components() == 300);
    CHECK(index.id(149) == 1299);
    index.remove([](std::int64_t) { return true; });
    CHECK(index.size() == 0);
    CHECK(index.find(keys_of({3, 1, 1, 3, -1, 1}), 1, 0).empty());
  }

  TEST_CASE("a copy stays as it is while the original grows and shrinks") {
    Rng rng(46);
    ExperienceIndex index(6);
    for (int i = 0; i < 100; ++i) add(index, i, random_key(rng));
    const ExperienceIndex before = index;
    const PrimitiveKey query = random_key(rng);
    const auto found = before.find(keys_of(query), 3, 0);
    for (int i = 100; i < 400; ++i) add(index, i, query);
    index.remove([](std::int64_t id) { return id < 50; });
    CHECK(before.size() == 100);
    CHECK(is_same(before.find(keys_of(query), 3, 0), found));
  }

  TEST_CASE("rows that come one by one stand in few trees") {
    Rng rng(45);
    ExperienceIndex index(6);
    for (int i = 0; i < 5000; ++i) add(index, i, random_key(rng));
    CHECK(index.trees().size() <= 8);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the index finds what looking at every key finds, while rows come and go") {
    const std::uint64_t seed = 47;
    Rng rng(seed);
    ExperienceIndex index(6);
    std::vector<PrimitiveKey> keys;
    std::set<std::int64_t> gone;
    for (int i = 0; i < 3000; ++i) {
      // Some keys come twice, some as the mirror image of another.
      PrimitiveKey key = i % 10 == 9
                             ? memory_kinds().front()->images(keys[rng.index(i)])[rng.index(4)].key
                             : random_key(rng);
      add(index, i, key);
      keys.push_back(std::move(key));
      if (i % 200 == 150) {
        for (int k = 0; k < 5; ++k) gone.insert(static_cast<std::int64_t>(rng.index(i)));
        index.remove([&](std::int64_t id) { return gone.contains(id); });
      }
      if (i % 20 != 0) continue;
      const PrimitiveKey query = i % 60 == 0 ? keys[rng.index(i + 1)] : random_key(rng);
      for (const double threshold : {1e-9, 0.1, 0.5, 3.0, 1e9}) {
        for (const int max_matches : {0, 1, 8, 100}) {
          INFO("seed " << seed << ", key " << i << ", threshold " << threshold << ", at most "
                       << max_matches);
          REQUIRE(is_same(index.find(keys_of(query), threshold, max_matches),
                          brute_force(keys, gone, query, threshold, max_matches)));
        }
      }
    }
  }

  TEST_CASE("the index finds what looking at every key finds among boxes in boxes, ties included") {
    const std::uint64_t seed = 50;
    Rng rng(seed);
    std::vector<PrimitiveKey> keys;
    internal::IndexRows rows;
    for (int i = 0; i < 20000; ++i) {
      // Few different keys: many are as far from a query as others.
      PrimitiveKey key = random_key(rng);
      for (double& number : key) number = std::round(4 * number) / 4;
      rows.ids.push_back(i);
      rows.components.push_back(1);
      rows.keys.insert(rows.keys.end(), key.begin(), key.end());
      keys.push_back(std::move(key));
    }
    ExperienceIndex index(6);
    index.append(std::move(rows));
    for (int i = 0; i < 12; ++i) {
      const PrimitiveKey query = i % 2 == 0 ? keys[rng.index(keys.size())] : random_key(rng);
      for (const double threshold : {1e-9, 0.125, 1.0, 1e9}) {
        for (const int max_matches : {0, 1, 50}) {
          INFO("seed " << seed << ", query " << i << ", threshold " << threshold << ", at most "
                       << max_matches);
          const auto expected = brute_force(keys, {}, query, threshold, max_matches);
          REQUIRE(is_same(index.find(keys_of(query), threshold, max_matches), expected));
          const std::int64_t enough = 8 * index.size();
          std::int64_t left = enough;
          REQUIRE(is_same(index.find(keys_of(query), threshold, max_matches, &left), expected));
          REQUIRE(enough - left >= static_cast<std::int64_t>(expected.size()));
          REQUIRE((threshold > 1 || enough - left < index.size()));
        }
      }
    }
  }
}

}  // namespace mneme::test
