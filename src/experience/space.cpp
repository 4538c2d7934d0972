// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "primitive/decomposers.h"

namespace mneme {

Result<ExperienceSpace> make_space(const Robot& robot, const std::string& decomposer) {
  return internal::find_decomposer(decomposer).map([&](const internal::Decomposer* found) {
    return ExperienceSpace{robot.name(), robot.hash(), std::string(found->version),
                           robot.joint_count(), found->key_size};
  });
}

}  // namespace mneme
