// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planar and floating joints: the names of their values, and the poses that these describe.
#pragma once

#include "mneme/robot.h"

#include <map>
#include <span>
#include <string>

namespace mneme::internal {

/// Returns the values of `pose` by name, as RobotOptions::fixed_values names them. Precondition:
/// `joint` is planar or floating.
[[nodiscard]] std::map<std::string, double> held_values(const Joint& joint, const Transform& pose);

/// Moves planar and floating joints to the poses that `values` describe and removes these values.
/// Values that are not given are those of the joint's present pose. Errors: a value that is not
/// finite, a quaternion that is not of length 1.
[[nodiscard]] Result<void> hold_joints(std::span<Joint> joints,
                                       std::map<std::string, double>& values);

}  // namespace mneme::internal
