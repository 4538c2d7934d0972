// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// An own robot, scene, start and goal: an arm of three links passes a post.
#include "mneme/mneme.h"

#include <cstdio>

namespace {

constexpr const char* kArm = R"(<robot name="arm3">
  <link name="base"/>
  <link name="turret"><collision><geometry><sphere radius="0.06"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.25"/>
    <geometry><capsule radius="0.05" length="0.5"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0 0 0.2"/>
    <geometry><capsule radius="0.04" length="0.4"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="turret"/>
    <origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>
  <joint name="shoulder" type="revolute"><parent link="turret"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-2.5" upper="2.5"/></joint>
</robot>)";

int fail_with(const mneme::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main() {
  const auto robot = mneme::parse_robot(kArm, "arm3");
  if (!robot) return fail_with(robot.error());
  mneme::Box post;
  post.pose.translation = {0.6, 0, 0.4};
  post.half_extents = {0.05, 0.05, 0.4};
  const mneme::Scene scene{"post", {{"post", {post}}}};
  const mneme::Problem problem{.name = "arm3",
                               .robot = *robot,
                               .scene = scene,
                               .start = {-1, 1.2, 0.3},
                               .goals = {{1, 1.2, 0.3}}};

  const auto result = mneme::solve(problem, nullptr, {});
  if (!result) return fail_with(result.error());
  if (!result->plan.is_solved()) return std::puts(result->plan.message.c_str()), 3;
  std::printf("arm3: %zu configurations, length %.3f\n", result->plan.path.size(),
              mneme::path_length(*robot, result->plan.path));
  return 0;
}
