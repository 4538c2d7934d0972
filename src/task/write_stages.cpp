// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/task.h"
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

}  // namespace

std::vector<StageBegin> stage_begins(const TaskResult& result, const TaskMotion& motion) {
  std::vector<StageBegin> stages;
  for (std::size_t i = 0; i < result.stages.size(); ++i) {
    stages.push_back({result.stages[i].name, motion.begins_s[i]});
  }
  return stages;
}

std::string to_csv(const Robot& robot, Points points, Begins stages) {
  const std::string plain = to_csv(robot, points);
  if (stages.empty()) return plain;
  std::string text;
  std::size_t begin = 0;
  for (std::size_t row = 0; row <= points.size(); ++row) {
    const std::size_t end = plain.find('\n', begin);
    const std::string name = row == 0 ? "stage" : stage_at(stages, points[row - 1].time_s);
    text += plain.substr(begin, end - begin) + ',' + internal::escape_csv(name) + '\n';
    begin = end + 1;
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
