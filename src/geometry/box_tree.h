// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A bounding box hierarchy over many parts, in double precision, for nearest parts.
#pragma once

#include "geometry/axis_box.h"

#include <limits>
#include <vector>

namespace mneme::internal {

/// The index of a part and the distance to it.
struct NearestPart {
  int part = -1;
  double distance = std::numeric_limits<double>::infinity();
};

/// Parallel-safe once built. Libraries do not fit: nanoflann has points only, FCL neither distance
/// limits nor counts of crossings, and CGAL is under the GPL.
class BoxTree {
 public:
  struct Node {
    AxisBox box;
    int first = 0, count = 0;  ///< range in order(); empty for inner nodes
    int right = -1;            ///< right child, -1 for leaves; the left child is the next node
  };

  /// Builds the tree over the boxes of the parts, halving ranges in Morton order. Cost: tens of ms
  /// for a million parts.
  explicit BoxTree(const std::vector<AxisBox>& boxes, int leaf_size = 8);

  /// All nodes; the root is the first.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// Indices of parts, leaf by leaf.
  [[nodiscard]] const std::vector<int>& order() const { return order_; }

  /// The part nearest to an object within the box `around`, if closer than `limit`.
  /// `distance_to(i)` returns the object's distance to part i.
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
