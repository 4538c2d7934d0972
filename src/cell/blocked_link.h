// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Proves that a link is in contact in all tasks of a box, whatever the rest of the robot does.
#pragma once

#include "mneme/cell.h"

#include "cell/task_frame.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

struct BlockedBy {
  std::string link, obstacle;
};

class BlockedLink {
 public:
  /// The link, and the links that are fixed to it.
  BlockedLink(const CellRegion& region, const TaskFrame& frame);
  BlockedLink(const BlockedLink&) = delete;
  BlockedLink& operator=(const BlockedLink&) = delete;

  /// Returns a contact that all tasks of the box share, if one is proven.
  [[nodiscard]] std::optional<BlockedBy> find(const TaskBox& box) const;
  /// Returns what is closer than `margin` in one task, if it is a box, sphere, capsule or cylinder.
  [[nodiscard]] std::optional<BlockedBy> find(const CellTask& task, double margin) const;

 private:
  template <class DepthOf>
  [[nodiscard]] std::optional<BlockedBy> find_deep(const CellTask& task, double margin,
                                                   const DepthOf& is_deep) const;

  /// A shape of an obstacle, and a ball around it.
  struct Place {
    const Shape* shape = nullptr;
    Vec3 center;
    double radius = 0;
    const std::string* obstacle = nullptr;
  };
  struct Part {
    Capsule capsule;  ///< in the region's link's frame
    double away = 0;  ///< distance of its farthest point from the pivot
    std::string link;
    std::vector<Place> obstacles;  ///< that it may not touch
  };

  const TaskFrame& frame_;
  std::vector<Obstacle> scene_;
  std::vector<Part> parts_;
};

}  // namespace mneme::internal
