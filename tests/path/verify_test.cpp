// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"

namespace mneme::test {
namespace {

int invalid_motion(const CollisionChecker& checker, const Path& path) {
  CheckCounters counters;
  return find_invalid_motion(checker, path, counters);
}

/// The gantry's ball above a table; it touches where its third value is 0.1.
World table() {
  return {"table", gantry(), {"", {make_box("table", {-1, -1, -1}, {1, 1, 0})}}, {}};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("paths without motions are free") {
    const CollisionChecker checker = make_checker(table());
    CHECK(invalid_motion(checker, {}) == -1);
    CHECK(invalid_motion(checker, {{0, 0, 1}}) == -1);
    CHECK(invalid_motion(checker, {{0, 0, 1}, {0, 0, 1}}) == -1);
  }

  TEST_CASE("the first motion in contact is found, wherever it is") {
    const CollisionChecker checker = make_checker(table());
    const Configuration a = {-1.5, 0, 0.5}, b = {1.5, 0, 0.5};
    const Configuration c = {-1.5, 0, -0.5}, d = {1.5, 0, -0.5};
    CHECK(invalid_motion(checker, {a, b}) == -1);
    CHECK(invalid_motion(checker, {c, d}) == 0);
    CHECK(invalid_motion(checker, {a, b, d, c, a}) == 2);
    CHECK(invalid_motion(checker, {a, c, d, b, a, c, d}) == 1);
    CHECK(invalid_motion(checker, {a, b, a, b, a, d}) == 4);
  }

  TEST_CASE("an obstacle between two states of the planner's resolution is found") {
    World world{"post", gantry(), {"", {make_ball("post", {0.01, 0, 0}, 0.01)}}, {}};
    CheckerSettings coarse;
    coarse.resolution = 1;
    const CollisionChecker checker = make_checker(world, coarse);
    const std::vector<Configuration> path = {{-2, 0, 0}, {2, 0, 0}};
    CHECK(invalid_motion(checker, path) == 0);
    coarse.resolution = 0.001;
    CHECK(invalid_motion(make_checker(world, coarse), path) == 0);
  }

  TEST_CASE("what lies between the states that are checked is found when motions are verified") {
    CheckerSettings coarse;
    coarse.resolution = 1;
    const Path path = {{-2, 0, 0}, {2, 0, 0}};
    const auto first_invalid = [&](double gap, double margin, Verification verification) {
      // The states are a twelfth of a metre apart, and one of them is at 0.
      const World world{
          "", gantry(), {"", {make_ball("post", {1 / 24., 0.101 + gap, 0}, 0.001)}}, {}};
      coarse.margin = margin;
      CheckCounters counters;
      return find_invalid_motion(make_checker(world, coarse), path, counters, verification);
    };
    CHECK(first_invalid(-0.001, 0, Verification::none) == -1);
    CHECK(first_invalid(-0.001, 0, Verification::states) == -1);
    CHECK(first_invalid(-0.001, 0, Verification::motions) == 0);
    CHECK(first_invalid(0.001, 0, Verification::motions) == -1);
    CHECK(first_invalid(0.001, 0.002, Verification::states) == -1);
    CHECK(first_invalid(0.001, 0.002, Verification::motions) == 0);
  }

  TEST_CASE("half a turn does not pass, because it may go either way round") {
    const CollisionChecker checker = make_checker(thick_arm({1, 1}), {});
    for (const double from : {-kPi, -kPi / 2, 0.0, 0.3, kPi / 2}) {
      INFO("from ", from);
      const double to = from + (from > 0 ? -kPi : kPi);
      CHECK(invalid_motion(checker, {{from, 0}, {to, 0}}) == 0);
      CHECK(invalid_motion(checker, {{to, 0}, {from, 0}}) == 0);
      CHECK(invalid_motion(checker, {{from, 0}, {from + 1, 0}, {to, 0}}) == -1);
    }
    CHECK(invalid_motion(checker, {{0, 0}, {kPi - 1e-3, 0}}) == -1);
  }

  TEST_CASE("a motion in the middle of a path needs the margin") {
    const CollisionChecker checker = make_checker(table());
    const auto path_at = [](double height) {
      return Path{{-0.5, 0, 1}, {-0.5, 0, height}, {0.5, 0, height}, {0.5, 0, 1}};
    };
    CHECK(invalid_motion(checker, path_at(0.1 + 2 * kVerificationMargin)) == -1);
    CHECK(invalid_motion(checker, path_at(0.1 + 0.5 * kVerificationMargin)) == 0);
    CHECK(invalid_motion(checker, path_at(0.1 - kVerificationMargin)) == 0);
  }

  TEST_CASE("only where a path ends may it be closer to contact than the margin") {
    const CollisionChecker checker = make_checker(table());
    const double close = 0.1 + 0.5 * kVerificationMargin;
    const Configuration above = {0.5, 0, 1}, higher = {0.5, 0, 1.5}, low = {0, 0, close};
    CHECK(invalid_motion(checker, {low, above}) == -1);
    CHECK(invalid_motion(checker, {above, low}) == -1);
    CHECK(invalid_motion(checker, {low, above, low}) == -1);
    CHECK(invalid_motion(checker, {above, low, higher}) == 0);
    CHECK(invalid_motion(checker, {higher, above, higher, above}) == -1);
    CHECK(invalid_motion(checker, {higher, above, low, above, higher}) == 1);
    // An end that has the margin does not lend it to what lies between.
    World bump = table();
    bump.scene.obstacles.push_back(make_ball("bump", {0, 0, 0}, 0.1));
    const double over = 0.2 + 0.5 * kVerificationMargin;
    CHECK(invalid_motion(make_checker(bump), {{-0.5, 0, over}, {0.5, 0, over}}) == 0);
    const double clear = 0.2 + 2 * kVerificationMargin;
    CHECK(invalid_motion(make_checker(bump), {{-0.5, 0, clear}, {0.5, 0, clear}}) == -1);
  }

  TEST_CASE("a curve is free if it keeps the margin, and however far it is off its chords") {
    const CollisionChecker checker = make_checker(table());
    CheckCounters counters;
    const std::vector<float> still(3, 0.0f);
    for (const Verification verification : {Verification::states, Verification::motions}) {
      const MotionVerifier verifier(checker, verification);
      const auto is_free_at = [&](double lowest, double bow) {
        const auto z = static_cast<float>(lowest);
        const std::vector<float> states = {-1, 0, z + 1, 0, 0, z, 1, 0, z + 1};
        const std::vector<float> off = {0, 0, static_cast<float>(bow)};
        return verifier.is_curve_free(states, off, counters);
      };
      CHECK(is_free_at(0.1 + 2 * kVerificationMargin, 0));
      CHECK_FALSE(is_free_at(0.1 + 0.4 * kVerificationMargin, 0));
      CHECK_FALSE(is_free_at(0.1 - kVerificationMargin, 0));
      CHECK(is_free_at(0.1 + 0.03, 0.01));
      CHECK_FALSE(is_free_at(0.1 + 0.009, 0.01));
      CHECK_FALSE(is_free_at(0.1 + 0.009, -0.01));
    }
    const MotionVerifier nothing(checker, Verification::none);
    CHECK(nothing.is_curve_free(std::vector<float>{0, 0, -1, 1, 0, -1}, still, counters));
  }

  TEST_CASE("work is counted") {
    const CollisionChecker checker = make_checker(table());
    CheckCounters counters;
    CHECK(find_invalid_motion(checker, {{-1, 0, 1}, {1, 0, 1}, {1, 1, 1}}, counters) == -1);
    CHECK(counters.motions >= 2);
    CHECK(counters.states >= 2);
  }

  TEST_CASE("motions are judged alone as in a path") {
    const CollisionChecker checker = make_checker(table());
    const MotionVerifier verifier(checker);
    CheckCounters counters;
    const float close = static_cast<float>(0.1 + 0.5 * kVerificationMargin);
    const std::vector<float> low = {0, 0, close}, above = {0.5f, 0, 1};
    CHECK(verifier.is_free(low, above, {true, false}, counters));
    CHECK(!verifier.is_free(above, low, {}, counters));
    CHECK(verifier.is_free(above, above, {}, counters));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("verified motions are free of contact also at other states of the same density") {
    Rng rng(21);
    World world{"", planar8(), make_circle_scene("", {{3, 3, 1.2}, {-4, 2, 1.5}, {1, -5, 2}}), {}};
    const CollisionChecker checker = make_checker(world);
    const MotionVerifier verifier(checker);
    int verified = 0;
    for (int i = 0; i < 150; ++i) {
      INFO("round ", i);
      const Configuration from = random_free_configuration(checker, rng);
      Configuration to = from;
      for (double& value : to) value = std::clamp(value + rng.uniform(-0.4, 0.4), -3.14, 3.14);
      const std::vector<float> a(from.begin(), from.end()), b(to.begin(), to.end());
      CheckCounters counters;
      if (!verifier.is_free(a, b, {}, counters)) continue;
      ++verified;
      for (const double refinement : {9.7, 10.0}) {
        const auto flaw = motion_flaw(checker, from, to, refinement);
        CHECK_MESSAGE(!flaw, flaw.value_or(""));
      }
    }
    CHECK(verified >= 15);
  }
}

}  // namespace mneme::test
