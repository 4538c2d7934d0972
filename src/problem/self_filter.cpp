// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "base/threads.h"
#include "check/link_distances.h"
#include "problem/problem_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

namespace mneme {
namespace {

using internal::LinkDistances;
using internal::ObstacleShape;
using internal::PosedLinks;

/// The robot at one configuration.
class Body {
 public:
  Body(const Robot& robot, std::span<const double> q)
      : links_(robot), posed_(links_.posed(robot.link_poses(q))) {}

  [[nodiscard]] bool is_nearer(const Sphere& ball, double distance) const {
    const Shape shape = ball;
    const ObstacleShape other{0, &shape, ball};
    for (int link = 0; link < links_.link_count(); ++link) {
      if (links_.between(posed_, link, other, distance) < distance) return true;
    }
    return false;
  }

 private:
  LinkDistances links_;
  PosedLinks posed_;
};

/// Removes points nearer than `distance`, unless that is all. Returns the number of the others.
std::size_t drop_near(const Body& body, double distance, PointCloud& cloud) {
  constexpr std::size_t kPointsPerPoll = 256;
  const std::vector<CloudPoint>& all = cloud.parts->list();
  std::vector<CloudPoint> rest;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % kPointsPerPoll == 0) internal::poll_interrupt();
    const CloudPoint& p = all[i];
    const Vec3 center = cloud.pose * Vec3(p[0], p[1], p[2]);
    if (!body.is_nearer({center, cloud.radius}, distance)) rest.push_back(p);
  }
  const std::size_t left = rest.size();
  if (left > 0 && left < all.size()) {
    cloud.parts = std::make_shared<Parts<CloudPoint>>(std::move(rest));
  }
  return left;
}

}  // namespace

Result<std::vector<std::string>> drop_own_points(Scene& scene, const Robot& robot,
                                                 std::span<const double> q, double distance) {
  if (!(distance >= 0 && std::isfinite(distance))) {
    return fail(ErrorCode::invalid, "self_filter: expected 0 or more metres, got {}", distance);
  }
  if (const auto violation = robot.describe_violation(q, "self_filter")) {
    return fail(ErrorCode::invalid, *violation);
  }
  const Body body(robot, q);
  Scene filtered = scene;  // clouds are shared; an interrupt leaves the scene as it was
  std::vector<std::string> notes;
  for (Obstacle& obstacle : filtered.obstacles) {
    std::size_t dropped = 0;
    std::size_t total = 0;
    std::erase_if(obstacle.shapes, [&](Shape& shape) {
      auto* cloud = std::get_if<PointCloud>(&shape);
      if (cloud == nullptr) return false;
      const std::size_t count = cloud->parts->list().size();
      const std::size_t left = drop_near(body, distance, *cloud);
      total += count;
      dropped += count - left;
      return left == 0;
    });
    if (dropped == 0) continue;
    notes.push_back(fmt::format(
        "obstacle {}: {} of {} points are nearer than {} m to the robot's spheres and ignored",
        obstacle.name, dropped, total, distance));
  }
  std::vector<std::string> empty;
  for (const Obstacle& obstacle : filtered.obstacles) {
    if (obstacle.shapes.empty()) empty.push_back(obstacle.name);
  }
  for (const std::string& name : empty) MNEME_TRY(filtered.remove(name));
  scene = std::move(filtered);
  return notes;
}

}  // namespace mneme

namespace mneme::internal {

std::optional<double> read_self_filter(const Input& problem, const ProblemOptions& options) {
  if (options.self_filter) return options.self_filter;
  const auto input = problem.find("self_filter");
  if (!input) return std::nullopt;
  const double distance = input->finite_number();
  if (distance < 0) input->fail_expecting("0 or more metres");
  return distance;
}

std::vector<std::string> filter_own_points(std::optional<double> distance, const Robot& robot,
                                           const Configuration& start, Scene& scene) {
  if (!distance || !robot.is_configuration(start)) return {};
  return value_or_throw(drop_own_points(scene, robot, start, *distance));
}

}  // namespace mneme::internal
