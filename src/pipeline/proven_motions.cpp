// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/proven_motions.h"

#include "geometry/solids.h"

#include <algorithm>
#include <list>
#include <variant>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostCells = 32;
constexpr std::size_t kMostMotions = 1024;

/// All that a proof depends on besides the motion: not the scene's name, for one.
struct Cell {
  std::weak_ptr<const void> robot;  ///< Robot::identity()
  Scene scene;
  double resolution;
  double margin;
  Isa isa;
  Verification verification;
  std::shared_ptr<ProvenMotions> motions = std::make_shared<ProvenMotions>();

  Cell(const CollisionChecker& checker, Verification by)
      : robot(checker.robot().identity()),
        scene(checker.scene()),
        resolution(checker.resolution()),
        margin(checker.margin()),
        isa(checker.isa()),
        verification(by) {}

  [[nodiscard]] bool is_of(const CollisionChecker& checker, Verification by) const {
    const std::weak_ptr<const void> asked = checker.robot().identity();
    return !robot.owner_before(asked) && !asked.owner_before(robot) &&
           resolution == checker.resolution() && margin == checker.margin() &&
           isa == checker.isa() && verification == by &&
           scene.obstacles == checker.scene().obstacles &&
           scene.by_solid == checker.scene().by_solid;
  }
};

bool has_few_parts(const Scene& scene) {
  return std::ranges::all_of(scene.obstacles, [](const Obstacle& obstacle) {
    return std::ranges::none_of(obstacle.shapes, is_crowd);
  });
}

/// The same for the same bits alone.
std::string bytes_of(std::span<const float> from, std::span<const float> to, MotionEnds ends) {
  std::string bytes;
  for (const std::span<const float> row : {from, to}) {
    bytes.append(reinterpret_cast<const char*>(row.data()), row.size_bytes());
  }
  bytes += ends.is_first ? '1' : '0';
  bytes += ends.is_last ? '1' : '0';
  return bytes;
}

}  // namespace

std::shared_ptr<ProvenMotions> ProvenMotions::of(const CollisionChecker& checker,
                                                 Verification verification) {
  static std::mutex mutex;
  static std::list<Cell> cells;  // that which was asked for last comes first
  if (!checker.constraints().empty() || !has_few_parts(checker.scene())) return nullptr;
  const std::lock_guard lock(mutex);
  cells.remove_if([](const Cell& cell) { return cell.robot.expired(); });
  const auto known = std::ranges::find_if(
      cells, [&](const Cell& cell) { return cell.is_of(checker, verification); });
  if (known != cells.end()) {
    cells.splice(cells.begin(), cells, known);
  } else {
    cells.emplace_front(checker, verification);
    if (cells.size() > kMostCells) cells.pop_back();
  }
  return cells.front().motions;
}

bool ProvenMotions::contain(std::span<const float> from, std::span<const float> to,
                            MotionEnds ends) const {
  const std::lock_guard lock(mutex_);
  return motions_.contains(bytes_of(from, to, ends));
}

void ProvenMotions::add(std::span<const float> from, std::span<const float> to, MotionEnds ends) {
  const std::lock_guard lock(mutex_);
  if (motions_.size() >= kMostMotions) motions_.clear();
  motions_.insert(bytes_of(from, to, ends));
}

}  // namespace mneme::internal
