// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tasks of a Panda at a table with a cup.
#pragma once

#include "mneme/task_file.h"

#include "support/support.h"

#include <string>

namespace mneme::test {

inline const std::string kCell = R"(robot: panda
start: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
scene:
  obstacles:
    - {name: table, type: box, position: [0.5, 0, 0.1], size: [0.6, 0.8, 0.2]}
    - {name: cup, type: cylinder, position: [0.5, -0.1, 0.2505], radius: 0.035, length: 0.1}
)";

/// Takes the cup by one of 30 grasps and puts it down at one of 12 places.
inline const std::string kPickAndPlace = R"(stages:
  - {name: reach, move: next}
  - name: approach
    line:
      direction: [0, 0, 1]
      along: panda_hand
      distance: 0.08
      to:
        frame: cup
        position: [-0.115, 0, 0]
        quat_xyzw: [0, 0.70710678, 0, 0.70710678]
        vary:
          - {turn: z, from: -3, to: 3, count: 10}
          - {shift: z, from: 0, to: 0.03, count: 3}
  - {name: grasp, attach: cup}
  - {name: lift, line: {direction: [0, 0, 1], distance: 0.1}}
  - {name: carry, move: next}
  - name: lower
    line:
      direction: [0, 0, -1]
      distance: 0.08
      to:
        object: cup
        position: [0.45, 0.2, 0.2505]
        vary:
          - {shift: x, from: -0.1, to: 0.1, count: 4}
          - {shift: y, from: -0.1, to: 0.1, count: 3}
  - {name: release, detach: cup}
  - {name: retreat, line: {direction: [0, 0, -1], along: panda_hand, distance: 0.08}}
  - {name: home, move: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]}
)";

/// A box on a table between two walls: height of its middle, and where the middles of the walls
/// are.
inline const std::string kTray = R"(robot: panda
start: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
scene:
  obstacles:
    - {{name: table, type: box, position: [0.5, 0, 0.1], size: [0.6, 0.8, 0.2]}}
    - {{name: box, type: box, position: [0.5, -0.1, {}], size: [0.04, 0.06, 0.1]}}
    - {{name: left, type: box, position: [0.5, {}, 0.215], size: [0.06, 0.02, 0.03]}}
    - {{name: right, type: box, position: [0.5, {}, 0.215], size: [0.06, 0.02, 0.03]}}
)";

/// Takes the box from above and lifts it.
inline const std::string kLiftBox = R"(stages:
  - {name: reach, move: next}
  - name: approach
    line:
      direction: [0, 0, 1]
      along: panda_hand
      distance: 0.08
      to:
        frame: box
        position: [0, 0, 0.135]
        quat_xyzw: [1, 0, 0, 0]
        vary: [{turn: z, from: -3, to: 3, count: 20}]
  - {name: grasp, attach: box}
  - {name: lift, line: {direction: [0, 0, 1], distance: 0.1}}
)";

inline Result<Task> try_task(const std::string& yaml) {
  const TemporaryDirectory directory;
  write_file(directory / "task.yaml", yaml);
  return load_task(directory / "task.yaml");
}

inline Task make_task(const std::string& yaml) { return require(try_task(yaml)); }

/// The message of the failure without the file's name.
inline std::string load_failure(const std::string& stages) {
  const Error error = require_error(try_task(kCell + stages));
  const std::string& message = error.message;
  return message.substr(message.find("task.yaml") + 9);
}

inline TaskResult solved(const Task& task, Database* database = nullptr,
                         const TaskSettings& settings = {}) {
  return require(solve_task(task, database, settings));
}

/// `text` with `from` replaced once.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// Checks by exact distances that each stage begins where the one before ends, and is free.
inline void check_plan(const Task& task, const TaskResult& result) {
  REQUIRE_MESSAGE(result.is_solved(), result.message);
  REQUIRE(result.stages.size() == task.stages.size());
  Configuration at = task.start;
  for (const StageResult& stage : result.stages) {
    INFO(stage.name);
    REQUIRE_FALSE(stage.path.empty());
    CHECK(task.robot.distance(at, stage.path.front()) < 1e-6);
    CHECK(is_path_free(stage.world->robot, stage.world->scene, stage.path, 0.005,
                       end_tolerances(SolveSettings())));
    if (stage.gripper) {
      const Problem& moving = *stage.gripper->world;
      CHECK(is_path_free(moving.robot, moving.scene, stage.gripper->path, 1e-3,
                         end_tolerances(SolveSettings())));
    }
    at = stage.path.back();
  }
}

}  // namespace mneme::test
