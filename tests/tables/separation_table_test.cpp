// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/make_tables.h"
#include "collision/random_worlds.h"
#include "support/support.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace mneme::test {
namespace {

using internal::RobotTables;
using internal::SeparationTable;

RobotTables full_tables(const Robot& robot) { return require(internal::make_robot_tables(robot)); }

/// The value of the cell of a configuration, looked up in double precision.
int rings_at(const SeparationTable& table, const Configuration& q) {
  std::int64_t index = 0;
  for (const SeparationTable::Axis& axis : table.axes) {
    double cell = double{axis.scale} * q[static_cast<std::size_t>(axis.joint)] + axis.offset;
    if (axis.has_period) cell -= std::floor(cell / axis.cells) * axis.cells;
    index = index * axis.cells + std::clamp(static_cast<int>(std::floor(cell)), 0, axis.cells - 1);
  }
  const std::uint32_t word = table.rings.at(static_cast<std::size_t>(index / 16));
  return static_cast<int>(word >> (2 * (index % 16)) & 3);
}

std::set<std::pair<int, int>> links_of(const RobotTables& tables,
                                       const internal::BodyPairRow& pair) {
  std::set<std::pair<int, int>> links;
  const auto link_of = [&](int group) {
    return tables.link_of_group.at(static_cast<std::size_t>(group));
  };
  for (int i = pair.begin; i < pair.end; ++i) {
    const auto& row = tables.group_pairs.at(static_cast<std::size_t>(i));
    for (int k = row.second_begin; k < row.second_end; ++k) {
      links.emplace(link_of(row.first), link_of(k));
    }
  }
  return links;
}

std::vector<Capsule> posed_shapes(const Link& link, const Transform& pose) {
  std::vector<Capsule> shapes;
  for (const Sphere& s : link.spheres) {
    shapes.push_back({pose * s.center, pose * s.center, s.radius});
  }
  for (const Capsule& c : link.capsules) shapes.push_back({pose * c.a, pose * c.b, c.radius});
  return shapes;
}

/// Least distance between the links of a pair, exactly.
double exact_gap(const Robot& robot, const std::set<std::pair<int, int>>& links,
                 const Configuration& q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [first, second] : links) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    for (const Capsule& s : posed_shapes(robot.links()[a], poses[a])) {
      for (const Capsule& t : posed_shapes(robot.links()[b], poses[b])) {
        least = std::min(least, segment_distance(s.a, s.b, t.a, t.b) - s.radius - t.radius);
      }
    }
  }
  return least;
}

/// A random configuration, now and then with joints at their limits, and continuous ones some turns
/// further.
Configuration any_configuration(const Robot& robot, Rng& rng) {
  Configuration q = random_configuration(robot, rng);
  for (std::size_t j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.group_joint(static_cast<int>(j));
    if (joint.type == JointType::continuous) {
      if (rng.index(4) == 0) q[j] += 2 * kPi * std::floor(rng.uniform(-1500, 1500));
    } else if (rng.index(8) == 0) {
      q[j] = rng.index(2) == 0 ? joint.lower : joint.upper;
    }
  }
  return q;
}

struct Tally {
  int proven = 0, apart = 0, swept = 0;

  /// Whatever a table proves is so, in its cell and around it.
  void check(const Robot& robot, int rounds, Rng& rng) {
    const RobotTables tables = full_tables(robot);
    for (const internal::BodyPairRow& pair : tables.body_pairs) {
      if (pair.separation_table < 0) continue;
      const SeparationTable& table =
          tables.separation_tables->at(static_cast<std::size_t>(pair.separation_table));
      const auto links = links_of(tables, pair);
      for (int i = 0; i < rounds; ++i) {
        const Configuration q = any_configuration(robot, rng);
        const int rings = rings_at(table, q);
        const double gap = exact_gap(robot, links, q);
        apart += gap > 0.05 ? 1 : 0;
        if (rings == 0) continue;
        ++proven;
        CHECK(gap > SeparationTable::kApart - 1e-5);
        if (rings > 1) check_around(robot, table, links, q, rings - 1, rng);
      }
    }
  }

  void check_around(const Robot& robot, const SeparationTable& table,
                    const std::set<std::pair<int, int>>& links, Configuration q, int cells,
                    Rng& rng) {
    for (const SeparationTable::Axis& axis : table.axes) {
      if (axis.scale == 0) continue;  // one joint only
      q[static_cast<std::size_t>(axis.joint)] += rng.uniform(-cells, cells) / axis.scale;
    }
    ++swept;
    CHECK(rings_at(table, q) > 0);
    CHECK(exact_gap(robot, links, q) > SeparationTable::kApart - 1e-5);
  }
};

TEST_SUITE("unit") {
  TEST_CASE("nothing is proven beyond the limits of joints without a period") {
    const Robot robot = load_robot(source_file("robots/panda.urdf")).value();
    const RobotTables tables = full_tables(robot);
    REQUIRE(tables.separation_tables != nullptr);
    Rng rng(5);
    for (const SeparationTable& table : *tables.separation_tables) {
      for (const SeparationTable::Axis& axis : table.axes) {
        if (axis.scale == 0) continue;  // one joint only
        REQUIRE_FALSE(axis.has_period);
        const Joint& joint = robot.group_joint(axis.joint);
        Configuration q = random_configuration(robot, rng);
        for (const double value : {joint.lower - 1e-3, joint.upper + 1e-3, 1e30, -1e30}) {
          q[static_cast<std::size_t>(axis.joint)] = std::clamp(value, -1e4, 1e4);
          CHECK(rings_at(table, q) == 0);
        }
      }
    }
  }

  TEST_CASE("tables are small, and copies of the robot's tables share them") {
    for (const char* name : {"panda", "ur5", "fetch"}) {
      const RobotTables tables =
          full_tables(load_robot(source_file(std::string("robots/") + name + ".urdf")).value());
      const RobotTables copy = tables;
      CHECK(copy.separation_tables == tables.separation_tables);
      if (tables.separation_tables == nullptr) continue;
      for (const SeparationTable& table : *tables.separation_tables)
        CHECK(table.rings.size() <= 256);
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("what separation tables prove of random robots is so at any configuration") {
    Rng rng(601);
    Tally tally;
    for (int i = 0; i < rounds(150); ++i) tally.check(random_robot(rng), 40, rng);
    MESSAGE("proven " << tally.proven << ", more than 5 cm apart " << tally.apart << ", swept "
                      << tally.swept);
    CHECK(tally.proven > 1000);
    CHECK(tally.swept > 500);
  }

  TEST_CASE("separation tables of real robots prove most of what is well apart") {
    Rng rng(602);
    Tally tally;
    for (const char* name : {"panda", "ur5"}) {
      tally.check(load_robot(source_file(std::string("robots/") + name + ".urdf")).value(), 2000,
                  rng);
    }
    MESSAGE("proven " << tally.proven << ", more than 5 cm apart " << tally.apart << ", swept "
                      << tally.swept);
    CHECK(tally.proven > 0.7 * tally.apart);
    CHECK(tally.swept > 1000);
  }
}

}  // namespace
}  // namespace mneme::test
