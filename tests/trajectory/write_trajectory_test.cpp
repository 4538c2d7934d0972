// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "input/input.h"
#include "support/support.h"

#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

Robot arm(const std::string& name) {
  Robot::Parts parts;
  parts.name = "arm";
  parts.links = {{.name = "base"}, {.name = "tool"}};
  Joint joint;
  joint.name = name;
  joint.type = JointType::continuous;
  joint.parent_link = 0;
  joint.child_link = 1;
  parts.joints = {joint};
  return make_robot(parts).value();
}

const std::vector<Trajectory::Point> kPoints = {{0, {0.1}, {0}, {2}},
                                                {1.0000000004, {-0.25}, {0.5}, {-1e-7}}};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("CSV has a header and a row for each point") {
    CHECK(to_csv(arm("j"), kPoints) ==
          "time,j.position,j.velocity,j.acceleration\n0,0.1,0,2\n"
          "1.0000000004,-0.25,0.5,-1e-07\n");
    CHECK(to_csv(arm("a,\"b"), {}) ==
          "time,\"a,\"\"b.position\",\"a,\"\"b.velocity\",\"a,\"\"b.acceleration\"\n");
  }

  TEST_CASE("the name of a stage ends no comment") {
    const auto comment_of = [](const std::string& name) {
      const std::string text = to_yaml(arm("j"), kPoints, {{{name, 0.5}}});
      return text.substr(0, text.find('\n'));
    };
    const std::string begin = "# stage from 0.500000 s: ";
    CHECK(comment_of("lift #1: \"up\"") == begin + "lift #1: \"up\"");
    CHECK(comment_of("a\rpoints: []\nb") == begin + "\"a\\rpoints: []\\nb\"");
    // Line ends of YAML 1.1: U+0085, U+2028, U+2029.
    CHECK(comment_of("a\xc2\x85z") == begin + "\"a\\u0085z\"");
    CHECK(comment_of("a\xe2\x80\xa8z") == begin + "\"a\\u2028z\"");
    CHECK(comment_of("a\xe2\x80\xa9z") == begin + "\"a\\u2029z\"");
    CHECK(comment_of("a\xff") == begin + "\"a\\ufffd\"");
  }

  TEST_CASE("YAML has the fields of trajectory_msgs/JointTrajectory") {
    for (const std::string name : {"j", "1", "a: b", "null"}) {
      CAPTURE(name);
      const std::string text = to_yaml(arm(name), kPoints);
      const internal::InputValue value = internal::parse_yaml(text, name);
      const internal::Input input(value, name);
      input.allow_keys({"header", "joint_names", "points"});
      CHECK(input.at("header").at("stamp").at("sec").number() == 0);
      CHECK(input.at("header").at("frame_id").text().empty());
      REQUIRE(input.at("joint_names").items().size() == 1);
      CHECK(input.at("joint_names").items()[0].text() == name);
      const auto points = input.at("points").items();
      REQUIRE(points.size() == 2);
      points[1].allow_keys(
          {"positions", "velocities", "accelerations", "effort", "time_from_start"});
      CHECK(points[1].at("positions").numbers() == Configuration{-0.25});
      CHECK(points[1].at("velocities").numbers() == Configuration{0.5});
      CHECK(points[1].at("accelerations").numbers() == Configuration{-1e-7});
      CHECK(points[1].at("time_from_start").at("sec").number() == 1);
      CHECK(points[1].at("time_from_start").at("nanosec").number() == 0);
    }
  }

  TEST_CASE("JSON has the same numbers") {
    const auto json = nlohmann::json::parse(to_json(arm("j"), kPoints));
    CHECK(json["format"] == "mneme-trajectory");
    CHECK(json["version"] == 1);
    CHECK(json["robot"] == "arm");
    CHECK(json["joints"] == std::vector<std::string>{"j"});
    CHECK(json["duration_s"] == 1.0000000004);
    CHECK(json["times"] == std::vector<double>{0, 1.0000000004});
    CHECK(json["positions"] == std::vector<std::vector<double>>{{0.1}, {-0.25}});
    CHECK(json["velocities"] == std::vector<std::vector<double>>{{0}, {0.5}});
    CHECK(json["accelerations"] == std::vector<std::vector<double>>{{2}, {-1e-7}});
  }
}

}  // namespace mneme::test
