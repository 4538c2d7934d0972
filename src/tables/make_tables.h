// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Builds the kernels' tables of robots and scenes.
#pragma once

#include "mneme/robot.h"
#include "mneme/scene.h"

#include "check/link_distances.h"
#include "tables/tables.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// In the order of rows.
template <class Matrix>
void store(const Matrix& m, float* out) {
  for (Eigen::Index row = 0; row < m.rows(); ++row) {
    for (Eigen::Index column = 0; column < m.cols(); ++column) {
      *out++ = static_cast<float>(m(row, column));
    }
  }
}

/// Error: more joints than the kernels can hold.
[[nodiscard]] Result<RobotTables> make_robot_tables(const Robot& robot);

/// The same for a robot that carries objects, from the tables of the bare one.
[[nodiscard]] Result<RobotTables> add_attached(const Robot& robot, const RobotTables& bare);

/// Without checks of some pairs of links, each the lower index first.
[[nodiscard]] RobotTables without_pairs(RobotTables tables,
                                        const std::set<std::pair<int, int>>& pairs);

/// Errors: an obstacle without shapes, with one that has a flaw (find_flaw()), or too far away. Of
/// compound shapes only what is within `reach` metres of the root's origin is of interest
/// (reach_of()).
[[nodiscard]] Result<SceneTables> make_scene_tables(
    const Scene& scene, double reach = std::numeric_limits<double>::infinity());

/// The groups that may touch each obstacle (SceneTables::may_touch), also those that are checked by
/// solid among them if `allows_exact` says so. Error: an obstacle names a link that the robot
/// lacks.
[[nodiscard]] Result<std::vector<std::uint16_t>> find_allowed_contacts(const Robot& robot,
                                                                       const RobotTables& tables,
                                                                       const Scene& scene,
                                                                       bool allows_exact);

/// On the straight motion between two configurations. A turning joint moves a point along an arc
/// about its axis, which is no farther from it than the links and slides between them are long.
[[nodiscard]] Reaches find_reaches(const RobotTables& tables, std::span<const float> from,
                                   std::span<const float> to);

/// Fills `reaches` and `has_far_slides` of tables that have all else.
void add_reaches(RobotTables& tables);

/// Metres that are spared for margins beyond those of the checker.
inline constexpr double kSpareReach = 0.25;
/// farthest_reach(), and what is spared.
[[nodiscard]] double reach_of(const Robot& robot);

struct CheckedRobot {
  RobotTables tables;
  LinkDistances links;
  double reach = 0;  ///< reach_of() the robot
};

/// Made at the first call for a robot or any copy of it, which takes milliseconds, for one that
/// carries objects microseconds. When one is made, those are let go whose robots are gone with all
/// copies. Thread-safe. Error: as make_robot_tables.
[[nodiscard]] Result<std::shared_ptr<const CheckedRobot>> share_checked_robot(const Robot& robot);

}  // namespace mneme::internal
