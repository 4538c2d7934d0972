// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/informed_box.h"
#include "path/rest_to_rest.h"
#include "support/support.h"

#include <algorithm>

namespace mneme::test {
namespace {

using internal::make_informed_sampler;
using internal::rest_to_rest;

bool never() { return false; }

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("informed samples leave no room for faster motions, and come close to that room") {
    const Robot robot = load_robot(find_robot("panda").value()).value();
    const std::size_t joints = 7;
    const RateLimits limits{std::vector<double>(joints, 2), std::vector<double>(joints, 15),
                            std::vector<double>(joints, 500)};
    const Configuration start = {0, -0.785, 0, -2.356, 0, 1.571, 0.785};
    const Configuration goal = {0.5, -0.2, -0.6, -2, 0.3, 1.2, 0.7};
    const double straight_s = rest_to_rest(limits, 2).duration_s(0.6);
    CHECK(make_informed_sampler(robot, {start, {goal}}, limits, 0.99 * straight_s, never) ==
          nullptr);
    CHECK(make_informed_sampler(robot, {start, {goal}}, limits, 2 * straight_s,
                                [] { return true; }) == nullptr);
    for (const double share : {1.05, 1.2, 1.4}) {
      CAPTURE(share);
      const double time_s = share * straight_s;
      const auto sampler = make_informed_sampler(robot, {start, {goal}}, limits, time_s, never);
      REQUIRE(sampler != nullptr);
      const auto stream = sampler->start(1);
      std::vector<double> slowest_s(joints);
      std::vector<float> q(joints);
      for (int i = 0; i < 4000; ++i) {
        CHECK(stream->next(q) == kUniformSource);
        CHECK_FALSE(robot.describe_violation(Configuration(q.begin(), q.end()), "sample"));
        for (std::size_t j = 0; j < joints; ++j) {
          const double least = std::min(start[j], goal[j]), most = std::max(start[j], goal[j]);
          const double beyond = std::max({0.0, least - q[j], q[j] - most});
          const auto joint = rest_to_rest(limits, j);
          const double needed_s =
              joint.duration_s(most - least + beyond) + joint.duration_s(beyond);
          slowest_s[j] = std::max(slowest_s[j], needed_s);
        }
      }
      CHECK(*std::ranges::max_element(slowest_s) <= 1.001 * time_s);
      CHECK(*std::ranges::min_element(slowest_s) >= 0.9 * time_s);
    }
  }
}

}  // namespace mneme::test
