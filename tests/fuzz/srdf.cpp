// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "fuzz/fuzz_input.h"
#include "robot/srdf.h"

namespace {

mneme::Robot::Parts arm() {
  auto parts = mneme::parse_robot_parts(R"(<robot name="arm">
    <link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <link name="upper"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <link name="hand"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/></joint>
    <joint name="wrist" type="continuous"><parent link="upper"/><child link="hand"/></joint>
    </robot>)",
                                        "arm.urdf");
  if (!parts) std::abort();
  return *std::move(parts);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const mneme::Robot::Parts bare = arm();
  mneme::Robot::Parts parts = bare;
  const auto text = mneme::fuzz::as_text(data, size);
  if (mneme::internal::apply_srdf(text, "fuzz.srdf", parts)) return 0;
  (void)mneme::to_srdf(parts);
  mneme::fuzz::expect_message(mneme::make_robot(std::move(parts)));
  return 0;
}
