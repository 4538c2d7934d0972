// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A robot with nothing around it, where every corner can be rounded.
#pragma once

#include "mneme/path.h"

namespace mneme::test {

class EmptyScene {
 public:
  explicit EmptyScene(const Robot& robot)
      : checker_(CollisionChecker::make(robot, {}).value()),
        verifier_(checker_, Verification::none) {}
  EmptyScene(const EmptyScene&) = delete;
  EmptyScene& operator=(const EmptyScene&) = delete;

  [[nodiscard]] const Robot& robot() const { return checker_.robot(); }
  [[nodiscard]] const MotionVerifier& verifier() const { return verifier_; }

 private:
  CollisionChecker checker_;
  MotionVerifier verifier_;
};

}  // namespace mneme::test
