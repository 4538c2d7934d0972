// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "instances/known_robot.h"
#include "support/planar_memory.h"

#include <atomic>
#include <set>

namespace mneme::test {
namespace {

ComposedSettings few_modules() {
  ComposedSettings settings;
  settings.clearance = 0.01;
  settings.boxes = 60;
  settings.modules = 4;
  return settings;
}

bool is_free(const Robot& robot, const Scene& scene, const Path& path, double margin) {
  const auto checker = make_checker(robot, scene, margin);
  CheckCounters counters;
  return checker.is_valid(std::span<const double>(path.front())) &&
         find_invalid_motion(checker, path, counters) == -1;
}

std::string refusal(const Robot& robot, const ComposedSettings& settings) {
  const auto made = make_composed_instances(robot, 1, settings, 1);
  return made ? "" : made.error().message;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("modules enclose their motions, and compositions hold turned modules") {
    for (const char* name : {"panda", "ur5"}) {
      const Robot robot = known_robot(name);
      const ComposedSettings settings = few_modules();
      const ComposedInstances made = require(make_composed_instances(robot, 6, settings, 1));
      REQUIRE(made.modules.size() == 4);
      for (const ComposedModule& module : made.modules) {
        CHECK(module.motion.size() == 3);
        CHECK(is_free(robot, module.scene, module.motion, 0.99 * settings.clearance));
        CHECK_FALSE(is_free(robot, module.scene, module.motion, 5 * settings.clearance));
      }
      for (std::size_t i = 0; i < made.instances.size(); ++i) {
        const ComposedInstance& instance = made.instances[i];
        CHECK(instance.parts.size() == 1 + i % 3);
        CHECK(instance.witness.front() == instance.start);
        CHECK(instance.witness.back() == instance.goal);
        CHECK(is_free(robot, instance.scene, instance.witness, 0));
        std::set<int> modules;
        for (const ComposedPart& part : instance.parts) {
          modules.insert(part.module);
          Path motion = made.modules[static_cast<std::size_t>(part.module)].motion;
          for (Configuration& q : motion) q.front() += part.turn;
          CHECK(is_free(robot, instance.scene, motion, 0.9 * settings.clearance));
          const Configuration& end = part.is_reversed ? motion.back() : motion.front();
          CHECK(std::ranges::count(instance.witness, end) >= 1);
        }
        CHECK(modules.size() == instance.parts.size());
      }
    }
  }

  TEST_CASE("the same seed composes the same instances, more of them continue the list") {
    const Robot robot = known_robot("panda");
    const auto few = require(make_composed_instances(robot, 2, few_modules(), 5)).instances;
    const auto many = require(make_composed_instances(robot, 4, few_modules(), 5)).instances;
    const auto other = require(make_composed_instances(robot, 2, few_modules(), 6)).instances;
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(few[i].witness == many[i].witness);
      CHECK(to_yaml(few[i].scene) == to_yaml(many[i].scene));
      CHECK(few[i].witness != other[i].witness);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("foreign modules follow the others and are in no instance") {
    const Robot robot = known_robot("panda");
    ComposedSettings settings = few_modules();
    settings.foreign = 2;
    const ComposedInstances made = require(make_composed_instances(robot, 3, settings, 1));
    CHECK(made.modules.size() == 6);
    for (const ComposedInstance& instance : made.instances) {
      for (const ComposedPart& part : instance.parts) CHECK(part.module < 4);
    }
  }

  TEST_CASE("composing refuses settings out of range and robots that nothing turns") {
    const Robot robot = known_robot("panda");
    ComposedSettings settings = few_modules();
    settings.open = 0;
    CHECK(refusal(robot, settings).find("clearance and open") == 0);
    settings = few_modules();
    settings.size = {0.3, 0.2};
    CHECK(refusal(robot, settings).find("the range of sizes") == 0);
    settings = few_modules();
    settings.passages = {2, 1};
    CHECK(refusal(robot, settings).find("the range of passages") == 0);
    settings = few_modules();
    settings.modules = 2;
    CHECK(refusal(robot, settings).find("expected at least one box") == 0);
    Robot::Parts parts;
    parts.name = "rail";
    parts.links = {{.name = "base"}, {"slide", 0, {{Vec3::Zero(), 0.1}}, {}, {}}};
    Joint joint;
    joint.name = "x";
    joint.type = JointType::prismatic;
    joint.parent_link = 0;
    joint.child_link = 1;
    joint.axis = Vec3::UnitX();
    joint.lower = -1;
    joint.upper = 1;
    parts.joints = {joint};
    const auto rail = require(make_robot(std::move(parts)));
    CHECK(refusal(rail, few_modules()).find("robot 'rail' has no joint that turns") == 0);
  }

  TEST_CASE("a cancelled composition ends") {
    const std::atomic<bool> cancel = true;
    ComposedSettings settings = few_modules();
    settings.cancel = &cancel;
    CHECK(require(make_composed_instances(known_robot("panda"), 3, settings, 1)).instances.empty());
  }
}

}  // namespace mneme::test
