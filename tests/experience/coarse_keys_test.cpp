// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/coarse_keys.h"
#include "engines/fixtures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::test {
namespace {

using internal::CoarseKeys;

constexpr std::size_t kKeysPerLeaf = 3;
constexpr std::int32_t kAll = std::numeric_limits<std::int32_t>::max();

/// Leaves that are small beside what lies between them, and near to the leaves before and after.
CoarseKeys strewn_leaves(Rng& rng, std::size_t leaves, std::size_t key_size) {
  std::vector<double> keys;
  std::vector<std::size_t> begins = {0};
  std::vector<double> place(key_size, 0.0);
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    for (double& number : place) {
      number += rng.uniform(-1, 1);
      for (std::size_t i = 0; i < kKeysPerLeaf; ++i) {
        keys.push_back(number + rng.uniform(-0.2, 0.2));
      }
    }
    begins.push_back(begins.back() + kKeysPerLeaf);
  }
  return CoarseKeys(key_size, keys, begins);
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("the near leaves are those whose own box is near, in their order") {
    const std::uint64_t seed = 91;
    Rng rng(seed);
    for (const std::size_t leaves : {1U, 15U, 16U, 17U, 256U, 257U, 700U}) {
      for (const std::size_t key_size : {1U, 2U, 3U, 6U, 7U}) {
        const CoarseKeys coarse = strewn_leaves(rng, leaves, key_size);
        for (int i = 0; i < 20; ++i) {
          INFO("seed " << seed << ", " << leaves << " leaves of " << key_size << " numbers");
          std::vector<double> key(key_size);
          for (double& number : key) number = rng.uniform(-20, 20);
          const auto query = coarse.query(key.data());
          const auto all = coarse.near_leaves(query, kAll);
          REQUIRE(all.size() == leaves);
          const std::int32_t most = all[rng.index(leaves)].first;
          std::vector<CoarseKeys::NearLeaf> expected;
          std::ranges::copy_if(all, std::back_inserter(expected),
                               [&](const auto& leaf) { return leaf.first <= most; });
          REQUIRE(coarse.near_leaves(query, most) == expected);
          REQUIRE(coarse.near_leaves(query, -1).empty());
        }
      }
    }
  }

  TEST_CASE("no bound leaves out a key that is nearer") {
    const std::uint64_t seed = 92;
    Rng rng(seed);
    for (const std::size_t key_size : {1U, 2U, 6U, 18U}) {
      // One number that spreads wide has the cells of its far end cut off.
      std::vector<double> keys(key_size * kKeysPerLeaf);
      for (std::size_t i = 0; i < keys.size(); ++i) {
        keys[i] = rng.uniform(-1, 1) * (i < kKeysPerLeaf ? 1000 : 1);
      }
      const CoarseKeys coarse(key_size, keys, std::vector<std::size_t>{0, kKeysPerLeaf});
      for (int i = 0; i < 300; ++i) {
        INFO("seed " << seed << ", " << key_size << " numbers, query " << i);
        const std::size_t wanted = rng.index(kKeysPerLeaf);
        const double offset = std::pow(10, rng.uniform(-9, 3));
        std::vector<double> key(key_size);
        double squared = 0;
        for (std::size_t k = 0; k < key_size; ++k) {
          const double at = keys[k * kKeysPerLeaf + wanted];
          key[k] = at + rng.uniform(-offset, offset);
          squared += (key[k] - at) * (key[k] - at);
        }
        const auto query = coarse.query(key.data());
        const auto bound = coarse.bound(squared);
        CHECK(coarse.near_leaves(query, bound.boxes).size() == 1);
        CHECK((coarse.near_keys(0, query, bound.keys) >> wanted & 1) == 1);
        CHECK(coarse.near_keys(0, query, coarse.bound(0).keys) == 0);
      }
    }
  }
}

}  // namespace mneme::test
