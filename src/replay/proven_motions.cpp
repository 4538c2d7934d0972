// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/proven_motions.h"

#include "geometry/solids.h"
#include "path/waypoints.h"

#include <algorithm>
#include <list>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostKept = 32;            ///< cells, and robots
constexpr std::size_t kMostMotions = 1024;       ///< per cell
constexpr std::size_t kMostLinkMotions = 16384;  ///< per robot, over all cells

bool is_same(const Robot& a, const Robot& b) {
  const std::weak_ptr<const void> one = a.identity(), other = b.identity();
  return !one.owner_before(other) && !other.owner_before(one);
}

/// Least recently used entries are dropped.
template <class Kept>
class LatestOf {
 public:
  /// The entry that `is_wanted` accepts, or null.
  template <class IsWanted>
  std::shared_ptr<Kept> find(const IsWanted& is_wanted) {
    const std::lock_guard lock(mutex_);
    const auto known =
        std::ranges::find_if(kept_, [&](const auto& one) { return is_wanted(*one); });
    if (known == kept_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, known);
    return kept_.front();
  }

  std::shared_ptr<Kept> keep(std::shared_ptr<Kept> one) {
    const std::lock_guard lock(mutex_);
    kept_.push_front(std::move(one));
    if (kept_.size() > kMostKept) kept_.pop_back();
    return kept_.front();
  }

 private:
  std::mutex mutex_;
  std::list<std::shared_ptr<Kept>> kept_;
};

/// Proofs that links keep apart depend on robot and instruction set only.
struct Links {
  Robot robot;
  Isa isa;
  ProvenMotions motions{kMostLinkMotions};

  explicit Links(const CollisionChecker& checker) : robot(checker.robot()), isa(checker.isa()) {}
};

LatestOf<StaticCell>& cells() {
  static LatestOf<StaticCell> kept;
  return kept;
}

/// Ignores the scene's name.
bool are_same_obstacles(const Scene& a, const Scene& b) {
  return a.obstacles == b.obstacles && a.exact_pairs == b.exact_pairs &&
         a.end_contacts == b.end_contacts;
}

bool has_few_parts(const Scene& scene) {
  return std::ranges::all_of(scene.obstacles, [](const Obstacle& obstacle) {
    return std::ranges::none_of(obstacle.shapes, is_compound);
  });
}

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

std::shared_ptr<ProvenMotions> ProvenMotions::of_links(const CollisionChecker& checker,
                                                       Verification verification) {
  static LatestOf<Links> kept;
  const Scene& scene = checker.scene();
  const auto is_exact = [](const Obstacle& obstacle) { return !obstacle.exact_links.empty(); };
  if (verification != Verification::motions || !scene.exact_pairs.empty() ||
      std::ranges::any_of(scene.obstacles, is_exact)) {
    return nullptr;
  }
  auto links = kept.find([&](const Links& one) {
    return is_same(one.robot, checker.robot()) && one.isa == checker.isa();
  });
  if (links == nullptr) links = kept.keep(std::make_shared<Links>(checker));
  return {links, &links->motions};
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

StaticCell::StaticCell(const CollisionChecker& checker)
    : checker_(checker),
      by_states_(kMostMotions),
      by_motions_(kMostMotions),
      clear_(kMostMotions) {}

std::shared_ptr<StaticCell> StaticCell::find(const Robot& robot, const Scene& scene,
                                             const CheckerSettings& settings) {
  if (!settings.constraints.empty()) return nullptr;
  const Isa isa = resolve_isa(settings.isa);
  return cells().find([&](const StaticCell& cell) {
    const CollisionChecker& kept = cell.checker();
    // Searches begin coarser where no resolution is set.
    const bool is_as_fine = kept.has_default_resolution() == !settings.resolution &&
                            kept.resolution() == settings.resolution.value_or(kept.resolution());
    // A checker rounds its margin to single precision.
    const bool is_as_wide =
        kept.margin() == static_cast<double>(static_cast<float>(settings.margin));
    return is_same(kept.robot(), robot) && is_as_fine && is_as_wide && kept.isa() == isa &&
           are_same_obstacles(kept.scene(), scene);
  });
}

std::shared_ptr<StaticCell> StaticCell::keep(const CollisionChecker& checker) {
  if (!checker.constraints().empty() || !has_few_parts(checker.scene())) return nullptr;
  CheckerSettings settings;
  if (!checker.has_default_resolution()) settings.resolution = checker.resolution();
  settings.margin = checker.margin();
  settings.isa = checker.isa();
  auto cell = find(checker.robot(), checker.scene(), settings);
  return cell != nullptr ? cell : cells().keep(std::make_shared<StaticCell>(checker));
}

bool StaticCell::are_clear(const PlanQuery& ends) const {
  const Robot& robot = checker_.robot();
  const auto is_clear = [&](const Configuration& q) {
    if (!robot.is_configuration(q)) return false;
    const std::vector<float> row = to_floats(robot, q);
    return clear_.contain(row, row, {});
  };
  return is_clear(ends.start) && std::ranges::all_of(ends.goals, is_clear);
}

void StaticCell::add_clear(const PlanQuery& ends) {
  const auto add = [&](const Configuration& q) {
    const std::vector<float> row = to_floats(checker_.robot(), q);
    clear_.add(row, row, {});
  };
  add(ends.start);
  std::ranges::for_each(ends.goals, add);
}

Result<QueryChecker> query_checker_of(const Robot& robot, const Scene& scene,
                                      const CheckerSettings& settings, const PlanQuery& ends) {
  const auto known = StaticCell::find(robot, scene, settings);
  return known != nullptr ? make_query_checker(known->checker(), settings, ends)
                          : make_query_checker(robot, scene, settings, ends);
}

Result<CellChecker> find_or_make_checker(const Robot& robot, const Scene& scene,
                                         const CheckerSettings& settings, const PlanQuery& ends) {
  auto known = StaticCell::find(robot, scene, settings);
  if (known != nullptr && known->are_clear(ends)) {
    return CellChecker{{known->checker(), {}, true}, known};
  }
  QueryChecker made =
      MNEME_TRY(known != nullptr ? make_query_checker(known->checker(), settings, ends)
                                 : make_query_checker(robot, scene, settings, ends));
  const bool is_known = known != nullptr && made.notes.empty();
  auto cell = is_known ? known : StaticCell::keep(made.checker);
  if (cell != nullptr && made.are_ends_clear) cell->add_clear(ends);
  return CellChecker{std::move(made), std::move(cell)};
}

}  // namespace mneme::internal
