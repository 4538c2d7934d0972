// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/coarse_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

constexpr double kMostCells = 8191;
/// Below, cells per unit would not be finite when squared.
constexpr double kLeastWidth = 1e-100;
constexpr std::int32_t kMostSquared = std::numeric_limits<std::int32_t>::max();

/// One number may spread so wide (that of whole paths which keeps constraints apart does) that its
/// cells would tell nothing of the others; unless these hardly spread at all.
constexpr double kMostWiderThanOthers = 4, kLeastShareOfWidest = 1e-6;

/// What the cells of each number cover, from the least on; all beyond is in the last cell.
double covered_width(const std::vector<double>& lower, const std::vector<double>& upper) {
  double widest = 0, second = 0;
  for (std::size_t i = 0; i < lower.size(); ++i) {
    const double width = upper[i] - lower[i];
    second = std::max(second, std::min(width, widest));
    widest = std::max(widest, width);
  }
  const bool others_spread = second > kLeastShareOfWidest * widest;
  return others_spread ? std::min(widest, kMostWiderThanOthers * second) : widest;
}

std::size_t blocks_of(std::size_t count) { return (count + kCoarseBlock - 1) / kCoarseBlock; }

/// Where the cell of a key stands among blocks that have `arrays` arrays per pair.
std::size_t place_of(std::size_t key, std::size_t number, std::size_t pair_count,
                     std::size_t arrays) {
  const std::size_t pair = key / kCoarseBlock * pair_count + number / 2;
  return 2 * (arrays * pair * kCoarseBlock + key % kCoarseBlock) + number % 2;
}

}  // namespace

CoarseKeys::CoarseKeys(std::size_t key_size, std::span<const double> keys,
                       std::span<const std::size_t> begins)
    : kernels_(&coarse_kernels(Isa::automatic)),
      key_size_(key_size),
      pair_count_((key_size + 1) / 2),
      last_cell_(std::min(kMostCells, std::floor(std::sqrt(static_cast<double>(kMostSquared) /
                                                           static_cast<double>(2 * pair_count_))))),
      lower_(key_size, std::numeric_limits<double>::infinity()) {
  const std::size_t leaves = begins.size() - 1;
  std::vector<double> upper(key_size, -std::numeric_limits<double>::infinity());
  first_blocks_.push_back(0);
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    const std::size_t count = begins[leaf + 1] - begins[leaf];
    first_blocks_.push_back(first_blocks_.back() + blocks_of(count));
    for (std::size_t i = 0; i < count * key_size; ++i) {
      const double x = keys[begins[leaf] * key_size + i];
      lower_[i / count] = std::min(lower_[i / count], x);
      upper[i / count] = std::max(upper[i / count], x);
    }
  }
  const double width = covered_width(lower_, upper);
  if (width > kLeastWidth) per_cell_ = last_cell_ / width;
  keys_.resize(2 * first_blocks_.back() * pair_count_ * kCoarseBlock);
  boxes_.resize(4 * blocks_of(leaves) * pair_count_ * kCoarseBlock);
  outer_boxes_.resize(4 * blocks_of(blocks_of(leaves)) * pair_count_ * kCoarseBlock);
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    add_leaf(leaf, keys.data() + begins[leaf] * key_size, begins[leaf + 1] - begins[leaf]);
  }
}

void CoarseKeys::add_leaf(std::size_t leaf, const double* columns, std::size_t count) {
  for (std::size_t number = 0; number < key_size_ && count > 0; ++number, columns += count) {
    const std::size_t first_key = first_blocks_[leaf] * kCoarseBlock;
    for (std::size_t i = 0; i < count; ++i) {
      keys_[place_of(first_key + i, number, pair_count_, 1)] = cell(columns[i], number);
    }
    const auto [least, most] = std::minmax_element(columns, columns + count);
    add_box(leaf, number, cell(*least, number), cell(*most, number));
  }
}

void CoarseKeys::add_box(std::size_t leaf, std::size_t number, std::int16_t least,
                         std::int16_t most) {
  constexpr std::size_t kUpper = 2 * kCoarseBlock;
  const std::size_t box = place_of(leaf, number, pair_count_, 2);
  boxes_[box] = least;
  boxes_[box + kUpper] = most;
  const std::size_t outer = place_of(leaf / kCoarseBlock, number, pair_count_, 2);
  const bool is_first = leaf % kCoarseBlock == 0;
  outer_boxes_[outer] = is_first ? least : std::min(outer_boxes_[outer], least);
  outer_boxes_[outer + kUpper] = is_first ? most : std::max(outer_boxes_[outer + kUpper], most);
}

std::int16_t CoarseKeys::cell(double x, std::size_t number) const {
  const double cells = std::floor((x - lower_[number]) * per_cell_);
  // A number that is none counts as the first cell: it is near nothing by exact distances.
  return static_cast<std::int16_t>(std::fmin(std::fmax(cells, 0), last_cell_));
}

std::vector<std::int16_t> CoarseKeys::query(const double* key) const {
  // Beyond all keys the nearest cell stands for the query, which no key is farther from.
  std::vector<std::int16_t> cells(2 * pair_count_);
  for (std::size_t i = 0; i < key_size_; ++i) cells[i] = cell(key[i], i);
  return cells;
}

std::int32_t CoarseKeys::most_cells(double squared_distance) const {
  if (!(squared_distance > 0)) return -1;
  // Cells are rounded in another order than distances are.
  const double most = squared_distance * per_cell_ * per_cell_ * (1 + 1e-9) + 1;
  return most < kMostSquared ? static_cast<std::int32_t>(most) : kMostSquared;
}

std::vector<CoarseKeys::NearLeaf> CoarseKeys::near_leaves(const std::vector<std::int16_t>& query,
                                                          std::int32_t most) const {
  const std::size_t leaves = first_blocks_.size() - 1;
  const std::size_t blocks = blocks_of(leaves);
  std::vector<std::int32_t> outer(blocks_of(blocks) * kCoarseBlock);
  kernels_->box_distances(outer_boxes_.data(), blocks_of(blocks), pair_count_, query.data(),
                          outer.data());
  std::vector<NearLeaf> near;
  std::array<std::int32_t, kCoarseBlock> squared;
  for (std::size_t block = 0; block < blocks; ++block) {
    if (outer[block] > most) continue;
    const std::size_t first = block * kCoarseBlock;
    kernels_->box_distances(boxes_.data() + 4 * first * pair_count_, 1, pair_count_, query.data(),
                            squared.data());
    for (std::size_t i = 0; i < std::min(kCoarseBlock, leaves - first); ++i) {
      if (squared[i] <= most) near.emplace_back(squared[i], first + i);
    }
  }
  return near;
}

void CoarseKeys::key_distances(std::size_t leaf, const std::vector<std::int16_t>& query,
                               std::int32_t* squared) const {
  const std::size_t first = first_blocks_[leaf];
  kernels_->key_distances(keys_.data() + 2 * first * pair_count_ * kCoarseBlock,
                          first_blocks_[leaf + 1] - first, pair_count_, query.data(), squared);
}

}  // namespace mneme::internal
