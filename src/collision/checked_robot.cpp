// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/checked_robot.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "collision/robot_tables.h"
#include "robot/link_shapes.h"

namespace mneme::internal {
namespace {

std::vector<Capsule> find_fixed_shapes(const Robot& robot) {
  const std::vector<bool> is_moving = find_moving_links(robot);
  const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
  const std::vector<Transform> poses = robot.link_poses(zero);
  std::vector<Capsule> result;
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    if (is_moving[i]) continue;
    const std::vector<Capsule> shapes = shapes_of(robot.links()[i], poses[i]);
    result.insert(result.end(), shapes.begin(), shapes.end());
  }
  return result;
}

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
  auto made = std::make_shared<const CheckedRobot>(
      CheckedRobot{std::move(*tables), find_fixed_shapes(robot)});
  registry.add(robot, made);
  return made;
}

}  // namespace mneme::internal
