// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/cells.h"

#include <doctest/doctest.h>

#include <limits>

namespace mneme::test {
namespace {

std::string refusal_of(const std::string& text) {
  const TemporaryDirectory directory;
  return require_error(read_region_text(directory, text)).message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a region is a problem file with half extents and further starts") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(
        directory, region_text("{x: 0.1, yaw: 0.3, heading: 0.5, pivot: [0, 0, 0.1], starts: "
                               "{tray: [1, -0.785, 0, -2.356, 0, 1.571, 0.785]}}"));
    CHECK(region.half_extents == CellTask{0.1, 0, 0, 0.3});
    REQUIRE(region.starts.size() == 2);
    CHECK(region.starts[1].name == "tray");
    CHECK(region.starts[1].q[0] == 1);
    CHECK(region.middle().link == "panda_hand");
    // x is turned by the heading; yaw keeps the pivot in place.
    const Transform middle = link_pose(region, {});
    const Transform moved = link_pose(region, {0.1, 0, 0, 0});
    CHECK((moved.translation - middle.translation)
              .isApprox(0.1 * Vec3(std::cos(0.5), std::sin(0.5), 0), 1e-12));
    const Transform turned = link_pose(region, {0, 0, 0, 0.3});
    const Vec3 pivot(0, 0, 0.1);
    CHECK((turned * pivot).isApprox(middle * pivot, 1e-12));
    CHECK((turned.rotation * middle.rotation.transpose())
              .isApprox(rotation_about(Vec3::UnitZ(), 0.3), 1e-12));
  }

  TEST_CASE("a region's text reads back to the same region") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(
        directory, region_text("{x: 0.1, z: 0.02, yaw: 0.3, heading: 0.5, pivot: [0, 0, 0.1], "
                               "starts: {tray: [1, -0.785, 0, -2.356, 0, 1.571, 0.785]}}"));
    const CellRegion again = require_region(directory, to_yaml(region, "panda"));
    CHECK(again.half_extents == region.half_extents);
    CHECK(again.starts[1].q == region.starts[1].q);
    Rng rng(1);
    const CellTask task = random_task_of(region, rng);
    CHECK(link_pose(again, task).translation.isApprox(link_pose(region, task).translation, 1e-9));
  }

  TEST_CASE("a pose has a task, unless it is beyond the region or tilted") {
    const TemporaryDirectory directory;
    const CellRegion region =
        require_region(directory, region_text("{x: 0.1, y: 0.1, yaw: 0.6, heading: 0.4, "
                                              "pivot: [0.02, 0, 0.1]}"));
    Rng rng(1);
    for (int i = 0; i < 20; ++i) {
      const CellTask task = random_task_of(region, rng, i % 2 == 0);
      const auto found = require(task_of(region, link_pose(region, task)));
      for (std::size_t k = 0; k < kTaskSize; ++k) CHECK(found[k] == doctest::Approx(task[k]));
    }
    const Error error = require_error(task_of(region, link_pose(region, {0, 0, 0.01, 0})));
    CHECK(contains(error.message, "along z"));
    Transform tilted = link_pose(region, {});
    tilted.rotation = rotation_about(Vec3::UnitX(), 0.01) * tilted.rotation;
    CHECK_FALSE(task_of(region, tilted).has_value());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (Eigen::Index k = 0; k < 3; ++k) {
      Transform nowhere = link_pose(region, {}), unturned = nowhere;
      nowhere.translation[k] = nan;
      CHECK_FALSE(task_of(region, nowhere).has_value());
      unturned.rotation(k, k) = nan;
      CHECK_FALSE(task_of(region, unturned).has_value());
    }
  }

  TEST_CASE("what a cell cannot prove is refused by name") {
    CHECK(contains(refusal_of(region_text("{}")), "extent"));
    CHECK(contains(refusal_of(region_text("{x: -0.1}")), "x"));
    CHECK(contains(refusal_of(region_text("{roll: 0.1}")), "roll"));
    CHECK(contains(refusal_of(region_text("{x: 0.1}",
                                          "constraints: [{link: panda_hand, axis: [0, 0, 1], up: "
                                          "[0, 0, -1], angle: 0.2}]\n")),
                   "constraint on link panda_hand"));
    std::string text = region_text();
    text.replace(text.find("quat_xyzw: [1, 0, 0, 0]"), 23, "position_tolerance: 0.1");
    CHECK(contains(refusal_of(text), "quat_xyzw"));
  }

  TEST_CASE("what motions of a cell cannot have at their ends is refused by name") {
    const std::string velocity = "velocity: [0.1, 0, 0, 0, 0, 0, 0]\n";
    for (const std::string end : {"start_", "end_"}) {
      const std::string refusal = refusal_of(region_text("{x: 0.1}", end + velocity));
      CHECK_MESSAGE(contains(refusal, end + "velocity: motions of a cell begin and end at rest"),
                    refusal);
    }
    const std::string refusal = refusal_of(
        region_text("{x: 0.1}", "allow: [{pair: [panda_hand, table], at_ends: 0.01}]\n"));
    CHECK_MESSAGE(contains(refusal, "at_ends"), refusal);
    CHECK_MESSAGE(contains(refusal, "[panda_hand, table]"), refusal);
  }

  TEST_CASE("names of starts are not empty, and differ") {
    const std::string q = "[0.5, -0.785, 0, -2.356, 0, 1.571, 0.785]";
    CHECK(contains(refusal_of(region_text("{x: 0.1, starts: {start: " + q + "}}")),
                   "\"start\" is a start of this region already, the problem's"));
    CHECK(contains(refusal_of(region_text("{x: 0.1, starts: {\"\": " + q + "}}")),
                   "expected a name"));
  }

  TEST_CASE("a start in contact is refused before anything is built") {
    const TemporaryDirectory directory;
    CellRegion region = require_region(directory, region_text());
    region.starts[0].q = {0, 1.2, 0, -0.8, 0, 1.8, 0};
    CHECK(contains(require_error(build_cell(region, {})).message, "start 'start': "));
  }
}

}  // namespace mneme::test
