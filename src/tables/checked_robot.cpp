// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/make_tables.h"
#include "base/files.h"
#include "robot/kinematics.h"

#include <map>
#include <memory>
#include <mutex>

namespace mneme::internal {
namespace {

/// Checked robots by robot identity, which copies share.
class Registry {
 public:
  std::shared_ptr<const CheckedRobot> find(const Robot& robot) {
    const std::lock_guard lock(mutex_);
    const auto found = robots_.find(robot.identity());
    return found == robots_.end() ? nullptr : found->second;
  }

  void add(const Robot& robot, std::shared_ptr<const CheckedRobot> checked) {
    const std::lock_guard lock(mutex_);
    std::erase_if(robots_, [](const auto& entry) { return entry.first.expired(); });
    robots_.insert_or_assign(robot.identity(), std::move(checked));
  }

 private:
  std::mutex mutex_;
  std::map<std::weak_ptr<const void>, std::shared_ptr<const CheckedRobot>, std::owner_less<>>
      robots_;
};

Result<CheckedRobot> make_checked_robot(const Robot& robot) {
  if (robot.attached().empty()) {
    RobotTables tables = MNEME_TRY(make_robot_tables(robot));
    LinkDistances links(robot);
    links.prove_cells(robot, cache_directory());
    return CheckedRobot{
        std::move(tables), std::move(links), reach_of(robot),
        std::make_shared<const std::vector<PairTables>>(MNEME_TRY(make_pair_tables(robot)))};
  }
  const auto bare = MNEME_TRY(share_checked_robot(robot.without_attached()));
  RobotTables tables = MNEME_TRY(add_attached(robot, bare->tables));
  return CheckedRobot{std::move(tables), LinkDistances(robot, bare->links), reach_of(robot),
                      bare->exact_pairs};
}

}  // namespace

double reach_of(const Robot& robot) { return farthest_reach(robot) + kSpareReach; }

Result<std::shared_ptr<const CheckedRobot>> share_checked_robot(const Robot& robot) {
  static Registry registry;
  if (auto found = registry.find(robot)) return found;
  CheckedRobot checked = MNEME_TRY(make_checked_robot(robot));
  auto made = std::make_shared<const CheckedRobot>(std::move(checked));
  registry.add(robot, made);
  return made;
}

}  // namespace mneme::internal
