// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell_motion.h"

#include "cell/cells.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace mneme::test {
namespace {

constexpr double kResolution = 1.0 / 320;
/// Relative; limits are kept this well.
constexpr double kSlack = 1e-6;

RateLimits limits_of(const Robot& robot, double acceleration, double jerk) {
  TrajectorySettings settings;
  settings.acceleration_limit = acceleration;
  if (std::isfinite(jerk)) settings.jerk_limit = jerk;
  const auto limits = find_rate_limits(robot, settings);
  REQUIRE(limits.has_value());
  return *limits;
}

/// Value and derivatives of a joint, by its polynomial.
std::array<double, 4> rates_at(const Trajectory::Stretch& stretch, std::size_t joint,
                               std::size_t joints, double t) {
  std::array<double, 4> rates = {};
  for (std::size_t k = stretch.coefficients.size() / joints; k-- > 0;) {
    for (std::size_t order = 3; order > 0; --order) {
      rates[order] = rates[order] * t + static_cast<double>(order) * rates[order - 1];
    }
    rates[0] = rates[0] * t + stretch.coefficients[k * joints + joint];
  }
  return rates;
}

/// Checks limits at many times of each stretch, and that stretches join.
void check_rates(const Robot& robot, const Trajectory& motion, const RateLimits& limits) {
  constexpr int kTimes = 32;
  const std::size_t joints = limits.velocity.size();
  const auto& stretches = motion.stretches();
  std::vector<std::array<double, 4>> before(joints);
  for (std::size_t j = 0; j < joints; ++j) before[j] = {motion.at(0).position[j]};
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const double end_s = i + 1 < stretches.size() ? stretches[i + 1].begin_s : motion.duration_s();
    const double length_s = end_s - stretches[i].begin_s;
    for (std::size_t j = 0; j < joints; ++j) {
      const Joint& joint = robot.group_joint(static_cast<int>(j));
      const bool has_jerk = std::isfinite(limits.jerk[j]);
      for (int k = 0; k <= kTimes; ++k) {
        const auto rates = rates_at(stretches[i], j, joints, length_s * k / kTimes);
        if (k == 0) {
          CHECK(rates[0] == doctest::Approx(before[j][0]).epsilon(1e-7));
          CHECK(std::abs(rates[1] - before[j][1]) < 1e-6);
          if (has_jerk) CHECK(std::abs(rates[2] - before[j][2]) < 1e-4);
        }
        if (joint.type != JointType::continuous) {
          REQUIRE(rates[0] >= joint.lower - 1e-9);
          REQUIRE(rates[0] <= joint.upper + 1e-9);
        }
        REQUIRE(std::abs(rates[1]) <= limits.velocity[j] * (1 + kSlack));
        REQUIRE(std::abs(rates[2]) <= limits.acceleration[j] * (1 + kSlack));
        if (has_jerk) REQUIRE(std::abs(rates[3]) <= limits.jerk[j] * (1 + kSlack));
        before[j] = rates;
      }
    }
  }
  for (std::size_t j = 0; j < joints; ++j) CHECK(std::abs(before[j][1]) < 1e-6);
}

/// Checks all that is promised of a motion.
void check_motion(const CellRegion& region, const CellAnswer& answer, const Trajectory& motion,
                  const RateLimits& limits) {
  constexpr double kStep = 0.004;
  const Robot& robot = region.problem.robot;
  check_rates(robot, motion, limits);
  const auto points = motion.sample(kStep);
  REQUIRE(points.has_value());
  Path path;
  for (const Trajectory::Point& point : *points) path.push_back(point.position);
  for (std::size_t j = 0; j < path.front().size(); ++j) {
    CHECK(std::abs(path.front()[j] - answer.path.front()[j]) < 1e-7);
    CHECK(std::abs(path.back()[j] - answer.path.back()[j]) < 1e-9);
  }
  CHECK(is_path_free(robot, region.problem.scene, path, kResolution));
}

/// The task of the answer's box that is farthest from `task` in a direction.
CellAnswer extreme_answer(const Cell& cell, const CellTask& task, const CellTask& direction,
                          const CellAnswer& answer) {
  CellAnswer extreme = answer, there;
  double near = 0, far = 1;
  for (int i = 0; i < 20; ++i) {
    const double step = 0.5 * (near + far);
    CellTask other = task;
    for (std::size_t k = 0; k < kTaskSize; ++k) other[k] += step * direction[k];
    cell.look_up(other, there);
    const bool is_inside = there.tier == CellTier::certified && there.box == answer.box;
    (is_inside ? near : far) = step;
    if (is_inside) extreme = there;
  }
  return extreme;
}

/// A region that paths reach around a post at x and y. `start` are the first joints.
CellRegion around_post(const TemporaryDirectory& directory, double x, double y, double height,
                       const std::string& start) {
  std::string text = region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", y);
  const auto replace = [&](const std::string& usual, const std::string& other) {
    text.replace(text.find(usual), usual.size(), other);
  };
  replace("[0, -0.785, 0, -2.356", start);
  replace("size: [0.04, 0.04, 0.4]", fmt::format("size: [0.04, 0.04, {}]", height));
  replace(fmt::format("position: [0.5, {}", y), fmt::format("position: [{}, {}", x, y));
  return require_region(directory, text);
}

