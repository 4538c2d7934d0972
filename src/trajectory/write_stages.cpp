// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "base/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace mneme {
namespace {

using Points = std::span<const Trajectory::Point>;
using Begins = std::span<const StageBegin>;

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
Trajectory::Point finger_at(Begins stages, const std::string& joint, double time_s) {
  Trajectory::Point point;
  for (const StageBegin& stage : stages) {
    const auto finger = std::ranges::find(stage.fingers, joint, &FingerMotion::joint);
    if (finger == stage.fingers.end()) continue;
    if (!point.position.empty() && stage.begin_s > time_s) break;
    point = finger->motion.at(time_s - stage.begin_s);
  }
  return point;
}

std::string finger_head(const std::string& joint) {
  std::string text;
  for (const char* quantity : {"position", "velocity", "acceleration"}) {
    text += ',' + internal::escape_csv(fmt::format("{}.{}", joint, quantity));
  }
  return text;
}

std::string finger_cells(const Trajectory::Point& point) {
  return fmt::format(",{},{},{}", point.position[0], point.velocity[0], point.acceleration[0]);
}

}  // namespace

std::string to_csv(const Robot& robot, Points points, Begins stages) {
  const std::string plain = to_csv(robot, points);
  if (stages.empty()) return plain;
  const std::vector<std::string> fingers = finger_names(stages);
  std::string text;
  std::size_t begin = 0;
  for (std::size_t row = 0; row <= points.size(); ++row) {
    const std::size_t end = plain.find('\n', begin);
    text += plain.substr(begin, end - begin);
    begin = end + 1;
    const double time_s = row == 0 ? 0 : points[row - 1].time_s;
    for (const std::string& name : fingers) {
      text += row == 0 ? finger_head(name) : finger_cells(finger_at(stages, name, time_s));
    }
    const std::string stage = row == 0 ? "stage" : stage_at(stages, time_s);
    text += ',' + internal::escape_csv(stage) + '\n';
  }
  return text;
}

std::string to_yaml(const Robot& robot, Points points, Begins stages) {
  std::string text;
  for (const StageBegin& stage : stages) {
    std::string name = stage.name;
    std::ranges::replace(name, '\n', ' ');
    text += fmt::format("# stage from {:.6f} s: {}\n", stage.begin_s, name);
  }
  return text + to_yaml(robot, points);
}

std::string to_json(const Robot& robot, Points points, Begins stages) {
  const std::string plain = to_json(robot, points);
  if (stages.empty()) return plain;
  auto json = nlohmann::ordered_json::parse(plain);
  for (const StageBegin& stage : stages) {
    json["stages"].push_back({{"name", stage.name}, {"begin_s", stage.begin_s}});
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace mneme
