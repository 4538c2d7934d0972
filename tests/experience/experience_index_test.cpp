// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/experience_index.h"

#include <algorithm>
#include <limits>
#include <set>

namespace mneme::test {
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
    for (const KeyImage& other : images(query)) {
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
      PrimitiveKey key =
          i % 10 == 9 ? images(keys[rng.index(i)])[rng.index(4)].key : random_key(rng);
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
}

}  // namespace mneme::test