/// Answers to `count` tasks, half of them at corners, as far as they are certified.
std::vector<CellAnswer> certified_answers(const Cell& cell, int count) {
  Rng rng(3);
  std::vector<CellAnswer> answers;
  for (int i = 0; i < count; ++i) {
    CellAnswer answer;
    cell.look_up(random_task_of(cell.region(), rng, i % 2 == 1), answer);
    if (answer.tier == CellTier::certified) answers.push_back(answer);
  }
  REQUIRE(2 * answers.size() > static_cast<std::size_t>(count));
  return answers;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("motions of certified answers keep the limits, are free, and are timed once per box") {
    const TemporaryDirectory directory;
    // The post stands close to where hands go.
    const CellRegion region =
        require_region(directory, region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.22));
    const Cell cell = require_cell(region, 60);
    const CellMotions motions(cell);
    for (const double jerk : {500.0, std::numeric_limits<double>::infinity()}) {
      const RateLimits limits = limits_of(region.problem.robot, 15, jerk);
      Rng rng(5);
      std::map<int, double> durations;
      int certified = 0, of_box = 0, repeated = 0;
      const auto check = [&](const CellAnswer& answer) {
        const CellMotion timed = require(motions.time(answer, limits));
        check_motion(region, answer, timed.motion, limits);
        ++certified;
        if (!timed.is_of_box) return;
        ++of_box;
        const auto [known, is_new] = durations.emplace(answer.box, timed.motion.duration_s());
        repeated += is_new ? 0 : 1;
        CHECK(timed.motion.duration_s() == known->second);
      };
      for (int i = 0; i < 60; ++i) {
        INFO("seed 5, jerk " << jerk << ", task " << i);
        CellAnswer answer;
        const CellTask task = random_task_of(region, rng, i % 2 == 1);
        cell.look_up(task, answer);
        if (answer.tier != CellTier::certified) continue;
        check(answer);
        check(extreme_answer(cell, task, random_task_of(region, rng, true), answer));
      }
      CHECK(certified > 60);
      CHECK(repeated > 20);
      CHECK(10 * of_box > 9 * certified);
    }
  }

  TEST_CASE("motions of certified answers keep the margin from obstacles, bent or not") {
    const TemporaryDirectory directory;
    const CellRegion region = around_post(directory, 0.46, 0.29, 0.6, "[1.4, 0.1, 0, -1.8");
    constexpr double kMargin = 0.03;
    const Cell cell =
        require(build_cell(region, {.seconds = 1000, .boxes = 60, .margin = kMargin}));
    CheckerSettings settings;
    settings.margin = kMargin - 2e-5;
    const auto checker =
        require(CollisionChecker::make(region.problem.robot, region.problem.scene, settings));
    const CellMotions motions(cell);
    const RateLimits limits = limits_of(region.problem.robot, 3, 40);
    int of_box = 0, own = 0;
    for (const CellAnswer& answer : certified_answers(cell, 40)) {
      const CellMotion timed = require(motions.time(answer, limits));
      ++(timed.is_of_box ? of_box : own);
      for (const Trajectory::Point& point : require(timed.motion.sample(0.004))) {
        REQUIRE(checker.is_valid(point.position));
      }
    }
    CHECK(of_box > 0);
    CHECK(own > 0);
  }

  TEST_CASE("motions of boxes are not much slower than those of their paths") {
    const TemporaryDirectory directory;
    const CellRegion region = around_post(directory, 0.5, 0.24, 1, "[0.8, -0.3, 0, -1.8");
    const Cell cell = require(build_cell(region, {.seconds = 1000, .boxes = 60, .margin = 0.02}));
    const CellMotions motions(cell);
    const RateLimits limits = limits_of(region.problem.robot, 3, 40);
    double of_boxes = 0, of_paths = 0;
    for (CellAnswer answer : certified_answers(cell, 40)) {
      const CellMotion timed = require(motions.time(answer, limits));
      CHECK(timed.is_of_box);
      of_boxes += timed.motion.duration_s();
      answer.tier = CellTier::verified;
      of_paths += require(motions.time(answer, limits)).motion.duration_s();
    }
    REQUIRE(of_paths > 0);
    CHECK(of_boxes < 1.6 * of_paths);
  }

  TEST_CASE("answers without a proven box have the motion of their path") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 20);
    const CellMotions motions(cell);
    const Robot& robot = region.problem.robot;
    RateLimits limits = limits_of(robot, 15, 500);
    CellAnswer answer;
    cell.look_up({}, answer);
    REQUIRE(answer.tier == CellTier::certified);
    CHECK(require(motions.time(answer, limits)).is_of_box);
    CellAnswer other = answer;
    other.tier = CellTier::verified;
    const CellMotion own = require(motions.time(other, limits));
    CHECK_FALSE(own.is_of_box);
    check_motion(region, other, own.motion, limits);
    other = answer;
    other.box = static_cast<int>(cell.box_count());
    CHECK(require_error(motions.time(other, limits)).code == ErrorCode::invalid);
    CHECK(require_error(motions.time({}, limits)).code == ErrorCode::invalid);
    const Cell another = require_cell(
        require_region(directory, region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.4)), 20);
    another.look_up({}, other);
    REQUIRE(other.tier == CellTier::certified);
    CHECK(contains(require_error(motions.time(other, limits)).message, "of another cell"));
    other.tier = CellTier::verified;
    CHECK(require_error(motions.time(other, limits)).code == ErrorCode::invalid);
    limits.velocity.front() = -1;
    CHECK(require_error(motions.time(answer, limits)).code == ErrorCode::invalid);
  }
}

}  // namespace mneme::test
