// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/space.h"

#include "base/utf8.h"
#include 

#include <fmt/format.h>

namespace mneme {
namespace internal {

std::string describe(const ExperienceSpace& space) {
  return fmt::format("robot '{}' (hash {}, {} joints, decomposer {}, keys of {})", space.robot_name,
                     space.robot_hash, space.joint_count, space.decomposer, space.key_size);
}

bool is_same_space(const ExperienceSpace& a, const ExperienceSpace& b) {
  return a.robot_hash == b.robot_hash && a.decomposer == b.decomposer &&
         a.joint_count == b.joint_count && a.key_size == b.key_size;
}

tl::unexpected<Error> refuse_space(const std::string& url, const ExperienceSpace& found,
                                   const ExperienceSpace& wanted) {
  return fail(ErrorCode::wrong_robot, fmt::format("{}: holds experience of {}; expected that of {}",
                                                  url, describe(found), describe(wanted)));
}

}  // namespace internal

Result<ExperienceSpace> make_space(const Robot& robot, const std::string& decomposer) {
  const std::string& name = decomposer.empty() ? default_decomposer(robot) : decomposer;
  return internal::find_decomposer(name).map([&](const internal::Decomposer* found) {
    const bool is_of_robot = found->key_size == internal::kSizeOfRobot;
    return ExperienceSpace{internal::storable_text(robot.name()), robot.hash(),
                           std::string(found->version), robot.joint_count(),
                           is_of_robot ? query_key_size(robot) : found->key_size};
  });
}

}  // namespace mneme
