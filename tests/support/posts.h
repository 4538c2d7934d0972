// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/support.h"

namespace mneme::test {

/// An arm that turns about z and bends, between two posts; four problems in one compact file.
struct Posts {
  Posts() {
    write_file(directory / "bender.urdf", R"(<robot name="bender">
  <link name="base"/>
  <link name="upper"><collision><origin xyz="0.25 0 0" rpy="0 1.5708 0"/>
    <geometry><capsule radius="0.03" length="0.4"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0.2 0 0" rpy="0 1.5708 0"/>
    <geometry><capsule radius="0.03" length="0.3"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <origin xyz="0 0 0.3"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/>
    <origin xyz="0.5 0 0"/><limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>
</robot>
)");
    std::string problems;
    for (int i = 0; i < 4; ++i) {
      const std::string q = std::to_string(0.02 * i);
      problems +=
          std::string(i == 0 ? "" : ",") + R"({"index":)" + std::to_string(i) + R"(,"start":[)" +
          q + R"(,0],"goal":[1.6,0.1],"obstacles":[)" +
          R"({"name":"left","type":"box","p":[0.8,0.15,0.3],"q":[1,0,0,0],"size":[0.1,0.1,0.6]},)" +
          R"({"name":"right","type":"box","p":[0.8,-0.15,0.3],"q":[1,0,0,0],"size":[0.1,0.1,0.6]}]})";
    }
    write_file(directory / "posts.json",
               R"({"robot":"bender","frame":"base","joints":["turn","bend"],"problems":[)" +
                   problems + "]}");
  }

  [[nodiscard]] std::string robot() const { return directory / "bender.urdf"; }
  [[nodiscard]] std::string problems() const { return directory / "posts.json"; }

  TemporaryDirectory directory;
};

}  // namespace mneme::test
