// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "base/text.h"
#include "input/input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace mneme {
namespace {

using Point = Trajectory::Point;
using Points = std::span<const Point>;
using Begins = std::span<const StageBegin>;
using Json = nlohmann::ordered_json;

constexpr std::array kQuantities = {"position", "velocity", "acceleration"};

/// A name for a comment: itself if it is printable ASCII, otherwise quoted with escapes. U+0085,
/// U+2028 and U+2029 end a comment of YAML 1.1, as line feeds do.
std::string in_comment(const std::string& name) {
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (std::ranges::all_of(name, is_printable)) return name;
  return Json(name).dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// The last stage that has begun.
const std::string& stage_at(Begins stages, double time_s) {
  constexpr double kSame = 1e-9;  // rounding
  const auto next = std::ranges::find_if(
      stages, [&](const StageBegin& stage) { return stage.begin_s > time_s + kSame; });
  return next == stages.begin() ? stages.front().name : std::prev(next)->name;
}

/// The joints that some stage moves outside of the planning group, in order of their first motion.
std::vector<std::string> finger_names(Begins stages) {
  std::vector<std::string> names;
  for (const StageBegin& stage : stages) {
    for (const FingerMotion& finger : stage.fingers) {
      if (std::ranges::find(names, finger.joint) == names.end()) names.push_back(finger.joint);
    }
  }
  return names;
}

/// A joint's point of its last motion that has begun, or of its first.
Point finger_at(Begins stages, const std::string& joint, double time_s) {
  Point point;
  for (const StageBegin& stage : stages) {
    const auto finger = std::ranges::find(stage.fingers, joint, &FingerMotion::joint);
    if (finger == stage.fingers.end()) continue;
    if (!point.position.empty() && stage.begin_s > time_s) break;
    point = finger->motion.at(time_s - stage.begin_s);
  }
  return point;
}

std::string column(const std::string& joint, const char* quantity) {
  return ',' + internal::escape_csv(fmt::format("{}.{}", joint, quantity));
}

std::string yaml_time(double time_s) {
  const auto nanoseconds = static_cast<std::int64_t>(std::llround(time_s * 1e9));
  return fmt::format("{{sec: {}, nanosec: {}}}", nanoseconds / 1'000'000'000,
                     nanoseconds % 1'000'000'000);
}

}  // namespace

std::string to_csv(const Robot& robot, Points points) { return to_csv(robot, points, {}); }

std::string to_csv(const Robot& robot, Points points, Begins stages) {
  std::string text = "time";
  for (const char* quantity : kQuantities) {
    for (const std::string& name : robot.joint_names()) text += column(name, quantity);
  }
  const std::vector<std::string> fingers = finger_names(stages);
  for (const std::string& name : fingers) {
    for (const char* quantity : kQuantities) text += column(name, quantity);
  }
  if (!stages.empty()) text += ",stage";
  for (const Point& point : points) {
    text += fmt::format("\n{},{},{},{}", point.time_s, fmt::join(point.position, ","),
                        fmt::join(point.velocity, ","), fmt::join(point.acceleration, ","));
    for (const std::string& name : fingers) {
      const Point finger = finger_at(stages, name, point.time_s);
      text +=
          fmt::format(",{},{},{}", finger.position[0], finger.velocity[0], finger.acceleration[0]);
    }
    if (!stages.empty()) text += ',' + internal::escape_csv(stage_at(stages, point.time_s));
  }
  return text + "\n";
}

std::string to_yaml(const Robot& robot, Points points) {
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

std::string to_yaml(const Robot& robot, Points points, Begins stages) {
  std::string text;
  for (const StageBegin& stage : stages) {
    text += fmt::format("# stage from {:.6f} s: {}\n", stage.begin_s, in_comment(stage.name));
  }
  return text + to_yaml(robot, points);
}

std::string to_json(const Robot& robot, Points points) { return to_json(robot, points, {}); }

std::string to_json(const Robot& robot, Points points, Begins stages) {
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
  for (const StageBegin& stage : stages) {
    json["stages"].push_back({{"name", stage.name}, {"begin_s", stage.begin_s}});
  }
  // Names come from files and may hold any bytes; JSON must be UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mneme
