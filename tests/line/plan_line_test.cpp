// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/line.h"

#include "goal/posed_robots.h"
#include "line/line_oracle.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <string>
#include <utility>

namespace mneme::test {
namespace {

CollisionChecker require_checker(const Robot& robot, const Scene& scene = {}) {
  const auto checker = CollisionChecker::make(robot, scene);
  REQUIRE(checker);
  return *checker;
}

LineResult require_line(const CollisionChecker& checker, const Line& line, const Configuration& q,
                        const LineSettings& settings = {}) {
  const auto result = plan_line(checker, line, q, settings);
  REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
  return *result;
}

Line random_line(const std::string& link, Rng& rng) {
  Line line;
  line.link = link;
  line.displacement =
      rng.uniform(0.1, 0.4) * Vec3(rng.normal(), rng.normal(), rng.normal()).normalized();
  return line;
}

/// The link stays within the bounds, and these within the tolerances.
void check_deviation(const Robot& robot, const Line& line, const LineResult& result) {
  const LineDeviation off = measure_deviation(robot, line.link, result, 100, line.free_axis);
  CHECK(off.position <= result.line.position_deviation + 1e-9);
  CHECK(off.rotation <= result.line.rotation_deviation + 1e-7);
  CHECK(result.line.position_deviation <= line.position_tolerance);
  CHECK(result.line.rotation_deviation <= line.rotation_tolerance);
}

const std::pair<const char*, const char*> kArms[] = {
    {"panda", "panda_hand"}, {"fetch", "gripper_link"}, {"ur5", "tool0"}};

TEST_SUITE("law") {
  TEST_CASE("lines from random configurations are free and stay within their bounds") {
    for (const auto& [name, link] : kArms) {
      CAPTURE(std::string(name));
      const Robot robot = shipped_robot(name);
      const CollisionChecker checker = require_checker(robot);
      Rng rng(3);
      int whole = 0;
      for (int i = 0; i < 40; ++i) {
        const Configuration q = random_configuration(robot, rng);
        const Line line = random_line(link, rng);
        const LineResult result = require_line(checker, line, q);
        CHECK(result.is_whole() == result.reason.empty());
        check_deviation(robot, line, result);
        if (!result.is_whole()) continue;
        ++whole;
        CHECK(result.line.path.front() == q);
        CHECK(is_path_free(robot, {}, result.line.path, 0.005));
      }
      CHECK(whole >= 8);
    }
  }
}

}  // namespace
}  // namespace mneme::test
