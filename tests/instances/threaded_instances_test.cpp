// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"
#include "support/threaded.h"

#include <atomic>

namespace mneme::test {
namespace {

ThreadedSettings easy_settings() {
  ThreadedSettings settings;
  settings.gap = {0.3, 0.6};
  settings.depth = {2, 3};
  settings.proof_iterations = 20000;
  return settings;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("instances have the stated gap and depth and a witness that leads out") {
    const Robot robot = planar8();
    const ThreadedSettings settings = easy_settings();
    const ThreadedInstances made = require(make_threaded_instances(robot, 12, settings, 1));
    REQUIRE(made.instances.size() == 12);
    for (const ThreadedInstance& instance : made.instances) {
      REQUIRE(instance.circles.size() == 2);
      const auto& a = instance.circles[0];
      const auto& b = instance.circles[1];
      const PrimitiveKey key = {a[0], a[1], a[2], b[0], b[1], b[2]};
      const double gap = std::hypot(b[0] - a[0], b[1] - a[1]) - a[2] - b[2];
      CHECK(instance.gap == doctest::Approx(gap));
      CHECK(gap >= settings.gap[0] - 1e-9);
      CHECK(gap <= settings.gap[1] + 1e-9);
      CHECK(instance.depth >= settings.depth[0]);
      CHECK(instance.depth <= settings.depth[1]);
      CHECK(first_crossing_link(robot, key, instance.start) == 8 - instance.depth);
      CHECK(first_crossing_link(robot, key, instance.goal) == -1);

      const CollisionChecker checker = make_checker(robot, make_circle_scene("", instance.circles));
      REQUIRE(instance.witness.size() >= 2);
      CHECK(robot.distance(instance.witness.front(), instance.start) < 1e-9);
      CHECK(robot.distance(instance.witness.back(), instance.goal) < 1e-9);
      CheckCounters counters;
      CHECK(find_invalid_motion(checker, instance.witness, counters) == -1);
      for (const Configuration& q : instance.witness) {
        CHECK(checker.contacts(q).empty());
        CHECK(!robot.describe_violation(q, "witness").has_value());
      }
    }
  }

  TEST_CASE(
      "of two passages the arm leaves one and gets into the other, a third pair is in reach") {
    const Robot robot = planar8();
    for (const int passages : {2, 3}) {
      ThreadedSettings settings = easy_settings();
      settings.passages = passages;
      for (const ThreadedInstance& instance :
           require(make_threaded_instances(robot, 3, settings, 1)).instances) {
        REQUIRE(std::ssize(instance.circles) == 2 * passages);
        const auto key = [&](std::size_t pair) {
          const auto& a = instance.circles[2 * pair];
          const auto& b = instance.circles[2 * pair + 1];
          return PrimitiveKey{a[0], a[1], a[2], b[0], b[1], b[2]};
        };
        CHECK(first_crossing_link(robot, key(0), instance.start) == 8 - instance.depth);
        CHECK(first_crossing_link(robot, key(0), instance.goal) == -1);
        const int first_link = first_crossing_link(robot, key(1), instance.goal);
        CHECK(first_link >= 8 - settings.depth[1]);
        CHECK(first_link <= 8 - settings.depth[0]);
        const CollisionChecker checker =
            make_checker(robot, make_circle_scene("", instance.circles));
        CheckCounters counters;
        CHECK(find_invalid_motion(checker, instance.witness, counters) == -1);
      }
    }
  }

  TEST_CASE("the same seed gives the same instances, more of them continue the list") {
    const Robot robot = planar8();
    const ThreadedInstances few = require(make_threaded_instances(robot, 3, easy_settings(), 5));
    const ThreadedInstances many = require(make_threaded_instances(robot, 6, easy_settings(), 5));
    const ThreadedInstances other = require(make_threaded_instances(robot, 3, easy_settings(), 6));
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(few.instances[i].circles == many.instances[i].circles);
      CHECK(few.instances[i].start == many.instances[i].start);
      CHECK(few.instances[i].goal == many.instances[i].goal);
      CHECK(few.instances[i].witness == many.instances[i].witness);
      CHECK(few.instances[i].circles != other.instances[i].circles);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("what cannot be proven is dropped and counted") {
    ThreadedSettings hasty = easy_settings();
    hasty.gap = {0.03, 0.06};
    hasty.proof_iterations = 5;
    int calls = 0, last_made = 0, last_dropped = 0;
    hasty.on_progress = [&](int made, int dropped) {
      ++calls;
      last_made = made;
      last_dropped = dropped;
    };
    const ThreadedInstances made = require(make_threaded_instances(planar8(), 2, hasty, 2));
    CHECK(made.instances.size() == 2);
    CHECK(made.dropped > 0);
    CHECK(calls == 2 + made.dropped);
    CHECK(last_made == 2);
    CHECK(last_dropped == made.dropped);
  }

  TEST_CASE("none are made where none are asked for, or after a cancellation") {
    CHECK(require(make_threaded_instances(planar8(), 0, easy_settings(), 1)).instances.empty());
    const std::atomic<bool> is_cancelled = true;
    ThreadedSettings settings = easy_settings();
    settings.cancel = &is_cancelled;
    CHECK(require(make_threaded_instances(planar8(), 5, settings, 1)).instances.empty());
  }

  TEST_CASE("ranges that are empty or fit no instance are refused") {
    const Robot robot = planar8();
    const auto refuse = [&](std::array<double, 2> gap, std::array<int, 2> depth,
                            const std::string& word) {
      ThreadedSettings settings = easy_settings();
      settings.gap = gap;
      settings.depth = depth;
      const Error error = require_error(make_threaded_instances(robot, 1, settings, 1));
      CHECK(error.code == ErrorCode::invalid);
      CHECK_MESSAGE(contains(error.message, word), error.message);
    };
    refuse({0.3, 0.2}, {2, 3}, "gap");
    refuse({0, 0.2}, {2, 3}, "gap");
    refuse({-1, 0.2}, {2, 3}, "gap");
    refuse({std::nan(""), 0.2}, {2, 3}, "gap");
    refuse({0.1, std::nan("")}, {2, 3}, "gap");
    refuse({0.1, 0.2}, {3, 2}, "depth");
    refuse({0.1, 0.2}, {0, 2}, "depth");
    refuse({0.1, 0.2}, {2, 9}, "8");
    ThreadedSettings four = easy_settings();
    four.passages = 4;
    CHECK(make_threaded_instances(robot, 1, four, 1).error().message ==
          "expected 1 to 3 passages, found 4");
  }

  TEST_CASE("a robot that is no planar arm is refused by name") {
    const Error error = require_error(make_threaded_instances(upright_arm(), 1, {}, 1));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'upright'"));
  }
}

}  // namespace mneme::test
