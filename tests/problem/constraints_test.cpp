// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_files.h"
#include "support/support.h"

namespace mneme::test {
namespace {

/// The lifter, in whose base frame x is y of the root link.
Result<Problem> load_lifter(const TemporaryDirectory& directory, const std::string& constraints) {
  write_file(directory / "lifter.urdf", kLiftUrdf);
  write_file(directory / "p.yaml",
             "robot: ./lifter.urdf\njoints: [lift, turn]\nframe: base\nscene: {obstacles: []}\n"
             "start: [0, 0]\ngoal: [1, 1]\nconstraints: " +
                 constraints + "\n");
  return load_problem(directory / "p.yaml");
}

void check_same(const OrientationConstraint& a, const OrientationConstraint& b) {
  CHECK(a.link == b.link);
  CHECK((a.axis - b.axis).norm() < 1e-9);
  CHECK((a.up - b.up).norm() < 1e-9);
  CHECK(a.angle == doctest::Approx(b.angle));
}

const std::string kMoveitPath =
    "path_constraints:\n  orientation_constraints:\n"
    "    - {header: {frame_id: base}, link_name: arm, orientation: [0, 0, 0, 1],\n"
    "       absolute_x_axis_tolerance: 0.3, absolute_y_axis_tolerance: 0.2, ";

TEST_SUITE("unit") {
  TEST_CASE("a constraint's direction is in the frame of the scene, and is written as it is") {
    const TemporaryDirectory directory;
    const auto problem =
        load_lifter(directory, "[{link: arm, axis: [0, 2, 0], up: [3, 0, 0], angle: 0.2}]");
    REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
    REQUIRE(problem->constraints.size() == 1);
    const OrientationConstraint& read = problem->constraints[0];
    check_same(read, {"arm", Vec3::UnitY(), Vec3::UnitY(), 0.2});
    write_file(directory / "again.yaml", to_yaml(*problem, "./lifter.urdf"));
    write_file(directory / "again.json", to_compact_json(*problem, "./lifter.urdf"));
    for (const std::string where : {"again.yaml", "again.json#p"}) {
      const auto again = require(load_problem(directory / where));
      REQUIRE(again.constraints.size() == 1);
      check_same(again.constraints[0], read);
    }
  }

  TEST_CASE("constraints that are malformed are refused with line and key") {
    const TemporaryDirectory directory;
    const auto failure = [&](const std::string& constraints) {
      const Error error = require_error(load_lifter(directory, constraints));
      const std::string& message = error.message;
      return message.substr(message.find("p.yaml") + 6);
    };
    CHECK(failure("[{link: nose, angle: 1}]") ==
          ":7: key constraints[0]: expected a link of robot lifter, got \"nose\"");
    CHECK(failure("[{link: arm}]") ==
          ":7: key constraints[0]: expected the key angle, which is missing");
    CHECK(failure("[{link: arm, angle: 0}]") ==
          ":7: key constraints[0]: expected an angle of 0.001 rad or more, got 0");
    CHECK(contains(failure("[{link: arm, angle: 1, up: [0, 0, 0]}]"),
                   "expected a direction other than 0"));
  }

  TEST_CASE("MoveIt's path constraints of orientation that leave a turn free are cones") {
    const MoveitFiles files(kMoveitScene,
                            kMoveitRequest + kMoveitPath + "absolute_z_axis_tolerance: 6.3}\n");
    const auto problem = require(files.load());
    REQUIRE(problem.constraints.size() == 1);
    check_same(problem.constraints[0], {"arm", Vec3::UnitZ(), Vec3::UnitZ(), 0.2});
    const MoveitFiles narrow(kMoveitScene,
                             kMoveitRequest + kMoveitPath + "absolute_z_axis_tolerance: 0.1}\n");
    CHECK(contains(narrow.failure(),
                   "expected a path constraint with a tolerance of pi about one axis, got 0.3, "
                   "0.2, 0.1"));
  }
}

}  // namespace
}  // namespace mneme::test
