// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Boxes of tasks, and the poses of their link.
#pragma once

#include "mneme/cell.h"

#include "goal/link_chain.h"

#include <array>
#include <vector>

namespace mneme::internal {

/// The parameter that is an angle; the others are metres.
inline constexpr int kYaw = 3;

struct TaskBox {
  CellTask center = {}, half = {};

  [[nodiscard]] bool contains(const CellTask& task) const;
  /// The task at `u`, a value in [-1, 1] per varying parameter.
  [[nodiscard]] CellTask at(const std::vector<int>& varying, const double* u) const;
  /// A random task; a corner if `is_corner`.
  [[nodiscard]] CellTask sample(const std::vector<int>& varying, Rng& rng,
                                bool is_corner = false) const;
  /// The inverse of at().
  [[nodiscard]] std::array<double, kTaskSize> place_of(const std::vector<int>& varying,
                                                       const CellTask& task) const;
};

/// The geometry of a region.
class TaskFrame {
 public:
  explicit TaskFrame(const CellRegion& region);

  /// Indices of the parameters that vary.
  [[nodiscard]] const std::vector<int>& varying() const { return varying_; }
  [[nodiscard]] const CellTask& half_extents() const { return half_extents_; }
  [[nodiscard]] Transform pose(const CellTask& task) const;
  /// The link's twist per unit of a parameter: motion of its origin, then rotation.
  [[nodiscard]] Eigen::Matrix<double, 6, 1> twist(const CellTask& task, int parameter) const;
  /// Bound on the motion of a point fixed to the link at distance `away` from the pivot, metres.
  [[nodiscard]] double displacement(const TaskBox& box, double away) const;
  /// Squared distance of a task from a box, relative to the region's half extents.
  [[nodiscard]] double distance2(const TaskBox& box, const CellTask& task) const;
  /// Share of the region's volume.
  [[nodiscard]] double share_of(const TaskBox& box) const;
  /// All tasks of the region.
  [[nodiscard]] TaskBox whole() const { return {{}, half_extents_}; }

 private:
  [[nodiscard]] Eigen::Matrix3d turn_of(const CellTask& task) const;

  std::vector<int> varying_;
  CellTask half_extents_;
  Transform middle_;
  Eigen::Matrix3d axes_;
  Vec3 from_pivot_;  ///< to the link's origin, in the root's frame
};

}  // namespace mneme::internal
