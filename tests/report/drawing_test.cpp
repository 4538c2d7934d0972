// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/drawing.h"

#include "report/report_support.h"

#include <limits>

namespace mneme::internal {
namespace {

struct Scenario {
  Problem problem = test::gap_problem();
  GlSampler gl = test::gap_memory(5);
  PlanarPicture picture;
  Scenario() {
    picture.problem = &problem;
    picture.gl = &gl;
  }
  [[nodiscard]] std::string error() const {
    const auto drawing = make_drawing(picture);
    REQUIRE_FALSE(drawing.has_value());
    CHECK(drawing.error().code == ErrorCode::invalid);
    return drawing.error().message;
  }
};

TEST_SUITE("unit") {
  TEST_CASE("A drawing holds obstacles, the primitive and the remembered arms") {
    const Scenario scenario;
    const auto drawing = make_drawing(scenario.picture);
    REQUIRE(drawing.has_value());
    CHECK(drawing->obstacles.size() == 2);
    CHECK(drawing->memories.size() == 5);
    CHECK(drawing->goals.size() == 1);
    CHECK(drawing->fan.empty());
    CHECK(drawing->reach == doctest::Approx(3.001));
    REQUIRE(drawing->primitives.size() == 1);
    CHECK(drawing->primitives[0].label == "2 matches, error 0.012");
  }

  TEST_CASE(
      "The frame of a primitive is the rectangle around its circles, where the symmetry puts it") {
    Scenario scenario;
    scenario.gl.primitives[0].primitive.to_scene = {1.5707963267948966, false};
    const auto drawing = make_drawing(scenario.picture);
    REQUIRE(drawing.has_value());
    Bounds bounds;
    bounds.include(drawing->primitives[0].corners);
    // A quarter turn takes the centres (2, 1) and (2, -1) to (-1, 2) and (1, 2).
    CHECK(bounds.left == doctest::Approx(-1 - 0.7 - 0.12));
    CHECK(bounds.right == doctest::Approx(1 + 0.6 + 0.12));
    CHECK(bounds.bottom == doctest::Approx(2 - 0.7 - 0.12));
    CHECK(bounds.top == doctest::Approx(2 + 0.7 + 0.12));
  }

  TEST_CASE("Labels tell of misses and of what was learned") {
    Scenario scenario;
    PrimitiveRetrieval& retrieval = scenario.gl.primitives[0];
    const auto label = [&] { return make_drawing(scenario.picture)->primitives[0].label; };
    retrieval.matches.resize(1);
    CHECK(label() == "1 match, error 0.012");
    retrieval.is_learned = true;
    CHECK(label() == "learned now, 1 match, error 0.012");
    retrieval.matches.clear();
    CHECK(label() == "learned now");
    retrieval.is_learned = false;
    CHECK(label() == "no match");
    retrieval.matches = {{nullptr, 0.5, {}}};
    scenario.gl.primitives.assign(4, retrieval);
    CHECK(label() == "1 \u00b7 0.5");
  }

  TEST_CASE("A path gives the ends, a fan between them and the trace of the tip") {
    Scenario scenario;
    scenario.picture.path = {{-0.6, 0, 0}, {0.6, 0, 0}};
    const auto drawing = make_drawing(scenario.picture);
    REQUIRE(drawing.has_value());
    CHECK(drawing->fan.size() == 3);
    CHECK(drawing->start[0].points.back().y < 0);
    CHECK(drawing->goals[0][0].points.back().y > 0);
    REQUIRE(drawing->tip_trace.size() > 100);
    CHECK(drawing->tip_trace.front().y == doctest::Approx(-3 * std::sin(0.6)));
    CHECK(drawing->tip_trace.back().y == doctest::Approx(3 * std::sin(0.6)));
  }

  TEST_CASE("Bounds hold all arms, and obstacles only as far as the arm reaches") {
    Scenario scenario;
    scenario.problem.scene = make_circle_scene("far", {{100, 0, 1}, {-3.5, 0, 1}});
    scenario.picture.gl = nullptr;
    const Bounds bounds = bounds_of(*make_drawing(scenario.picture));
    CHECK(bounds.right == doctest::Approx(3));
    CHECK(bounds.left == doctest::Approx(-3.001));
  }

  TEST_CASE("Configurations, keys and mixtures that do not fit the robot are refused by name") {
    Scenario scenario;
    scenario.problem.start = {0, 0};
    CHECK(scenario.error() == "picture: the start has 2 values; robot unit_arm has 3 joints");
    scenario = {};
    scenario.picture.problem = &scenario.problem;
    scenario.picture.gl = &scenario.gl;
    scenario.problem.goals[0][1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(scenario.error().find("a goal") != std::string::npos);
    scenario.problem = test::gap_problem();
    scenario.picture.path = {{0, 0, 0}, {0}};
    CHECK(scenario.error().find("a waypoint has 1 values") != std::string::npos);
    scenario.picture.path.clear();
    scenario.gl.primitives[0].primitive.key = {1, 2, 3};
    CHECK(scenario.error().find("key has 3 numbers") != std::string::npos);
    scenario.gl = test::gap_memory(1);
    auto mixture = std::make_shared<GaussianMixture>();
    mixture->joint_count = 2;
    mixture->means = {0, 0};
    scenario.gl.mixture = mixture;
    CHECK(scenario.error().find("the mixture has 2 joints") != std::string::npos);
  }

  TEST_CASE("A robot that is not planar is refused by name") {
    Scenario scenario;
    scenario.problem.robot = test::unit_arm(3, Vec3::UnitY());
    const auto drawing = make_drawing(scenario.picture);
    REQUIRE_FALSE(drawing.has_value());
    CHECK(drawing.error().code == ErrorCode::unsupported);
    CHECK(drawing.error().message.find("unit_arm is not planar") != std::string::npos);
  }
}

}  // namespace
}  // namespace mneme::internal
