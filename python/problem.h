// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a problem is to Python: it shares its scene, so that no edit of it is lost.
#pragma once

#include "mneme/problem.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mneme::python {

/// Brings the poses into the frame of the robot's root link, by where their frames are at `q`.
/// Raises a mneme.Error that begins with `what` for what the robot cannot be asked for.
void place_goals(std::vector<PoseGoal>& goals, const Robot& robot, const Configuration& q,
                 const std::string& what);

class SharedProblem {
 public:
  explicit SharedProblem(Problem problem)
      : scene_(std::make_shared<Scene>(std::move(problem.scene))), rest_(std::move(problem)) {}
  SharedProblem(Problem problem, std::shared_ptr<Scene> scene)
      : scene_(std::move(scene)), rest_(std::move(problem)) {}

  [[nodiscard]] const std::shared_ptr<Scene>& scene() const { return scene_; }
  /// All but the scene.
  [[nodiscard]] const Problem& rest() const { return rest_; }
  [[nodiscard]] Problem& rest() { return rest_; }
  /// As it is now: of its own, so that it may be used without the interpreter's lock.
  [[nodiscard]] Problem get() const {
    Problem problem = rest_;
    problem.scene = *scene_;
    return problem;
  }

 private:
  std::shared_ptr<Scene> scene_;
  Problem rest_;
};

}  // namespace mneme::python
