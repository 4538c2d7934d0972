// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which joints carry a link, and what moves them.
#pragma once

#include "mneme/robot.h"

#include <optional>
#include <vector>

namespace mneme::internal {

/// Those that carry the link, from it to the root.
[[nodiscard]] std::vector<int> joints_to(const Robot& robot, int link);

/// A joint's value is `rate` times that of a joint of the group, and `offset`.
struct Drive {
  int joint = 0;  ///< of the group
  double rate = 1, offset = 0;
};
/// Nothing if the joint stays at its fixed value, as one does that follows another at rate 0.
[[nodiscard]] std::optional<Drive> find_drive(const Robot& robot, int joint);

}  // namespace mneme::internal
