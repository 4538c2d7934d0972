// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Pairs of names that may touch: links, attached objects and obstacles.
#pragma once

#include "mneme/robot.h"
#include "mneme/scene.h"

#include "scene/input.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Takes each pair to where it counts: an obstacle, an attached object, or two links of the robot.
class AllowedContacts {
 public:
  /// Refers to its arguments.
  AllowedContacts(const Robot& robot, std::vector<AttachedObject>& attached, Scene& scene)
      : robot_(robot), attached_(attached), scene_(scene) {}

  /// What is wrong with the pair, or nothing. A name that a link and an obstacle share is that of
  /// the link where it stands first, that of the obstacle where it stands second.
  [[nodiscard]] std::optional<std::string> allow(const std::string& first,
                                                 const std::string& second);
  /// Whether a link, an attached object or an obstacle has this name.
  [[nodiscard]] bool knows(const std::string& name) const;
  /// Those of two links, for RobotOptions.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& link_pairs() const {
    return link_pairs_;
  }

 private:
  [[nodiscard]] bool is_carried(const std::string& name) const;
  [[nodiscard]] AttachedObject* find_attached(const std::string& name) const;

  const Robot& robot_;
  std::vector<AttachedObject>& attached_;
  Scene& scene_;
  std::vector<std::pair<std::string, std::string>> link_pairs_;
};

/// Takes the pairs of the key `allow`, if `problem` has it. Throws InputFailure.
void read_allowed(const Input& problem, AllowedContacts& contacts);

/// The same without a robot: pairs of an obstacle and a name that is none of the attached objects'.
/// A name that stands first may be that of an obstacle though a link has it, too.
void read_allowed(const Input& problem, Scene& scene);

}  // namespace mneme::internal
