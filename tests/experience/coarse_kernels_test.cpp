// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/coarse_kernels.h"
#include "store/fixtures.h"
#include "support/isas.h"

#include <algorithm>
#include <vector>

namespace mneme::test {
namespace {

using internal::kCoarseBlock;

std::vector<std::int16_t> random_cells(Rng& rng, std::size_t count, int most) {
  std::vector<std::int16_t> cells(count);
  for (auto& cell : cells)
    cell = static_cast<std::int16_t>(rng.index(static_cast<std::size_t>(most) + 1));
  return cells;
}

TEST_SUITE("oracle") {
  TEST_CASE("bounds of keys and boxes are those of plain arithmetic with every instruction set") {
    Rng rng(5);
    for (const std::size_t pairs : {1U, 2U, 5U, 9U}) {
      const std::size_t blocks = 3;
      const auto keys = random_cells(rng, 2 * blocks * pairs * kCoarseBlock, 8191);
      const auto boxes = random_cells(rng, 4 * blocks * pairs * kCoarseBlock, 8191);
      const auto query = random_cells(rng, 2 * pairs, 8191);
      std::vector<std::int32_t> of_keys(blocks * kCoarseBlock), of_boxes(of_keys.size());
      for (std::size_t key = 0; key < of_keys.size(); ++key) {
        for (std::size_t number = 0; number < 2 * pairs; ++number) {
          const std::size_t pair = key / kCoarseBlock * pairs + number / 2;
          const std::size_t in_pair = 2 * (key % kCoarseBlock) + number % 2;
          const int q = query[number], cell = keys[2 * pair * kCoarseBlock + in_pair];
          const int lower = boxes[4 * pair * kCoarseBlock + in_pair];
          const int upper = boxes[(4 * pair + 2) * kCoarseBlock + in_pair];
          const int apart = std::max(0, std::abs(cell - q) - 1);
          const int outside = std::max({0, lower - q - 1, q - upper - 1});
          of_keys[key] += apart * apart;
          of_boxes[key] += outside * outside;
        }
      }
      for (const Isa isa : available_isas()) {
        INFO(pairs << " pairs, " << to_string(isa));
        const auto& kernels = internal::coarse_kernels(isa);
        std::vector<std::int32_t> squared(of_keys.size(), -1);
        kernels.key_distances(keys.data(), blocks, pairs, query.data(), squared.data());
        CHECK(squared == of_keys);
        kernels.box_distances(boxes.data(), blocks, pairs, query.data(), squared.data());
        CHECK(squared == of_boxes);
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
