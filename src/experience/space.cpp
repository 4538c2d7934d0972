// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/space.h"

#include "base/utf8.h"

#include <fmt/format.h>

namespace mneme {
namespace internal {

std::string describe(const ExperienceSpace& space) {
  return fmt::format("robot '{}' (hash {}, {} joints)", space.robot_name, space.robot_hash,
                     space.joint_count);
}

bool is_same_space(const ExperienceSpace& a, const ExperienceSpace& b) {
  return a.robot_hash == b.robot_hash && a.joint_count == b.joint_count;
}

tl::unexpected<Error> refuse_space(const std::string& url, const ExperienceSpace& found,
                                   const ExperienceSpace& wanted) {
  return fail(ErrorCode::wrong_robot, fmt::format("{}: holds experience of {}; expected that of {}",
                                                  url, describe(found), describe(wanted)));
}

}  // namespace internal

ExperienceSpace make_space(const Robot& robot) {
  return {internal::storable_text(robot.name()), robot.hash(), robot.joint_count()};
}

}  // namespace mneme
