// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/make_checker.h"

#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the checker has the resolution, margin and instruction set of the settings") {
    const Robot robot = planar8();
    Scene scene;
    scene.obstacles.push_back({"post", {Sphere{{0, 9, 0}, 0.5}}});
    const Problem problem{"one", robot, {}, scene, Configuration(8, 0.0), {Configuration(8, 0.1)},
                          {}};
    SolveSettings settings;
    settings.resolution = 0.125;
    settings.isa = Isa::scalar;
    const auto checker = internal::make_checker(problem, settings);
    REQUIRE(checker.has_value());
    CHECK(checker->resolution() == 0.125);
    CHECK(checker->isa() == Isa::scalar);
    CHECK(checker->is_valid(problem.start));
    settings.margin = 20;
    const auto wary = internal::make_checker(problem, settings);
    REQUIRE(wary.has_value());
    CHECK_FALSE(wary->is_valid(problem.start));
    settings.margin = -1;
    CHECK_FALSE(internal::make_checker(problem, settings).has_value());
  }
}

}  // namespace mneme::test
