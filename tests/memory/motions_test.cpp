// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/local_motions.h"
#include "support/enclosed_arm.h"
#include "support/kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

namespace mneme::test {
namespace {

using internal::MotionFinder;

struct Lesson {
  Robot robot = panda();
  Scene scene = enclose(robot, bent_motion(), 3);
  RememberedPath motion;

  Lesson() {
    const auto motions = internal::cut_tight_stretches(make_checker(robot, scene),
                                                       make_checker(robot, Scene{}), bent_motion());
    REQUIRE(motions.size() == 1);
    motion = motions.front();
  }
  [[nodiscard]] std::vector<float> find_in(const Scene& other) const {
    const auto checker = make_checker(robot, other);
    CheckCounters counters;
    auto places = MotionFinder(checker).find(motion, counters);
    CHECK(counters.states > 0);
    CHECK(counters.states < 3000);
    return places;
  }
};

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("a tight stretch holds free waypoints, their clearances, and blocked near misses") {
    const Lesson lesson;
    const RememberedPath& motion = lesson.motion;
    REQUIRE(motion.clearances.size() == static_cast<std::size_t>(motion.waypoint_count()));
    CHECK(std::ranges::count_if(motion.clearances, [](float c) { return c < 0.01f; }) >= 3);
    const auto checker = make_checker(lesson.robot, lesson.scene);
    for (int i = 0; i < motion.waypoint_count(); ++i) {
      const std::span q(motion.waypoints.data() + 7 * i, 7);
      std::uint8_t is_free = 0;
      checker.check_states(q, {&is_free, 1}, motion.clearances[static_cast<std::size_t>(i)]);
      CHECK(is_free == 1);
    }
    std::vector<std::uint8_t> is_free(motion.near_misses.size() / 7);
    CHECK(is_free.size() == 64);
    checker.check_states(motion.near_misses, is_free);
    CHECK(std::ranges::count(is_free, 1) == 0);
    make_checker(lesson.robot, Scene{}).check_states(motion.near_misses, is_free);
    CHECK(std::ranges::count(is_free, 0) == 0);
  }

  TEST_CASE("a motion is found where its obstacles are turned about the axis, and free there") {
    const Lesson lesson;
    for (const double angle : {0.0, 0.63, -1.27, 1.4}) {
      CAPTURE(angle);
      const Scene scene = turned(lesson.scene, angle);
      const std::vector<float> places = lesson.find_in(scene);
      REQUIRE(places.size() == 1);
      CHECK(std::abs(places.front() - angle) < 0.02);
      const auto checker = make_checker(lesson.robot, scene);
      const auto rows = MotionFinder(checker).placed(lesson.motion, places.front());
      std::vector<std::uint8_t> is_free(rows.size() / 7);
      checker.check_states(rows, is_free);
      CHECK(std::ranges::count(is_free, 0) <= 2);
      int blocked = 0;
      for (std::size_t i = 7; i < rows.size(); i += 7) {
        CheckCounters counters;
        const std::span all(rows);
        if (!checker.is_motion_valid(all.subspan(i - 7, 7), all.subspan(i, 7), counters)) ++blocked;
      }
      CHECK(blocked <= 2);
    }
  }

  TEST_CASE("a motion that was learned within wider limits is placed within those of the robot") {
    const Lesson lesson;
    std::map<std::string, std::array<double, 2>> limits;
    for (int j = 0; j < 7; ++j) {
      const double first = bent_motion().front()[static_cast<std::size_t>(j)];
      limits[lesson.robot.group_joint(j).name] = {first - 0.1, first + 0.1};
    }
    const Robot narrow = lesson.robot.with_limits(limits);
    const auto checker = make_checker(narrow, Scene{});
    const auto rows = MotionFinder(checker).placed(lesson.motion, 0.3f);
    for (std::size_t i = 0; i < rows.size(); i += 7) {
      const Configuration q(rows.data() + i, rows.data() + i + 7);
      CHECK_FALSE(narrow.describe_violation(q, "waypoint"));
    }
  }

  TEST_CASE("a motion is not found in the open, nor among foreign boxes") {
    const Lesson lesson;
    CHECK(lesson.find_in(Scene{}).empty());
    CHECK(lesson.find_in(enclose(lesson.robot, bent_motion(0.4), 4)).empty());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("known places of a scene are kept") {
    internal::KnownPlaces known;
    const internal::ContentHash one{std::byte{1}}, two{std::byte{2}};
    known.add({{one, {0.5f}}});
    known.add({{one, {9.0f}}, {two, {}}});
    const auto places = known.copy();
    REQUIRE(places.size() == 2);
    CHECK(places.at(one) == std::vector<float>{0.5f});
    CHECK(places.at(two).empty());
  }

  TEST_CASE("solved paths in the open teach no motion") {
    const Robot robot = panda();
    const std::vector<Path> paths = {bent_motion()};
    CHECK(require(learn_from_paths({robot, Scene{}}, paths, of_kind("motions"))).empty());
  }
}

}  // namespace mneme::test
