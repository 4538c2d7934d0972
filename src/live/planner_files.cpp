// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "live/planner_files.h"

#include "base/as_index.h"
#include "base/files.h"
#include "report/packed.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace mneme {
namespace internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kUrdf = "/robot.urdf";
constexpr const char* kSrdf = "/robot.srdf";
constexpr const char* kProblem = "/problem.json";
constexpr std::size_t kMaxModuleBytes = std::size_t{64} << 20;

/// The robot as spheres and capsules, which need no other file. A pair of links that exact geometry
/// decides counts as allowed.
Robot::Parts portable_parts(const Robot& robot) {
  const auto links = robot.links();
  Robot::Parts parts{.name = robot.name(),
                     .links = {links.begin(), links.end()},
                     .joints = {robot.joints().begin(), robot.joints().end()}};
  const std::set<std::pair<int, int>> exact(robot.exact_pairs().begin(), robot.exact_pairs().end());
  std::set<std::pair<int, int>> checked;
  for (const auto& pair : robot.self_pairs()) {
    if (!exact.contains(pair)) checked.insert(std::minmax(pair.first, pair.second));
  }
  parts.allowed_pairs.emplace();
  for (int b = 0; b < static_cast<int>(links.size()); ++b) {
    for (int a = 0; a < b; ++a) {
      if (!has_shapes(links[as_index(a)]) || !has_shapes(links[as_index(b)])) continue;
      if (checked.contains({a, b})) continue;
      parts.allowed_pairs->push_back({links[as_index(a)].name, links[as_index(b)].name});
    }
  }
  return parts;
}

/// An element of the page that holds bytes.
std::string element_of(std::string_view id, std::string_view bytes) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", id,
                     to_base64({data, bytes.size()}));
}

}  // namespace

Json planner_json(const Problem& problem) {
  const Robot::Parts parts = portable_parts(problem.robot.without_attached());
  Json files = Json::array();
  files.push_back({{"path", kUrdf}, {"text", to_urdf(parts)}});
  files.push_back({{"path", kSrdf}, {"text", to_srdf(parts)}});
  // Names of problems may hold what no address can.
  Problem named = problem;
  named.name = "page";
  files.push_back({{"path", kProblem}, {"text", to_compact_json(named, kUrdf)}});
  return {{"files", std::move(files)}, {"problem", std::string(kProblem) + "#page"}};
}

std::string planner_elements(const PlannerModule& module) {
  return element_of("planner-code", module.code) + element_of("planner-wasm", module.wasm);
}

}  // namespace internal

Result<PlannerModule> find_planner_module() {
  using internal::read_regular_file;
  for (const std::string& directory : data_directories()) {
    auto code = read_regular_file(directory + "/wasm/planner.js.gz", internal::kMaxModuleBytes);
    auto wasm = read_regular_file(directory + "/wasm/planner.wasm.gz", internal::kMaxModuleBytes);
    if (code && wasm) return PlannerModule{*std::move(code), *std::move(wasm)};
  }
  return fail(ErrorCode::io, fmt::format("there is no wasm/planner.wasm.gz in {}; script/wasm of "
                                         "the source tree builds it",
                                         fmt::join(data_directories(), ", ")));
}

}  // namespace mneme
