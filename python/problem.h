// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme.Problem: shares its scene, so that edits of the scene take effect.
#pragma once

#include "mneme/problem.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mneme::python {

/// Transforms goals to the frame of the robot's root link, with their frames as at `q`. Raises a
/// mneme.Error that begins with `what` for invalid goals.
void place_goals(std::vector<PoseGoal>& goals, const Robot& robot, const Configuration& q,
                 const std::string& what);

class SharedProblem {
 public:
  explicit SharedProblem(Problem problem)
      : scene_(std::make_shared<Scene>(std::move(problem.scene))), rest_(std::move(problem)) {}
  SharedProblem(Problem problem, std::shared_ptr<Scene> scene)
      : scene_(std::move(scene)), rest_(std::move(problem)) {}

  [[nodiscard]] const std::shared_ptr<Scene>& scene() const { return scene_; }
  /// The problem without its scene.
  [[nodiscard]] const Problem& rest() const { return rest_; }
  [[nodiscard]] Problem& rest() { return rest_; }
  /// Returns a copy, for use without the interpreter lock.
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
