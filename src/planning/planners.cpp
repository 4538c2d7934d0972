// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "mneme/planning.h"

namespace mneme {
namespace {

// To add a planner: its file, its declaration in mneme/planning.h, a row here.
constexpr std::array<PlannerEntry, 3> kPlanners = {{
    {"rrt_connect", &rrt_connect,
     "trees from start and goal, each reaching for the other's newest node"},
    {"rrt", &rrt, "a single tree from the start with goal bias"},
    {"prm", &prm, "a roadmap grown until start and goal are connected"},
}};

constexpr double kPlanarRange = 0.64;
constexpr double kSpatialRange = 0.5;

}  // namespace

std::span<const PlannerEntry> planners() { return kPlanners; }

const PlannerEntry* find_planner(std::string_view name) {
  const auto entry =
      std::find_if(kPlanners.begin(), kPlanners.end(),
                   [&](const PlannerEntry& planner) { return planner.name == name; });
  return entry == kPlanners.end() ? nullptr : &*entry;
}

double default_range(const Robot& robot) {
  return robot.is_planar() ? kPlanarRange : kSpatialRange;
}

std::string_view to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::solved:
      return "solved";
    case PlanStatus::timeout:
      return "timeout";
    case PlanStatus::iteration_limit:
      return "iteration_limit";
    case PlanStatus::node_limit:
      return "node_limit";
    case PlanStatus::cancelled:
      return "cancelled";
    case PlanStatus::invalid_start:
      return "invalid_start";
    case PlanStatus::invalid_goal:
      return "invalid_goal";
  }
  return "unknown";
}

}  // namespace mneme
