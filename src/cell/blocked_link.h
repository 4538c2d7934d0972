// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Proves that a link is in contact in all tasks of a box, whatever the rest of the robot does.
#pragma once

#include "mneme/cell.h"

#include "cell/task_frame.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

struct BlockedBy {
  std::string link, obstacle;
};

class BlockedLink {
  struct Part;
  struct Place;

 public:
  /// The link, and the links that are fixed to it.
  BlockedLink(const CellRegion& region, const TaskFrame& frame);
  BlockedLink(const BlockedLink&) = delete;
  BlockedLink& operator=(const BlockedLink&) = delete;

  /// Parts that the link may come close to in a box of tasks.
  struct Vicinity {
    std::optional<BlockedBy> blocked;  ///< a contact that all tasks share, if one is proven
    std::vector<std::pair<const Part*, const Place*>> near;
  };
  /// Finds what is closer than `margin` in some task of the box, and perhaps more.
  [[nodiscard]] Vicinity look_around(const TaskBox& box, double margin) const;
  /// Returns what is closer than `margin` in one task of the box, if it is a box, sphere, capsule
  /// or cylinder.
  [[nodiscard]] std::optional<BlockedBy> find(const Vicinity& vicinity, const CellTask& task,
                                              double margin) const;

 private:
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
