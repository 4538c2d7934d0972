// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Keys in two bytes per number, which quickly exclude most keys from a search.
#pragma once

#include "experience/coarse_kernels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Integer bounds for a squared distance: leaf boxes beyond `boxes` and keys beyond `keys` can be
/// skipped.
struct CoarseBound {
  std::int32_t boxes = -1, keys = -1;
};

/// The keys of a tree's leaves and their bounding boxes, in cells of one width. Const is
/// parallel-safe.
class CoarseKeys {
 public:
  /// Lower bound of a leaf's squared distance, in cells, and the leaf's index.
  using NearLeaf = std::pair<std::int32_t, std::size_t>;

  /// Leaf i has the keys `begins[i]` to `begins[i + 1]`. `keys` stores, leaf by leaf, the first
  /// number of each key, then the second of each, and so on.
  CoarseKeys(std::size_t key_size, std::span<const double> keys,
             std::span<const std::size_t> begins);

  /// The query's cells, for near_keys() and near_leaves().
  [[nodiscard]] std::vector<std::int16_t> query(const double* key) const;
  /// Bounds for keys nearer than a squared distance; -1 if there can be none.
  [[nodiscard]] CoarseBound bound(double squared_distance) const;

  /// Leaves whose box is at most `most` away, in order. Checks one box per kCoarseBlock leaves
  /// first.
  [[nodiscard]] std::vector<NearLeaf> near_leaves(const std::vector<std::int16_t>& query,
                                                  std::int32_t most) const;
  /// One bit per key of a leaf, at most 64; bits beyond the last key are undefined.
  [[nodiscard]] std::uint64_t near_keys(std::size_t leaf, const std::vector<std::int16_t>& query,
                                        std::int32_t most) const;

 private:
  [[nodiscard]] std::int16_t cell(double x, std::size_t number) const;
  void add_leaf(std::size_t leaf, const double* columns, std::size_t count);
  void add_box(std::size_t leaf, std::size_t number, std::int16_t least, std::int16_t most);

  const CoarseKernels* kernels_;
  std::size_t key_size_;
  std::size_t pair_count_;
  double last_cell_;
  double per_cell_ = 0;  ///< cells per unit; 0 if all keys are practically equal
  std::vector<double> lower_;
  std::vector<std::size_t> first_blocks_;  ///< per leaf, and the end
  std::vector<CoarsePair> keys_;
  std::vector<CoarsePair> boxes_;        ///< around leaves
  std::vector<CoarsePair> outer_boxes_;  ///< around the blocks of boxes_
};

}  // namespace mneme::internal
