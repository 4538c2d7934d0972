// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A planning scene and a request for the lifter of small_robots.h, as files.
#pragma once

#include "problem/small_robots.h"
#include "support/support.h"

namespace mneme::test {

/// A ball at [0, 1, 0] of "base", which is at [-1, 0, 0.5] of the root link "world".
inline const std::string kMoveitScene = R"(name: ""
robot_model_name: lifter
world:
  collision_objects:
    - id: ball
      header: {frame_id: base}
      primitives: [{type: sphere, dimensions: [0.1]}]
      primitive_poses: [{position: [0, 1, 0], orientation: [0, 0, 0, 1]}]
robot_state:
  joint_state: {name: [lift, turn, grip], position: [0.1, 0.2, 0.03]}
)";
inline const std::string kMoveitRequest = R"(start_state:
  joint_state: {name: [turn], position: [0.5]}
goal_constraints:
  - joint_constraints:
      - {joint_name: turn, position: 1, tolerance_above: 0.2, tolerance_below: 0.1, weight: 1}
      - {joint_name: lift, position: 0.75}
)";

/// scene0001.yaml, request0001.yaml and lifter.urdf; the joints lift and turn are planned for.
class MoveitFiles {
 public:
  explicit MoveitFiles(const std::string& scene = kMoveitScene,
                       const std::string& request = kMoveitRequest) {
    write_file(directory_ / "lifter.urdf", kLiftUrdf);
    write_file(directory_ / "scene0001.yaml", scene);
    write_file(directory_ / "request0001.yaml", request);
    options.robot_path = directory_ / "lifter.urdf";
    options.robot.joints = {"lift", "turn"};
  }

  [[nodiscard]] std::string operator/(const std::string& name) const { return directory_ / name; }
  [[nodiscard]] Result<Problem> load() const {
    return load_problem(directory_ / "request0001.yaml", options);
  }
  /// The message of the failure without the directory.
  [[nodiscard]] std::string failure() const {
    const Error error = require_error(load());
    std::string message = error.message;
    const std::string prefix = directory_ / "";
    for (std::size_t at = message.find(prefix); at != std::string::npos;
         at = message.find(prefix)) {
      message.erase(at, prefix.size());
    }
    return message;
  }

  ProblemOptions options;

 private:
  TemporaryDirectory directory_;
};

}  // namespace mneme::test
