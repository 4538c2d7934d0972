// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"

#include "base/fail.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace mneme {
namespace {

// To add a planner: src/planning/NAME.cpp, its declaration in mneme/planning.h, a row here, a test.
// Command line, Python, benchmarks and the shared tests take it from here.
std::vector<PlannerEntry>& table() {
  static std::vector<PlannerEntry> entries = {
      {.name = "rrt_connect",
       .summary = "trees from start and goal, each reaching for the other's newest node",
       .plan = &rrt_connect,
       .walks = true,
       .projects = true},
      {.name = "rrt",
       .summary = "a single tree from the start with goal bias",
       .plan = &rrt,
       .projects = true},
      {.name = "prm",
       .summary = "a roadmap grown until start and goal are connected",
       .plan = &prm},
  };
  return entries;
}

const PlannerEntry* entry_of(std::string_view name) {
  const auto entry = std::ranges::find(table(), name, &PlannerEntry::name);
  return entry == table().end() ? nullptr : &*entry;
}

constexpr double kPlanarRange = 0.64;
constexpr double kSpatialRange = 0.5;

}  // namespace

std::span<const PlannerEntry> planners() { return table(); }

std::vector<std::string> planner_names() {
  std::vector<std::string> names;
  for (const PlannerEntry& planner : table()) names.push_back(planner.name);
  return names;
}

void add_planners(std::vector<PlannerEntry> entries) {
  for (PlannerEntry& entry : entries) {
    if (entry_of(entry.name) == nullptr) table().push_back(std::move(entry));
  }
}

Result<const PlannerEntry*> find_planner(std::string_view name) {
  if (const PlannerEntry* entry = entry_of(name)) return entry;
  const std::vector<std::string> names = planner_names();
  const bool has_ompl =
      std::ranges::any_of(names, [](const std::string& each) { return each.starts_with("ompl:"); });
  if (name.starts_with("ompl:") && !has_ompl) {
    return fail(ErrorCode::unsupported, "{}: this mneme was built without OMPL; expected one of {}",
                name, fmt::join(names, ", "));
  }
  return fail(ErrorCode::invalid, "unknown planner '{}': expected one of {}{}", name,
              fmt::join(names, ", "), did_you_mean(name, names));
}

PlanResult plan_with(PlanResult (*planner)(const PlanTask&), const CollisionChecker& checker,
                     const PlanQuery& query, const Sampler& sampler, const PlanSettings& settings) {
  if (auto refused = refuse_query(checker, query)) return *std::move(refused);
  PathFinisher shorten_and_verify(checker, settings.finish());
  return planner({checker, query, sampler, settings, shorten_and_verify});
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
