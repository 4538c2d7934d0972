// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "instances/known_robot.h"
#include "support/planar_memory.h"

#include <atomic>

namespace mneme::test {
namespace {

EnclosedSettings few_boxes() {
  EnclosedSettings settings;
  settings.clearance = 0.02;
  settings.boxes = 60;
  settings.through = 1;
  return settings;
}

/// True if all obstacles are more than `margin` metres away along the whole witness.
bool has_clearance(const Robot& robot, const EnclosedInstance& instance, double margin) {
  const auto checker = require(CollisionChecker::make(robot, instance.scene, {.margin = margin}));
  CheckCounters counters;
  return checker.is_valid(std::span<const double>(instance.start)) &&
         find_invalid_motion(checker, instance.witness, counters) == -1;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("boxes leave the witness its clearance, in space and in the plane") {
    for (const char* name : {"panda", "planar8"}) {
      const Robot robot = known_robot(name);
      const EnclosedSettings settings = few_boxes();
      for (const EnclosedInstance& instance :
           require(make_enclosed_instances(robot, 3, settings, 1)).instances) {
        CHECK(instance.scene.obstacles.size() == 60);
        REQUIRE(instance.witness.size() >= 3);
        CHECK(instance.witness.front() == instance.start);
        CHECK(instance.witness.back() == instance.goal);
        CHECK(has_clearance(robot, instance, 0.99 * settings.clearance));
        CHECK(make_checker(robot, instance.scene).fixed_contacts().empty());
        CHECK_FALSE(has_clearance(robot, instance, 5 * settings.clearance));
      }
    }
  }

  TEST_CASE("the same seed gives the same instances, more of them continue the list") {
    const Robot robot = known_robot("panda");
    const auto few = require(make_enclosed_instances(robot, 2, few_boxes(), 5)).instances;
    const auto many = require(make_enclosed_instances(robot, 4, few_boxes(), 5)).instances;
    const auto other = require(make_enclosed_instances(robot, 2, few_boxes(), 6)).instances;
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(few[i].witness == many[i].witness);
      CHECK(to_yaml(few[i].scene) == to_yaml(many[i].scene));
      CHECK(few[i].witness != other[i].witness);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("where there is no room for more boxes there are fewer") {
    EnclosedSettings settings = few_boxes();
    settings.clearance = 1;
    settings.size = {0.05, 0.05};
    const auto made = require(make_enclosed_instances(planar8(), 1, settings, 1));
    REQUIRE(made.instances.size() == 1);
    CHECK(made.instances[0].scene.obstacles.empty());
  }

  TEST_CASE("none are made where none are asked for, or after a cancellation") {
    CHECK(require(make_enclosed_instances(planar8(), 0, few_boxes(), 1)).instances.empty());
    const std::atomic<bool> is_cancelled = true;
    EnclosedSettings settings = few_boxes();
    settings.cancel = &is_cancelled;
    CHECK(require(make_enclosed_instances(planar8(), 5, settings, 1)).instances.empty());
  }

  TEST_CASE("settings out of their ranges are refused") {
    const auto refuse = [](const auto& change, const std::string& word) {
      EnclosedSettings settings = few_boxes();
      change(settings);
      const Error error = require_error(make_enclosed_instances(planar8(), 1, settings, 1));
      CHECK(error.code == ErrorCode::invalid);
      CHECK_MESSAGE(contains(error.message, word), error.message);
    };
    for (const double clearance : {0.0, -0.1, 1.1, std::nan("")}) {
      refuse([&](EnclosedSettings& s) { s.clearance = clearance; }, "clearance");
    }
    refuse([](EnclosedSettings& s) { s.size = {0.3, 0.2}; }, "sizes");
    refuse([](EnclosedSettings& s) { s.size = {0, 0.2}; }, "sizes");
    refuse([](EnclosedSettings& s) { s.boxes = 0; }, "box");
    refuse([](EnclosedSettings& s) { s.through = -1; }, "passes through");
  }
}

}  // namespace mneme::test
