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
/// Of a robot, in all cells.
constexpr std::size_t kMostLinkMotions = 16384;

bool is_same(const std::weak_ptr<const void>& a, const std::weak_ptr<const void>& b) {
  return !a.owner_before(b) && !b.owner_before(a);
}

/// All that a proof depends on besides the motion: not the scene's name, for one.
struct Cell {
  std::weak_ptr<const void> robot;  ///< Robot::identity()
  Scene scene;
  double resolution;
  double margin;
  Isa isa;
  Verification verification;
  std::shared_ptr<ProvenMotions> motions = std::make_shared<ProvenMotions>(kMostMotions);

  Cell(const CollisionChecker& checker, Verification by)
      : robot(checker.robot().identity()),
        scene(checker.scene()),
        resolution(checker.resolution()),
        margin(checker.margin()),
        isa(checker.isa()),
        verification(by) {}

  [[nodiscard]] bool is_of(const CollisionChecker& checker, Verification by) const {
    return is_same(robot, checker.robot().identity()) && resolution == checker.resolution() &&
           margin == checker.margin() && isa == checker.isa() && verification == by &&
           scene.obstacles == checker.scene().obstacles &&
           scene.by_solid == checker.scene().by_solid;
  }
};

/// All that links' keeping apart depends on besides the motion.
struct Links {
  std::weak_ptr<const void> robot;
  Isa isa;
  std::shared_ptr<ProvenMotions> motions = std::make_shared<ProvenMotions>(kMostLinkMotions);

  explicit Links(const CollisionChecker& checker)
      : robot(checker.robot().identity()), isa(checker.isa()) {}

  [[nodiscard]] bool is_of(const CollisionChecker& checker) const {
    return is_same(robot, checker.robot().identity()) && isa == checker.isa();
  }
};

/// What `is_asked` of those that were asked for last, the latest first, or else `make()`.
template <class Kept, class IsAsked, class Make>
std::shared_ptr<ProvenMotions> find_or_make(std::list<Kept>& kept, const IsAsked& is_asked,
                                            const Make& make) {
  kept.remove_if([](const Kept& old) { return old.robot.expired(); });
  const auto known = std::ranges::find_if(kept, is_asked);
  if (known != kept.end()) {
    kept.splice(kept.begin(), kept, known);
  } else {
    kept.push_front(make());
    if (kept.size() > kMostCells) kept.pop_back();
  }
  return kept.front().motions;
}

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
  static std::list<Cell> cells;
  if (!checker.constraints().empty() || !has_few_parts(checker.scene())) return nullptr;
  const std::lock_guard lock(mutex);
  return find_or_make(
      cells, [&](const Cell& cell) { return cell.is_of(checker, verification); },
      [&] { return Cell(checker, verification); });
}

std::shared_ptr<ProvenMotions> ProvenMotions::of_links(const CollisionChecker& checker,
                                                       Verification verification) {
  static std::mutex mutex;
  static std::list<Links> robots;
  const Scene& scene = checker.scene();
  const auto is_by_solid = [](const Obstacle& obstacle) { return !obstacle.by_solid.empty(); };
  if (verification != Verification::motions || !scene.by_solid.empty() ||
      std::ranges::any_of(scene.obstacles, is_by_solid)) {
    return nullptr;
  }
  const std::lock_guard lock(mutex);
  return find_or_make(
      robots, [&](const Links& links) { return links.is_of(checker); },
      [&] { return Links(checker); });
}

bool ProvenMotions::contain(std::span<const float> from, std::span<const float> to,
                            MotionEnds ends) const {
  const std::lock_guard lock(mutex_);
  return motions_.contains(bytes_of(from, to, ends));
}

void ProvenMotions::add(std::span<const float> from, std::span<const float> to, MotionEnds ends) {
  const std::lock_guard lock(mutex_);
  if (motions_.size() >= most_) motions_.clear();
  motions_.insert(bytes_of(from, to, ends));
}

}  // namespace mneme::internal
