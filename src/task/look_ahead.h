// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tests whether a grasp suits any pose at which the next group wants the object.
#pragma once

#include "line/floating_body.h"
#include "task/follow.h"
#include "task/groups.h"
#include "task/reach.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// Poses where the next group wants the object that a group attaches.
class LookAhead {
 public:
  /// `world` is that in which `group` brings `link` to its poses. Nothing if the poses of `next`
  /// say nothing about them.
  [[nodiscard]] static std::optional<LookAhead> make(TaskRun& run, const Group& group,
                                                     const Group& next, const World& world,
                                                     const std::string& link);

  /// Returns why the link fits at no pose of the next group if it takes the object at `X_WL`;
  /// nothing if it may fit. Bodies are named only if `has_reason`, which costs more than the test.
  [[nodiscard]] std::optional<Failure> find_failure(TaskRun& run, const Transform& X_WL,
                                                    bool has_reason) const;

 private:
  LookAhead(Transform X_OW, Reach reach) : X_OW_(X_OW), reach_(reach) {}
  void drop_blocked(TaskRun& run, const World& world, const std::string& object);

  Transform X_OW_;
  Reach reach_;                    ///< of the link
  std::vector<Transform> places_;  ///< of the object; those where it is free
  std::optional<FloatingBody> hand_;
  std::string link_, stage_;  ///< names of the link, and of the stage that wants the object
  std::string what_;          ///< what the object touches, where it is not free
};

}  // namespace mneme::internal
