// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "base/text.h"
#include "input/input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>

namespace mneme {
namespace {

using Point = Trajectory::Point;
using Json = nlohmann::ordered_json;

std::string yaml_time(double time_s) {
  const auto nanoseconds = static_cast<std::int64_t>(std::llround(time_s * 1e9));
  return fmt::format("{{sec: {}, nanosec: {}}}", nanoseconds / 1'000'000'000,
                     nanoseconds % 1'000'000'000);
}

}  // namespace

std::string to_csv(const Robot& robot, std::span<const Point> points) {
  std::string text = "time";
  for (const char* quantity : {"position", "velocity", "acceleration"}) {
    for (const std::string& name : robot.joint_names()) {
      text += fmt::format(",{}", internal::escape_csv(fmt::format("{}.{}", name, quantity)));
    }
  }
  for (const Point& point : points) {
    text += fmt::format("\n{},{},{},{}", point.time_s, fmt::join(point.position, ","),
                        fmt::join(point.velocity, ","), fmt::join(point.acceleration, ","));
  }
  return text + "\n";
}

std::string to_yaml(const Robot& robot, std::span<const Point> points) {
  std::string text = "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: ''\njoint_names:\n";
  for (const std::string& name : robot.joint_names()) {
    text += fmt::format("- {}\n", internal::yaml_string(name));
  }
  text += "points:\n";
  for (const Point& point : points) {
    text += fmt::format(
        "- positions: {}\n  velocities: {}\n  accelerations: {}\n  effort: []\n"
        "  time_from_start: {}\n",
        internal::yaml_flow(point.position), internal::yaml_flow(point.velocity),
        internal::yaml_flow(point.acceleration), yaml_time(point.time_s));
  }
  return text;
}

std::string to_json(const Robot& robot, std::span<const Point> points) {
  Json json = {{"format", "mneme-trajectory"}, {"version", 1}};
  json["robot"] = robot.name();
  json["joints"] = robot.joint_names();
  json["duration_s"] = points.empty() ? 0.0 : points.back().time_s;
  for (const char* key : {"times", "positions", "velocities", "accelerations"}) {
    json[key] = Json::array();
  }
  for (const Point& point : points) {
    json["times"].push_back(point.time_s);
    json["positions"].push_back(point.position);
    json["velocities"].push_back(point.velocity);
    json["accelerations"].push_back(point.acceleration);
  }
  // Names come from files and may hold any bytes; JSON must be UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mneme
