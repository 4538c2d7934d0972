// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto parts = mneme::parse_robot_parts(mneme::fuzz::as_text(data, size), "fuzz.urdf");
  mneme::fuzz::expect_message(parts);
  if (!parts) return 0;
  // Parts that were read can be written and read back.
  const std::string text = mneme::to_urdf(*parts);
  const auto again = mneme::parse_robot_parts(text, "again.urdf");
  if (!again || again->links.size() != parts->links.size()) std::abort();
  const auto robot = mneme::make_robot(*std::move(parts));
  mneme::fuzz::expect_message(robot);
  if (!robot) return 0;
  const mneme::Configuration q(static_cast<std::size_t>(robot->joint_count()), 0.0);
  (void)robot->link_poses(robot->normalized(q));
  return 0;
}
