// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/coarse_kernels.h"
#include "engines/fixtures.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace mneme::test {
namespace {

using internal::CoarsePair;
using internal::kCoarseBlock;

constexpr int kMostCell = 8191;

std::int16_t random_cell(Rng& rng) {
  return static_cast<std::int16_t>(rng.index(static_cast<std::uint32_t>(kMostCell + 1)));
}

std::vector<CoarsePair> random_pairs(Rng& rng, std::size_t count) {
  std::vector<CoarsePair> pairs(count);
  for (CoarsePair& pair : pairs)
    std::ranges::generate(pair.cells, [&] { return random_cell(rng); });
  return pairs;
}

/// The cell of key or box `key`, whose block has `arrays` arrays per pair.
int cell_of(const std::vector<CoarsePair>& blocks, std::size_t pairs, std::size_t arrays,
            std::size_t array, std::size_t key, std::size_t number) {
  const std::size_t pair = key / kCoarseBlock * pairs + number / 2;
  return blocks[pair * arrays + array].cells[2 * (key % kCoarseBlock) + number % 2];
}

TEST_SUITE("oracle") {
  TEST_CASE("keys and boxes are near as plain arithmetic says with every instruction set") {
    Rng rng(5);
    for (const std::size_t pairs : {1U, 2U, 5U, 9U}) {
      for (const std::size_t blocks : {0U, 1U, 2U, 3U, 4U}) {
        const auto keys = random_pairs(rng, blocks * pairs);
        const auto boxes = random_pairs(rng, 2 * blocks * pairs);
        std::vector<std::int16_t> query(2 * pairs);
        std::ranges::generate(query, [&] { return random_cell(rng); });
        std::vector<std::int32_t> of_keys(blocks * kCoarseBlock), of_boxes(of_keys.size());
        for (std::size_t key = 0; key < of_keys.size(); ++key) {
          for (std::size_t number = 0; number < 2 * pairs; ++number) {
            const int q = query[number], apart = cell_of(keys, pairs, 1, 0, key, number) - q;
            const int lower = cell_of(boxes, pairs, 2, 0, key, number);
            const int upper = cell_of(boxes, pairs, 2, 1, key, number);
            const int outside = std::max({0, lower - q - 1, q - upper - 1});
            of_keys[key] += apart * apart;
            of_boxes[key] += outside * outside;
          }
        }
        std::vector<std::int32_t> bounds = of_keys;
        bounds.insert(bounds.end(), {-1, 0, std::numeric_limits<std::int32_t>::max()});
        for (const Isa isa : available_isas()) {
          INFO(pairs << " pairs, " << blocks << " blocks, " << to_string(isa));
          const auto& kernels = internal::coarse_kernels(isa);
          for (const std::int32_t most : bounds) {
            std::uint64_t near = 0;
            for (std::size_t key = 0; key < of_keys.size(); ++key) {
              near |= std::uint64_t{of_keys[key] <= most} << key;
            }
            CHECK(kernels.near_keys(keys.data(), blocks, pairs, query.data(), most) == near);
          }
          std::vector<std::int32_t> squared(of_boxes.size(), -1);
          kernels.box_distances(boxes.data(), blocks, pairs, query.data(), squared.data());
          CHECK(squared == of_boxes);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
