// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/arms.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace mneme::internal {
namespace {

constexpr double kJoined = 1e-6;  // metres

Point flat(const Vec3& p) { return {p.x(), p.y()}; }

void append_segment(const Point& a, const Point& b, double radius, Arm& arm) {
  const bool is_joined = !arm.empty() && std::hypot(arm.back().points.back().x - a.x,
                                                    arm.back().points.back().y - a.y) < kJoined;
  if (!is_joined) arm.push_back({{a}, radius});
  arm.back().points.push_back(b);
  arm.back().radius = std::max(arm.back().radius, radius);
}

}  // namespace

Arm arm_at(const Robot& robot, std::span<const double> q) {
  Arm arm;
  Arm dots;
  const std::vector<Transform> poses = robot.link_poses(q);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Capsule& capsule : robot.links()[i].capsules) {
      append_segment(flat(poses[i] * capsule.a), flat(poses[i] * capsule.b), capsule.radius, arm);
    }
    for (const Sphere& sphere : robot.links()[i].spheres) {
      dots.push_back({{flat(poses[i] * sphere.center)}, sphere.radius});
    }
  }
  arm.insert(arm.end(), dots.begin(), dots.end());
  return arm;
}

std::vector<Configuration> spread_along(const Robot& robot, const Path& path, int count) {
  std::vector<double> passed = {0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    passed.push_back(passed.back() + robot.distance(path[i - 1], path[i]));
  }
  std::vector<Configuration> spread;
  std::size_t motion = 1;
  for (int k = 0; k < count; ++k) {
    const double distance = passed.back() * k / (count - 1);
    while (motion + 1 < path.size() && passed[motion] < distance) ++motion;
    if (passed.back() <= 0) {
      spread.push_back(path.front());
      continue;
    }
    const double length = passed[motion] - passed[motion - 1];
    const double fraction = length > 0 ? (distance - passed[motion - 1]) / length : 0;
    const Configuration delta = robot.difference(path[motion - 1], path[motion]);
    Configuration q = path[motion - 1];
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += fraction * delta[i];
    spread.push_back(std::move(q));
  }
  return spread;
}

std::vector<int> choose_components(const GaussianMixture& mixture, int limit) {
  std::map<Origin, std::vector<int>> by_origin;
  for (int i = 0; i < mixture.component_count(); ++i) {
    const auto position = static_cast<std::size_t>(i);
    by_origin[mixture.origins.empty() ? 0 : mixture.origins[position]].push_back(i);
  }
  std::vector<std::vector<int>> sources;
  for (auto& [origin, components] : by_origin) sources.push_back(std::move(components));
  // Small sources first: what they leave of their share goes to the larger ones.
  std::ranges::stable_sort(sources, {}, &std::vector<int>::size);
  std::vector<int> chosen;
  int left = std::max(0, limit);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto size = static_cast<int>(sources[i].size());
    const int share = std::min(size, left / static_cast<int>(sources.size() - i));
    for (int k = 0; k < share; ++k) {
      const std::int64_t place = std::int64_t{k} * size / share;
      chosen.push_back(sources[i][static_cast<std::size_t>(place)]);
    }
    left -= share;
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace mneme::internal
