// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/checked_robot.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "collision/robot_tables.h"

namespace mneme::internal {
namespace {

struct Entry {
  std::weak_ptr<const void> identity;
  std::shared_ptr<const CheckedRobot> robot;

  [[nodiscard]] bool is_of(const std::weak_ptr<const void>& other) const {
    return !identity.owner_before(other) && !other.owner_before(identity);
  }
};

class Registry {
 public:
  std::shared_ptr<const CheckedRobot> find(const Robot& robot) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(
        entries_, [&](const Entry& entry) { return entry.is_of(robot.identity()); });
    return found == entries_.end() ? nullptr : found->robot;
  }

  void add(const Robot& robot, std::shared_ptr<const CheckedRobot> checked) {
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const Entry& entry) { return entry.identity.expired(); });
    entries_.push_back({robot.identity(), std::move(checked)});
  }

 private:
  std::mutex mutex_;
  std::vector<Entry> entries_;
};

}  // namespace

Result<std::shared_ptr<const CheckedRobot>> share_checked_robot(const Robot& robot) {
  static Registry registry;
  if (auto found = registry.find(robot)) return found;
  auto tables = make_robot_tables(robot);
  if (!tables) return tl::unexpected(tables.error());
  const LinkDistances links(robot);
  const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
  auto made = std::make_shared<const CheckedRobot>(
      CheckedRobot{std::move(*tables), links, links.posed(robot.link_poses(zero))});
  registry.add(robot, made);
  return made;
}

double fixed_clearance(const CheckedRobot& robot, const Scene& scene) {
  return find_clearance(robot.links, robot.at_zero, obstacle_shapes(scene), false).distance;
}

}  // namespace mneme::internal
