// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/task_memory.h"

#include "base/as_index.h"
#include "pipeline/memory_steps.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>

namespace mneme::internal {
namespace {

/// Keys: two numbers of the object's name, the number of groups, position, and rotation as a
/// vector of this many metres per radian.
constexpr std::size_t kKeySize = 9;
constexpr double kMetresPerRadian = 0.1;
/// Rows of an object that was farther away are not found, metres squared.
constexpr double kFarthestSquared = 0.25;
constexpr int kMostRows = 4;
/// Alternatives that a row ranks first.
constexpr std::size_t kRankedPerRow = 3;

Vec3 rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

double difference(const Transform& a, const Transform& b) {
  return (a.translation - b.translation).norm() +
         kMetresPerRadian * rotation_vector(a.rotation.transpose() * b.rotation).norm();
}

}  // namespace

TaskMemory::TaskMemory(const Task& task, const std::vector<Group>& groups, Database* database)
    : task_(task), database_(database), groups_(groups.size()) {
  const auto attach = std::ranges::find(task.stages, StageKind::attach, &Stage::kind);
  if (attach == task.stages.end()) return;
  object_ = attach->object;
  const World world = first_world(task);
  const auto pose = world.poses.find(object_);
  if (pose == world.poses.end()) return;
  X_WO_ = pose->second;
  if (database == nullptr) return;
  const auto found = database->find(kTaskRows, std::array{key()}, kFarthestSquared, kMostRows);
  if (!found) return;
  const auto joints = as_index(task.robot.joint_count());
  for (const KeyMatch& match : *found) {
    const RememberedPath& path = match.experience->path();
    if (path.waypoints.size() != groups_ * joints) continue;
    const std::vector<double>& at = match.experience->key;
    const Vec3 turn = Vec3(at[6], at[7], at[8]) / kMetresPerRadian;
    Row row;
    row.X_WO.translation = {at[3], at[4], at[5]};
    if (turn.norm() > 0) row.X_WO.rotation = rotation_about(turn.normalized(), turn.norm());
    for (auto q = path.waypoints.begin(); q != path.waypoints.end();
         q += static_cast<std::ptrdiff_t>(joints)) {
      row.anchors.emplace_back(q, q + static_cast<std::ptrdiff_t>(joints));
    }
    rows_.push_back(std::move(row));
  }
}

std::vector<double> TaskMemory::key() const {
  // Two names rarely share both numbers, and names that differ are at least 1 apart.
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : object_) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  const Vec3 turn = kMetresPerRadian * rotation_vector(X_WO_.rotation);
  const Vec3& p = X_WO_.translation;
  std::vector<double> key{static_cast<double>(hash % 10007),
                          static_cast<double>(hash / 10007 % 10009),
                          static_cast<double>(groups_),
                          p.x(),
                          p.y(),
                          p.z(),
                          turn.x(),
                          turn.y(),
                          turn.z()};
  key.resize(kKeySize);
  return key;
}

Remembered TaskMemory::rank(std::size_t group, const World& world,
                            const std::vector<Transform>& targets, std::size_t first,
                            const std::string& link) const {
  Remembered remembered;
  const auto object = world.poses.find(object_);
  for (const Row& row : rows_) {
    const Configuration& q = row.anchors[group];
    const Transform then = world.robot.link_poses(q)[as_index(*world.robot.find_link(link))];
    // Free: relative to the object. Held: where the object goes.
    const Transform now =
        object == world.poses.end() ? then : object->second * row.X_WO.inverse() * then;
    std::vector<std::pair<double, int>> ranked;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      ranked.emplace_back(difference(now, targets[i]), static_cast<int>(first + i));
    }
    const std::size_t kept = std::min(kRankedPerRow, ranked.size());
    std::ranges::partial_sort(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(kept));
    for (std::size_t i = 0; i < kept; ++i) remembered.emplace_back(ranked[i].second, q);
  }
  return remembered;
}

Result<bool> TaskMemory::remember(const std::vector<Configuration>& anchors,
                                  const std::string& name) const {
  if (database_ == nullptr || object_.empty()) return false;
  RememberedPath path;
  path.joint_count = task_.robot.joint_count();
  for (const Configuration& q : anchors)
    path.waypoints.insert(path.waypoints.end(), q.begin(), q.end());
  auto rows = new_row(kTaskRows, key(), std::move(path), provenance_of("solved task " + name, 0));
  return database_->insert_later(std::move(rows)).map([] { return true; });
}

}  // namespace mneme::internal
