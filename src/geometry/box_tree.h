// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A tree of boxes over many parts, in double precision: which of them is nearest.
#pragma once

#include "geometry/axis_box.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace mneme::internal {

/// A part by its position in a list, and the distance from it.
struct NearestPart {
  int part = -1;
  double distance = std::numeric_limits<double>::infinity();
};

/// Const and parallel-safe. Of the libraries in Debian nanoflann knows points only, FCL (which the
/// tests use) neither limits nor counts of crossings, and CGAL is under the GPL.
class BoxTree {
 public:
  struct Node {
    AxisBox box;
    int first = 0, count = 0;  ///< of its parts in order(); none if it has children
    int right = -1;            ///< the left child follows its parent
  };

  /// `boxes` are those of the parts, which are halved again and again along a curve through space
  /// (Morton's): a tree over a million of them takes tens of ms.
  explicit BoxTree(const std::vector<AxisBox>& boxes, int leaf_size = 8);

  /// The root first.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// Positions of parts in their list.
  [[nodiscard]] const std::vector<int>& order() const { return order_; }

  /// The part nearest to something that lies in `around`, if it is closer than `limit`;
  /// `distance_to(i)` is its distance from part i.
  template <class DistanceTo>
  [[nodiscard]] NearestPart nearest(const AxisBox& around, const DistanceTo& distance_to,
                                    double limit = std::numeric_limits<double>::infinity()) const {
    NearestPart best{-1, limit};
    if (!nodes_.empty()) search(0, around, distance_to, best);
    return best;
  }

 private:
  int build(const std::vector<AxisBox>& boxes, int first, int count);

  template <class DistanceTo>
  void search(int index, const AxisBox& around, const DistanceTo& distance_to,
              NearestPart& best) const {
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int part = order_[static_cast<std::size_t>(i)];
      const double distance = distance_to(part);
      if (distance < best.distance) best = {part, distance};
    }
    if (node.right < 0) return;
    int near = index + 1, far = node.right;
    double near2 = reach2(near, around), far2 = reach2(far, around);
    if (far2 < near2) {
      std::swap(near, far);
      std::swap(near2, far2);
    }
    if (is_within(near2, best.distance)) search(near, around, distance_to, best);
    if (is_within(far2, best.distance)) search(far, around, distance_to, best);
  }
  [[nodiscard]] double reach2(int index, const AxisBox& around) const {
    return distance2(nodes_[static_cast<std::size_t>(index)].box, around);
  }
  static bool is_within(double distance2, double limit) {
    return limit > 0 && distance2 < limit * limit;
  }

  int leaf_size_ = 1;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace mneme::internal
