// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/experience_index.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace mneme::test {
namespace {

using internal::ExperienceIndex;
using internal::IndexMatch;

/// Looks at every key.
std::vector<IndexMatch> brute_force(const std::vector<PrimitiveKey>& keys,
                                    const PrimitiveKey& query, double threshold, int max_matches) {
  std::vector<IndexMatch> found;
  for (std::uint32_t position = 0; position < keys.size(); ++position) {
    IndexMatch nearest{position, 0, std::numeric_limits<double>::infinity()};
    std::uint32_t image = 0;
    for (const KeyImage& other : images(query)) {
      double error = 0;
      for (std::size_t i = 0; i < other.key.size(); ++i) {
        const double difference = other.key[i] - keys[position][i];
        error += difference * difference;
      }
      if (error < nearest.error) nearest = {position, image, error};
      ++image;
    }
    if (nearest.error < threshold) found.push_back(nearest);
  }
  std::sort(found.begin(), found.end(), [](const IndexMatch& a, const IndexMatch& b) {
    return std::tie(a.error, a.position) < std::tie(b.error, b.position);
  });
  if (max_matches > 0 && found.size() > static_cast<std::size_t>(max_matches)) {
    found.resize(static_cast<std::size_t>(max_matches));
  }
  return found;
}

bool is_same(const std::vector<IndexMatch>& a, const std::vector<IndexMatch>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const IndexMatch& x, const IndexMatch& y) {
                      return x.position == y.position && x.image == y.image &&
                             std::abs(x.error - y.error) <= 1e-13;
                    });
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("an index without keys finds nothing") {
    const ExperienceIndex index(6);
    CHECK(index.find(images({1, 0, 1, 2, 0, 1}), 1e9, 0).empty());
  }

  TEST_CASE("an error as large as the threshold does not match") {
    ExperienceIndex index(6);
    index.append(PrimitiveKey{3, 1, 1, 3, -1, 1});
    const auto queries = images({3, 1, 1, 3, -1, 1.5});
    CHECK(index.find(queries, 0.25, 0).empty());
    CHECK(index.find(queries, 0.2500001, 0).size() == 1);
    CHECK(index.find(queries, 0, 0).empty());
  }

  TEST_CASE("equal keys come in order of their positions, however few are wanted") {
    ExperienceIndex index(6);
    for (int i = 0; i < 600; ++i) index.append(PrimitiveKey{3, 1, 1, 3, -1, 1});
    index.refresh();
    for (int i = 0; i < 10; ++i) index.append(PrimitiveKey{3, 1, 1, 3, -1, 1});
    for (const int wanted : {1, 5, 605}) {
      const auto found = index.find(images({3, 1, 1, 3, -1, 1}), 0.1, wanted);
      REQUIRE(found.size() == static_cast<std::size_t>(wanted));
      for (std::uint32_t i = 0; i < found.size(); ++i) CHECK(found[i].position == i);
    }
  }

  TEST_CASE("a query that is not a number finds nothing") {
    ExperienceIndex index(6);
    for (int i = 0; i < 600; ++i) index.append(PrimitiveKey{3, 1, 1, 3, -1, 1});
    index.refresh();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(index.find(images({nan, 1, 1, nan, -1, 1}), 1e9, 0).empty());
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the index finds what looking at every key finds") {
    const std::uint64_t seed = 47;
    Rng rng(seed);
    ExperienceIndex index(6);
    std::vector<PrimitiveKey> keys;
    for (int i = 0; i < 3000; ++i) {
      // Some keys come twice, some as the mirror image of another.
      PrimitiveKey key =
          i % 10 == 9 ? images(keys[rng.index(i)])[rng.index(4)].key : random_key(rng);
      index.append(key);
      keys.push_back(std::move(key));
      if (i % 7 == 0) index.refresh();
      if (i % 20 != 0) continue;
      const PrimitiveKey query = i % 60 == 0 ? keys[rng.index(i + 1)] : random_key(rng);
      for (const double threshold : {1e-9, 0.1, 0.5, 3.0, 1e9}) {
        for (const int max_matches : {0, 1, 8, 100}) {
          INFO("seed " << seed << ", key " << i << ", threshold " << threshold << ", at most "
                       << max_matches);
          REQUIRE(is_same(index.find(images(query), threshold, max_matches),
                          brute_force(keys, query, threshold, max_matches)));
        }
      }
    }
  }
}

}  // namespace mneme::test
