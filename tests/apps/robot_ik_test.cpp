// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Poses on the command line: mneme robot ik, and mneme plan --goal-pose.
#include "apps/planar_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <vector>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

/// Where robot check says that the planar arm's tip is.
std::string tip_pose(const Configuration& q) {
  std::string list;
  for (const double value : q) list += (list.empty() ? "" : ",") + fmt::format("{}", value);
  const ProgramRun run = require_run({"robot", "check", "planar8", "--q", list, "--json"});
  const Json tip = Json::parse(run.out)["tips"][0];
  std::string pose = tip["link"].get<std::string>() + ":";
  for (const double value : tip["position"]) pose += fmt::format("{},", value);
  for (const double value : tip["quat_xyzw"]) pose += fmt::format("{},", value);
  pose.pop_back();
  return pose;
}

TEST_SUITE("flow") {
  TEST_CASE("ik finds configurations of the pose that check prints") {
    const std::string pose = tip_pose(kGoal);
    const ProgramRun run = require_run({"robot", "ik", "planar8", "--pose", pose, "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["message"].is_null());
    REQUIRE(!json["solutions"].empty());
    const Configuration q = json["solutions"][0]["q"].get<Configuration>();
    CHECK(q.size() == 8);
    const Robot robot = planar8();
    const Vec3 at = robot.link_poses(q).back().translation;
    CHECK((at - robot.link_poses(kGoal).back().translation).norm() < 1e-4);
    const ProgramRun told = run_program({"robot", "ik", "planar8", "--pose", pose});
    CHECK(contains(told.out, " away)"));
  }

  TEST_CASE("a problem is solved to a pose of its tip") {
    const PlanarFiles files;
    const ProgramRun run =
        require_run({"plan", files.problem(), "--goal-pose", tip_pose(kGoal), "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["goal_time_s"] > 0);
    const Robot robot = planar8();
    const auto path = json["path"].get<std::vector<Configuration>>();
    CHECK((robot.link_poses(path.back()).back().translation -
           robot.link_poses(kGoal).back().translation)
              .norm() < 1e-4);
    const ProgramRun told = require_run(
        {"plan", files.problem(), "--goal-pose", tip_pose(kGoal), "--goal-pose", "link_8:3,3,0"});
    CHECK(contains(told.out, "for 2 poses"));
  }

  TEST_CASE("a pose out of reach is an invalid goal, and says by how far") {
    const PlanarFiles files;
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"robot", "ik", "planar8", "--pose", "link_8:30,0,0"},
          std::vector<std::string>{"plan", files.problem(), "--goal-pose", "link_8:30,0,0"}}) {
      const ProgramRun run = run_program(command);
      CHECK(run.exit_code == 4);
      CHECK_MESSAGE(contains(run.err, "the pose is out of reach of link 'link_8' by "), run.err);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("poses that are none are refused") {
    const PlanarFiles files;
    const std::string problem = files.problem();
    check_bad_inputs({
        {{"robot", "ik", "planar8"}, 2, {"--pose is required"}},
        {{"robot", "ik", "planar8", "--pose", "1,2,3"}, 2, {"--pose", "names no link"}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2"}, 2, {"--pose", "3 finite numbers"}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2,nan"}, 2, {"--pose", "finite"}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2,x"}, 2, {"--pose", "item 3 is 'x'"}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2,0,0,0,0,0"},
         2,
         {"length 1, got one of length 0"}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2,0,0,0,0,2"},
         2,
         {"length 1, got one of length 2"}},
        {{"robot", "ik", "planar8", "--pose", "nose:1,2,0"},
         1,
         {"--pose: expected a link of robot planar8, got \"nose\""}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2,0", "--near", "1,2"},
         1,
         {"--near: there are 2 values"}},
        {{"robot", "ik", "planar8", "--pose", "link_8:1,2,0", "--ik-seeds", "0"},
         2,
         {"--ik-seeds", "'0'"}},
        {{"plan", problem, "--goal-pose", "link_8"}, 2, {"--goal-pose", "names no link"}},
        {{"plan", problem, "--goal-pose", "nose:1,2,0"},
         1,
         {"goal pose: expected a link of robot planar8, got \"nose\""}},
    });
  }
}

}  // namespace
}  // namespace mneme::test
