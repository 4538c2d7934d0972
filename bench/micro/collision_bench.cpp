// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "micro/suite.h"

#include <memory>

namespace mneme::bench {
namespace {

/// A problem's checker with an instruction set, and the motions to check.
struct Case {
  CollisionChecker checker;
  const Motions* motions = nullptr;
};
using Cases = std::shared_ptr<const std::vector<Case>>;

Cases make_cases(const std::vector<Edges>& recorded, Motions Edges::*motions, Isa isa) {
  auto cases = std::make_shared<std::vector<Case>>();
  for (const Edges& edges : recorded) {
    auto checker = CollisionChecker::make(edges.problem.robot, edges.problem.scene, {.isa = isa});
    if (checker) cases->push_back({std::move(*checker), &(edges.*motions)});
  }
  return cases;
}

CheckCounters check_motions(const std::vector<Case>& cases) {
  CheckCounters counters;
  for (const Case& entry : cases) {
    const auto joints = static_cast<std::size_t>(entry.checker.robot().joint_count());
    const std::span<const float> from = entry.motions->from, to = entry.motions->to;
    for (std::size_t i = 0; i < from.size(); i += joints) {
      benchmark::DoNotOptimize(
          entry.checker.is_motion_valid(from.subspan(i, joints), to.subspan(i, joints), counters));
    }
  }
  return counters;
}

std::uint64_t check_states(const std::vector<Case>& cases, std::vector<std::uint8_t>& is_valid) {
  std::uint64_t states = 0;
  for (const Case& entry : cases) {
    is_valid.resize(entry.motions->to.size() /
                    static_cast<std::size_t>(entry.checker.robot().joint_count()));
    entry.checker.check_states(entry.motions->to, is_valid);
    states += is_valid.size();
  }
  return states;
}

/// The robot with all pairs of links allowed to touch: what is left is kinematics.
Result<Robot> without_pairs(const Problem& problem) {
  const Robot& robot = problem.robot;
  RobotOptions options;
  for (int i = 0; i < robot.joint_count(); ++i) options.joints.push_back(robot.group_joint(i).name);
  for (const auto& [a, b] : robot.self_pairs()) {
    options.allowed_pairs.emplace_back(robot.links()[static_cast<std::size_t>(a)].name,
                                       robot.links()[static_cast<std::size_t>(b)].name);
  }
  return load_robot(problem.robot_path, options);
}

void register_kinematics(const std::vector<Edges>& recorded) {
  const auto robot = without_pairs(recorded.front().problem);
  if (!robot) return;
  for (const Isa isa : measured_isas()) {
    auto cases = std::make_shared<std::vector<Case>>();
    for (const Edges& edges : recorded) {
      auto checker = CollisionChecker::make(*robot, {}, {.isa = isa});
      if (checker) cases->push_back({std::move(*checker), &edges.valid});
    }
    register_repeated("kinematics/" + std::string(to_string(isa)), "state",
                      [cases] { return check_motions(*cases).states; });
  }
}

}  // namespace

void register_collision(const std::vector<Edges>& recorded) {
  for (const Isa isa : measured_isas()) {
    const std::string name(to_string(isa));
    const Cases valid = make_cases(recorded, &Edges::valid, isa);
    const Cases invalid = make_cases(recorded, &Edges::invalid, isa);
    register_repeated("valid_motions/" + name, "state",
                      [valid] { return check_motions(*valid).states; });
    register_repeated("invalid_motions/" + name, "motion",
                      [invalid] { return check_motions(*invalid).motions; });
    register_repeated("batches/" + name, "state",
                      [valid, is_valid = std::vector<std::uint8_t>()]() mutable {
                        return check_states(*valid, is_valid);
                      });
  }
  register_kinematics(recorded);
}

}  // namespace mneme::bench
