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

/// Writes the entries in row-major order.
template <class Matrix>
void store(const Matrix& m, float* out) {
  for (Eigen::Index row = 0; row < m.rows(); ++row) {
    for (Eigen::Index column = 0; column < m.cols(); ++column) {
      *out++ = static_cast<float>(m(row, column));
    }
  }
}

/// Makes the kernels' tables of a robot, without the pairs that ExactPairs checks by exact
/// geometry. Error: more moving joints than kMaxFrames.
[[nodiscard]] Result<RobotTables> make_robot_tables(const Robot& robot);

/// The spheres of a pair of links that is checked by exact geometry.
struct PairTables {
  std::pair<int, int> links;
  RobotTables tables;  ///< check this pair only; without limbs and separation tables
};
/// Makes the tables of Robot::exact_pairs. Error: more moving joints than kMaxFrames.
[[nodiscard]] Result<std::vector<PairTables>> make_pair_tables(const Robot& robot);

/// Makes the tables of a robot with attached objects from the tables of the bare robot.
[[nodiscard]] Result<RobotTables> add_attached(const Robot& robot, const RobotTables& bare);

/// Returns the tables without checks of these pairs of links, each with its lower index first.
[[nodiscard]] RobotTables without_pairs(RobotTables tables,
                                        const std::set<std::pair<int, int>>& pairs);

/// Parts of compound shapes farther than `reach` metres from the root's origin are ignored
/// (reach_of()). Errors: an obstacle without shapes, with a flawed shape (find_flaw()), or too far
/// away.
[[nodiscard]] Result<SceneTables> make_scene_tables(
    const Scene& scene, double reach = std::numeric_limits<double>::infinity());

/// Finds the groups that kernels do not check against each obstacle (SceneTables::may_touch): of
/// links that may touch it, and of links that are checked by exact geometry.
[[nodiscard]] std::vector<std::uint16_t> find_allowed_contacts(const Robot& robot,
                                                               const RobotTables& tables,
                                                               const Scene& scene);

/// Finds SceneTables::clearances: bodies near the robot's base often reach no obstacle.
[[nodiscard]] std::vector<float> find_clearances(const RobotTables& robot,
                                                 const SceneTables& scene);

/// Displacement bounds of a motion, metres.
struct Displacements {
  std::vector<float> bodies;  ///< for each moving body
  std::vector<float> pairs;   ///< for the approach of each pair of bodies
  float longest_of_bodies = 0;
  float longest = 0;
  float farthest_reach = 0;  ///< for one radian of any joint

  /// Bounds what either bounds.
  void include(const Displacements& other);
};
/// Bounds the motion by `delta` per joint anywhere between two configurations.
[[nodiscard]] Displacements find_displacements(const RobotTables& tables,
                                               std::span<const float> from,
                                               std::span<const float> to,
                                               std::span<const float> delta);

/// Fills `reaches` and `has_far_slides` of tables that are otherwise complete.
void add_reaches(RobotTables& tables);

/// Adds separation tables of the pairs with one or two joints between them to tables that are
/// otherwise complete. Cost: a millisecond or two and 1 KB a pair.
void add_separation_tables(const Robot& robot, RobotTables& tables);

/// Metres kept in reserve for margins beyond the checker's own.
inline constexpr double kSpareReach = 0.25;
/// farthest_reach() plus kSpareReach, metres.
[[nodiscard]] double reach_of(const Robot& robot);

struct CheckedRobot {
  RobotTables tables;
  LinkDistances links;
  double reach = 0;  ///< reach_of() the robot
  /// make_pair_tables() of the robot without attached objects.
  std::shared_ptr<const std::vector<PairTables>> exact_pairs;
};

/// Returns the tables that all copies of a robot share. The first call for a robot makes them,
/// which takes milliseconds, or microseconds if only attached objects are new. It also releases the
/// tables of robots that no longer exist. Thread-safe. Errors: those of make_robot_tables().
[[nodiscard]] Result<std::shared_ptr<const CheckedRobot>> share_checked_robot(const Robot& robot);

}  // namespace mneme::internal
