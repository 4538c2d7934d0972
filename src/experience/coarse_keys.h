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

/// Squared distances in cells: no box of anything that is nearer than something is farther than the
/// one, none of its keys than the other.
struct CoarseBound {
  std::int32_t boxes = -1, keys = -1;
};

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

  /// What near_keys() and near_leaves() take.
  [[nodiscard]] std::vector<std::int16_t> query(const double* key) const;
  /// Of what is nearer than a squared distance; -1 if nothing is.
  [[nodiscard]] CoarseBound bound(double squared_distance) const;

  /// Those that are not farther than `most`, in order of leaves. Looks at one box per kCoarseBlock
  /// leaves, and into those that are near enough: neighbours in the tree are neighbours in space.
  [[nodiscard]] std::vector<NearLeaf> near_leaves(const std::vector<std::int16_t>& query,
                                                  std::int32_t most) const;
  /// A bit for each key of a leaf, of at most 64; those behind the last one mean nothing.
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
  double per_cell_ = 0;  ///< cells per unit; 0 if all keys are as good as the same
  std::vector<double> lower_;
  std::vector<std::size_t> first_blocks_;  ///< per leaf, and one behind the last
  std::vector<CoarsePair> keys_;
  std::vector<CoarsePair> boxes_;        ///< of leaves
  std::vector<CoarsePair> outer_boxes_;  ///< around the blocks of boxes_
};

}  // namespace mneme::internal
