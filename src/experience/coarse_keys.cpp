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
/// Below this width, the square of cells per unit would not be finite.
constexpr double kLeastWidth = 1e-100;
constexpr std::int32_t kMostSquared = std::numeric_limits<std::int32_t>::max();

/// One number may spread so much wider than the others (such as a large distance in a key) that its
/// cells would not resolve them. Its width is then capped, unless the others hardly spread.
constexpr double kMostWiderThanOthers = 4, kLeastShareOfWidest = 1e-6;

/// Width that the cells of each number cover, from its minimum; larger values are in the last cell.
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

/// Place of a key's or box's number within its block.
std::size_t place_of(std::size_t key, std::size_t number) {
  return 2 * (key % kCoarseBlock) + number % 2;
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
  keys_.resize(first_blocks_.back() * pair_count_);
  boxes_.resize(2 * blocks_of(leaves) * pair_count_);
  outer_boxes_.resize(2 * blocks_of(blocks_of(leaves)) * pair_count_);
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    add_leaf(leaf, keys.data() + begins[leaf] * key_size, begins[leaf + 1] - begins[leaf]);
  }
}

void CoarseKeys::add_leaf(std::size_t leaf, const double* columns, std::size_t count) {
  for (std::size_t number = 0; number < key_size_ && count > 0; ++number, columns += count) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t block = first_blocks_[leaf] + i / kCoarseBlock;
      CoarsePair& pair = keys_[block * pair_count_ + number / 2];
      pair.cells[place_of(i, number)] = cell(columns[i], number);
    }
    const auto [least, most] = std::minmax_element(columns, columns + count);
    add_box(leaf, number, cell(*least, number), cell(*most, number));
  }
}

void CoarseKeys::add_box(std::size_t leaf, std::size_t number, std::int16_t least,
                         std::int16_t most) {
  const std::size_t block = leaf / kCoarseBlock, place = place_of(leaf, number);
  CoarsePair* box = &boxes_[2 * (block * pair_count_ + number / 2)];
  box[0].cells[place] = least;
  box[1].cells[place] = most;
  const bool is_first = leaf % kCoarseBlock == 0;
  CoarsePair* outer = &outer_boxes_[2 * (block / kCoarseBlock * pair_count_ + number / 2)];
  std::int16_t& lower = outer[0].cells[place_of(block, number)];
  std::int16_t& upper = outer[1].cells[place_of(block, number)];
  lower = is_first ? least : std::min(lower, least);
  upper = is_first ? most : std::max(upper, most);
}

std::int16_t CoarseKeys::cell(double x, std::size_t number) const {
  const double cells = std::floor((x - lower_[number]) * per_cell_);
  // NaN goes into the first cell; its exact distance is never near.
  return static_cast<std::int16_t>(std::fmin(std::fmax(cells, 0), last_cell_));
}

std::vector<std::int16_t> CoarseKeys::query(const double* key) const {
  // A query outside the range is clamped to the nearest cell, which only lowers distances.
  std::vector<std::int16_t> cells(2 * pair_count_);
  for (std::size_t i = 0; i < key_size_; ++i) cells[i] = cell(key[i], i);
  return cells;
}

CoarseBound CoarseKeys::bound(double squared_distance) const {
  if (!(squared_distance > 0)) return {};
  // Cells and distances round differently, hence the slack.
  const auto squared_cells = [](double most) {
    most = most * (1 + 1e-9) + 1;
    return most < kMostSquared ? static_cast<std::int32_t>(most) : kMostSquared;
  };
  const double boxes = squared_distance * per_cell_ * per_cell_;
  // Rounding adds less than one cell per number.
  const double keys = std::sqrt(boxes) + std::sqrt(static_cast<double>(key_size_));
  return {squared_cells(boxes), squared_cells(keys * keys)};
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
    kernels_->box_distances(boxes_.data() + 2 * block * pair_count_, 1, pair_count_, query.data(),
                            squared.data());
    for (std::size_t i = 0; i < std::min(kCoarseBlock, leaves - first); ++i) {
      if (squared[i] <= most) near.emplace_back(squared[i], first + i);
    }
  }
  return near;
}

std::uint64_t CoarseKeys::near_keys(std::size_t leaf, const std::vector<std::int16_t>& query,
                                    std::int32_t most) const {
  const std::size_t first = first_blocks_[leaf];
  return kernels_->near_keys(keys_.data() + first * pair_count_, first_blocks_[leaf + 1] - first,
                             pair_count_, query.data(), most);
}

}  // namespace mneme::internal
