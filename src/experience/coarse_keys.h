// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Keys in two bytes per number, which say soon that most of them are not near.
#pragma once

#include "experience/coarse_kernels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The keys of a tree's leaves, and boxes around leaves, in cells of one width. Const is
/// parallel-safe.
class CoarseKeys {
 public:
  /// Least squared distance of a leaf's box, in cells, and which leaf it is.
  using NearLeaf = std::pair<std::int32_t, std::size_t>;

  /// Leaf i has the keys from `begins[i]` to `begins[i + 1]`, and all of the first numbers of its
  /// keys, then all of the second ones, and so on, are in `keys`.
  CoarseKeys(std::size_t key_size, std::span<const double> keys,
             std::span<const std::size_t> begins);

  /// What key_distances() and near_leaves() take.
  [[nodiscard]] std::vector<std::int16_t> query(const double* key) const;
  /// What is nearer than a squared distance has at most as many squared cells; -1 if nothing is.
  [[nodiscard]] std::int32_t most_cells(double squared_distance) const;

  /// Those that are not farther than `most`, in order of leaves. Looks at one box per kCoarseBlock
  /// leaves, and into those that are near enough: neighbours in the tree are neighbours in space.
  [[nodiscard]] std::vector<NearLeaf> near_leaves(const std::vector<std::int16_t>& query,
                                                  std::int32_t most) const;
  /// Of the keys of a leaf, whose number is rounded up to a multiple of kCoarseBlock.
  void key_distances(std::size_t leaf, const std::vector<std::int16_t>& query,
                     std::int32_t* squared) const;

 private:
  [[nodiscard]] std::int16_t cell(double x, std::size_t number) const;
  void add_leaf(std::size_t leaf, const double* columns, std::size_t count);
  void add_box(std::size_t leaf, std::size_t number, std::int16_t least, std::int16_t most);

  const CoarseKernels* kernels_;
  std::size_t key_size_;
  std::size_t pair_count_;
  double last_cell_;
  double per_cell_ = 0;  ///< cells per unit; 0 if all keys are as good as the same
  std::vector<double> lower_;
  std::vector<std::size_t> first_blocks_;  ///< per leaf, and one behind the last
  std::vector<std::int16_t> keys_;
  std::vector<std::int16_t> boxes_;        ///< of leaves
  std::vector<std::int16_t> outer_boxes_;  ///< around the blocks of boxes_
};

}  // namespace mneme::internal
