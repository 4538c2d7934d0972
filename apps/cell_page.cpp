// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace mneme::app {
namespace {

/// Columns along x and y, and tasks that are looked up in each.
constexpr int kColumns = 24;
constexpr int kColumnTasks = 32;

struct ColumnTally {
  int proven = 0, blocked = 0, tasks = 0;
};

/// Colours of columns, from proven to not proven.
constexpr std::array<std::pair<double, const char*>, 5> kColors = {
    {{0.999, "#1a7f37"}, {0.9, "#6fbf73"}, {0.6, "#cddc39"}, {0.2, "#ffc107"}, {0.0, "#ff8f00"}}};
constexpr const char* kBlocked = "#b3261e";

std::string color_of(const ColumnTally& tally) {
  const int open = tally.tasks - tally.blocked;
  if (open == 0) return kBlocked;
  const double share = static_cast<double>(tally.proven) / open;
  return std::ranges::find_if(kColors, [&](const auto& each) { return share >= each.first; })
      ->second;
}

class RegionPainter {
 public:
  RegionPainter(const Cell& cell, std::size_t start)
      : cell_(cell), region_(cell.region()), start_(start), gaps_(cell.unproven(start)) {
    std::erase_if(gaps_, [](const UnprovenBox& box) { return box.gap != CellGap::blocked; });
  }

  /// Boxes in the root link's frame.
  std::vector<PlanTrace::Look> paint() {
    std::vector<PlanTrace::Look> looks;
    const int columns = region_.half_extents[0] > 0 ? kColumns : 1;
    const int rows = region_.half_extents[1] > 0 ? kColumns : 1;
    for (int i = 0; i < columns; ++i) {
      for (int k = 0; k < rows; ++k) looks.push_back(paint(i, columns, k, rows));
    }
    return looks;
  }

  /// The proven task that is nearest to the middle, and its path.
  [[nodiscard]] CellAnswer find_path() {
    constexpr int kMostTasks = 5000;
    CellAnswer answer;
    Rng rng(1);
    for (int i = 0; i < kMostTasks; ++i) {
      CellTask task = {};
      for (std::size_t k = 0; k < kTaskSize; ++k) {
        task[k] = region_.half_extents[k] * i / kMostTasks * rng.uniform(-1, 1);
      }
      cell_.look_up(task, answer, start_);
      if (answer.tier == CellTier::certified) break;
    }
    return answer;
  }

 private:
  PlanTrace::Look paint(int i, int columns, int k, int rows) {
    const CellTask& half = region_.half_extents;
    const double x = half[0] * ((2.0 * i + 1) / columns - 1);
    const double y = half[1] * ((2.0 * k + 1) / rows - 1);
    ColumnTally tally;
    for (tally.tasks = 0; tally.tasks < kColumnTasks; ++tally.tasks) {
      CellTask task = {x + half[0] / columns * rng_.uniform(-1, 1),
                       y + half[1] / rows * rng_.uniform(-1, 1), half[2] * rng_.uniform(-1, 1),
                       half[3] * rng_.uniform(-1, 1)};
      cell_.look_up(task, answer_, start_);
      if (answer_.tier == CellTier::certified) ++tally.proven;
      if (answer_.tier != CellTier::certified && is_blocked(task)) ++tally.blocked;
    }
    constexpr double kThin = 0.001, kGapShare = 0.9;
    const Transform pose = link_pose(region_, {x, y, 0, 0});
    Box box;
    box.pose = {region_.axes, pose * region_.pivot};
    box.half_extents = {kGapShare * std::max(half[0] / columns, kThin),
                        kGapShare * std::max(half[1] / rows, kThin), kThin};
    return {box, color_of(tally)};
  }

  [[nodiscard]] bool is_blocked(const CellTask& task) const {
    return std::ranges::any_of(gaps_, [&](const UnprovenBox& box) {
      for (std::size_t k = 0; k < kTaskSize; ++k) {
        if (std::abs(task[k] - box.center[k]) > box.half_extents[k]) return false;
      }
      return true;
    });
  }

  const Cell& cell_;
  const CellRegion& region_;
  std::size_t start_;
  std::vector<UnprovenBox> gaps_;  ///< in contact
  CellAnswer answer_;
  Rng rng_{1};
};

}  // namespace

Result<PlanTrace> trace_cell(const Cell& cell, std::size_t start) {
  RegionPainter painter(cell, start);
  const CellAnswer answer = painter.find_path();
  if (answer.path.empty()) {
    return fail(ErrorCode::invalid, "the cell has no proven task to show");
  }
  SolveResult solved;
  solved.plan.status = PlanStatus::solved;
  solved.plan.path = answer.path;
  solved.planner = "cell";
  solved.goals = {answer.path.back()};
  PlanTrace trace = MNEME_TRY(make_trace(cell.region().problem, solved, nullptr, 0));
  Link link;
  link.name = "region";
  trace.links.push_back(std::move(link));
  trace.looks.resize(trace.links.size());
  trace.looks.back() = painter.paint();
  trace.carriers.resize(trace.links.size());
  // The root link stands where the region's frame does.
  const auto add = [](PlanTrace::Poses& poses) { poses.emplace_back(); };
  add(trace.start);
  for (PlanTrace::Poses& poses : trace.goals) add(poses);
  for (PlanTrace::Waypoint& waypoint : trace.waypoints) add(waypoint.poses);
  return trace;
}

}  // namespace mneme::app
